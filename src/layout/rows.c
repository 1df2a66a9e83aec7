#include "layout/rows.h"

#include <stdlib.h>

#include "model/mesh/faces.h"

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
    for (size_t i = 0, end; i < table.count; i = end) {
        for (end = i + 1; end < table.count; end++)
            if (!lar_face_key_same(&table.key[i], &table.key[end])) break;
        if (end - i != 2) continue;
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

/* The nodes of an element turned (right-handedly) so that its local face `front` becomes xi+, and
 * the two axes after the face's own become eta and zeta; half a turn about eta where the face looks
 * back. */
static void turn_to_front(const int32_t node[8], int front, int32_t turned[8]) {
    static const int8_t old[6][8] = {{5, 4, 7, 6, 1, 0, 3, 2}, {0, 1, 2, 3, 4, 5, 6, 7},
                                     {2, 1, 5, 6, 3, 0, 4, 7}, {0, 3, 7, 4, 1, 2, 6, 5},
                                     {7, 3, 2, 6, 4, 0, 1, 5}, {0, 4, 5, 1, 3, 7, 6, 2}};
    for (int a = 0; a < 8; a++) turned[a] = node[old[front][a]];
}

/* The nodes of the next element of a row: its left face is the right face of `previous`. False when
 * no turn of the element does that, as when the two lie on the same side of the face. */
static bool turn_to_follow(const int32_t node[8], int entry, const int32_t previous[8],
                           int32_t turned[8]) {
    static const int left[4] = {0, 3, 7, 4}, right[4] = {1, 2, 6, 5};
    int32_t facing[8];
    turn_to_front(node, opposite(entry), facing);
    for (int quarters = 0; quarters < 4; quarters++) {
        bool fits = true;
        for (int k = 0; k < 4; k++) {
            int from = (k + quarters) % 4;
            fits = fits && facing[left[from]] == previous[right[k]];
            turned[left[k]] = facing[left[from]];
            turned[right[k]] = facing[right[from]];
        }
        if (fits) return true;
    }
    return false;
}

int lar_rows_trace(const lar_mesh *mesh, const int32_t *neighbour, const bool *usable, int32_t e,
                   int front, int max, int32_t *run, int32_t (*corner)[8]) {
    /* Back to the beginning: `front` is always the face that leads forward. */
    int32_t first = e;
    for (int steps = 0; steps < max / 2; steps++) {
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
        if (length == max || ahead < 0 || !usable[ahead / 6] || ahead / 6 == first) return length;
        int32_t next = ahead / 6;
        if (!turn_to_follow(mesh->element[next], ahead % 6, corner[length - 1], corner[length]))
            return length;
        at = next;
        front = opposite(ahead % 6);
    }
}

static int local_of(const int32_t node[8], int32_t wanted) {
    int local = 0;
    while (local < 7 && node[local] != wanted) local++;
    return local;
}

/* The face of an element on the side of local node `local` along `axis`. */
static int face_at(int local, int axis) {
    return 2 * axis + (lar_node_sign[local][axis] > 0);
}

int lar_rows_face(const int32_t node[8], int32_t from, int32_t to) {
    int a = local_of(node, from), b = local_of(node, to), axis = 0;
    while (axis < 2 && lar_node_sign[a][axis] == lar_node_sign[b][axis]) axis++;
    return face_at(b, axis);
}

int32_t lar_rows_beyond(const lar_mesh *mesh, const int32_t *neighbour, int32_t *e, int32_t from,
                        int32_t to) {
    enum { MAX_AROUND_EDGE = 8 };
    for (int sense = 0; sense < 2; sense++) { /* around the edge one way, then the other */
        int32_t at = *e;
        int entered = -1;
        for (int i = 0; i < MAX_AROUND_EDGE; i++) {
            const int32_t *node = mesh->element[at];
            int end = local_of(node, to), face = lar_rows_face(node, from, to);
            int32_t ahead = neighbour[6 * at + face];
            if (ahead >= 0) {
                *e = ahead / 6;
                node = mesh->element[*e];
                return node[across(local_of(node, to), ahead % 6 / 2)];
            }
            int side[2] = {face_at(end, (face / 2 + 1) % 3), face_at(end, (face / 2 + 2) % 3)};
            int leave = entered < 0 ? side[sense] : side[side[0] == entered];
            int32_t over = neighbour[6 * at + leave];
            if (over < 0) break;
            at = over / 6;
            entered = over % 6;
        }
    }
    return -1;
}
