#include "engine/rows.h"

#include <stdlib.h>
#include <string.h>

#include "model/mesh_faces.h"

lar_status lar_rows_neighbours(const lar_mesh *mesh, int32_t **neighbour, lar_error *error) {
    size_t faces = 6 * (size_t)mesh->element_count;
    lar_face_table table = {0};
    int32_t *made = lar_calloc(faces, sizeof *made);
    if (!made) return lar_fail_memory(error, faces * sizeof *made, "the element neighbours");
    lar_status status = lar_face_table_build(mesh, &table, error);
    if (status) {
        free(made);
        return status;
    }
    for (size_t i = 0; i < faces; i++) made[i] = -1;
    for (size_t i = 0; i + 1 < table.count; i++)
        if (lar_face_key_same(&table.key[i], &table.key[i + 1])) {
            made[table.key[i].face] = table.key[i + 1].face;
            made[table.key[i + 1].face] = table.key[i].face;
        }
    free(table.key);
    *neighbour = made;
    return LAR_OK;
}

static int opposite(int face) {
    return face ^ 1;
}

/* Local node at the other end of the edge that leaves `local` along `axis`. */
static int across(int local, int axis) {
    static const int8_t partner[8][3] = {{1, 3, 4}, {0, 2, 5}, {3, 1, 6}, {2, 0, 7},
                                         {5, 7, 0}, {4, 6, 1}, {7, 5, 2}, {6, 4, 3}};
    return partner[local][axis];
}

/* The nodes of an element turned (right-handedly) so that its local face `front` becomes xi+. */
static void turn_to_front(const int32_t node[8], int front, int32_t turned[8]) {
    int axis = front / 2;
    for (int a = 0; a < 8; a++) {
        int sign[3]; /* of the old natural coordinates at the new local node a */
        int xi = lar_node_sign[a][0], eta = lar_node_sign[a][1], zeta = lar_node_sign[a][2];
        if (front % 2 == 0) { /* half a turn about the new eta */
            xi = -xi;
            zeta = -zeta;
        }
        sign[axis] = xi;
        sign[(axis + 1) % 3] = eta;
        sign[(axis + 2) % 3] = zeta;
        for (int b = 0; b < 8; b++)
            if (lar_node_sign[b][0] == sign[0] && lar_node_sign[b][1] == sign[1] &&
                lar_node_sign[b][2] == sign[2])
                turned[a] = node[b];
    }
}

/* The nodes of the next element of a row: its left face is the right face of `previous`. */
static bool turn_to_follow(const int32_t node[8], int entry, const int32_t previous[8],
                           int32_t turned[8]) {
    static const int left[4] = {0, 3, 7, 4}, right[4] = {1, 2, 6, 5};
    for (int k = 0; k < 4; k++) {
        int local = 0;
        while (local < 8 && node[local] != previous[right[k]]) local++;
        if (local == 8) return false;
        turned[left[k]] = node[local];
        turned[right[k]] = node[across(local, entry / 2)];
    }
    return true;
}

int lar_rows_trace(const lar_mesh *mesh, const int32_t *neighbour, const bool *usable, int32_t e,
                   int axis, int most, int32_t *run, int32_t (*corner)[8]) {
    /* Back to the beginning: `front` is always the face that leads forward. */
    int32_t first = e, front = 2 * axis + 1;
    for (int steps = 0; steps < most / 2; steps++) {
        int32_t behind = neighbour[6 * first + opposite(front)];
        if (behind < 0 || !usable[behind / 6] || behind / 6 == e) break;
        first = behind / 6;
        front = behind % 6;
    }
    int length = 0;
    int32_t at = first;
    turn_to_front(mesh->element[at], front, corner[0]);
    for (;;) {
        run[length++] = at;
        int32_t ahead = neighbour[6 * at + front];
        if (length == most || ahead < 0 || !usable[ahead / 6] || ahead / 6 == first) return length;
        int32_t next = ahead / 6;
        if (!turn_to_follow(mesh->element[next], ahead % 6, corner[length - 1], corner[length]))
            return length;
        at = next;
        front = opposite(ahead % 6);
    }
}
