#include "meshing/starter/elastic.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"
#include "base/vector.h"
#include "mechanics/hex8.h"

/* ---- elements ------------------------------------------------------------------------------- */

/* Vectors of seven modes. */
typedef lar_pair_vectors modes[7];

/* The Walsh-Hadamard transform of eight nodes: modes 0..6 of hex8.h. */
static inline void to_modes(const lar_pair_vectors *const node[8], modes U) {
    for (int i = 0; i < 3; i++) {
        const lar_pair s0 = (*node[1])[i] + (*node[0])[i], d0 = (*node[1])[i] - (*node[0])[i];
        const lar_pair s1 = (*node[2])[i] + (*node[3])[i], d1 = (*node[2])[i] - (*node[3])[i];
        const lar_pair s2 = (*node[5])[i] + (*node[4])[i], d2 = (*node[5])[i] - (*node[4])[i];
        const lar_pair s3 = (*node[6])[i] + (*node[7])[i], d3 = (*node[6])[i] - (*node[7])[i];
        U[0][i] = (d3 + d2) + (d1 + d0);
        U[1][i] = (s3 - s2) + (s1 - s0);
        U[2][i] = (s3 + s2) - (s1 + s0);
        U[3][i] = (s3 - s2) - (s1 - s0);
        U[4][i] = (d3 + d2) - (d1 + d0);
        U[5][i] = (d3 - d2) + (d1 - d0);
        U[6][i] = (d3 - d2) - (d1 - d0);
    }
}

static void prepare(lar_elastic_element *e, const double corner[8][3],
                    const lar_elastic_material *material) {
    static const double FACTOR = LAR_HOURGLASS_FACTOR / 64;
    lar_material made = {.law = LAR_LAW_neo_hookean};
    lar_hex8 hex8;
    lar_material_from_shear_bulk(&made, material->shear, material->bulk);
    lar_hex8_prepare(corner, &made, &hex8);
    memcpy(e->gradient, hex8.gradient, sizeof e->gradient);
    memcpy(e->shape, hex8.shape, sizeof e->shape);
    e->volume = hex8.volume;
    double edge = cbrt(e->volume);
    for (int k = 0; k < 4; k++)
        e->spring[k] = material->own_springs
                           ? hex8.stiffness[k]
                           : FACTOR * material->shear * edge * (k < 3 ? 4 : 8. / 3) / 3;
    e->shear = material->shear * e->volume;
    e->pressure = (material->bulk - 2 * material->shear / 3) * e->volume;
}

/* G_m of hex8.h from U_m. */
static inline void modal_forces(const lar_elastic_element *e, const modes U, modes G) {
    lar_pair H[3][3] = {0};
    for (int i = 0; i < 3; i++)
        for (int m = 0; m < 6; m++)
            for (int j = 0; j < 3; j++) H[i][j] += U[m][i] * e->gradient[m][j];
    const lar_pair trace = e->pressure * (H[0][0] + H[1][1] + H[2][2]);
    for (int i = 0; i < 3; i++) {
        lar_pair S[3];
        for (int j = 0; j < 3; j++) S[j] = e->shear * (H[i][j] + H[j][i]);
        S[i] += trace;
        for (int k = 0; k < 4; k++) {
            lar_pair g = U[3 + k][i];
            for (int j = 0; j < 3; j++) g -= H[i][j] * e->shape[k][j];
            g *= e->spring[k];
            for (int j = 0; j < 3; j++) S[j] -= g * e->shape[k][j];
            G[3 + k][i] = g;
        }
        for (int m = 0; m < 6; m++) {
            lar_pair sum = m < 3 ? (lar_pair){0} : G[m][i];
            for (int j = 0; j < 3; j++) sum += S[j] * e->gradient[m][j];
            G[m][i] = sum;
        }
    }
}

/* Adds sum_m h_m(a) G_m to the nodes. */
static inline void add_from_modes(const modes G, lar_pair_vectors *const node[8]) {
    static const struct {
        int8_t eta, zeta, left, right;
    } line[4] = {{-1, -1, 0, 1}, {1, -1, 3, 2}, {-1, 1, 4, 5}, {1, 1, 7, 6}};
    for (int k = 0; k < 4; k++) {
        const double eta = line[k].eta, zeta = line[k].zeta;
        for (int i = 0; i < 3; i++) {
            const lar_pair even = eta * G[1][i] + zeta * (G[2][i] + eta * G[3][i]);
            const lar_pair odd = G[0][i] + eta * G[5][i] + zeta * (G[4][i] + eta * G[6][i]);
            (*node[line[k].left])[i] += even - odd;
            (*node[line[k].right])[i] += even + odd;
        }
    }
}

/* Adds an element's forces at its nodes. */
static inline void add_forces(const lar_elastic_element *e, const lar_pair_vectors *const u[8],
                              lar_pair_vectors *const f[8]) {
    modes U, G;
    to_modes(u, U);
    modal_forces(e, (const lar_pair_vectors *)U, G);
    add_from_modes((const lar_pair_vectors *)G, f);
}

void lar_elastic_element_matrix(const lar_elastic_element *e, double K[24][24]) {
    for (int first = 0; first < 24; first += 2) {
        lar_pair_vectors u[8] = {0}, f[8] = {0}, *to[8];
        const lar_pair_vectors *from[8];
        for (int a = 0; a < 8; a++) from[a] = &u[a], to[a] = &f[a];
        for (int l = 0; l < 2; l++) u[(first + l) / 3][(first + l) % 3][l] = 1;
        add_forces(e, from, to);
        for (int row = 0; row < 24; row++)
            for (int l = 0; l < 2; l++) K[row][first + l] = f[row / 3][row % 3][l];
    }
}

void lar_elastic_forces(const lar_elastic *elastic, const lar_pair_vectors *u,
                        lar_pair_vectors *f) {
    memset(f, 0, (size_t)elastic->node_count * sizeof *f);
    for (int32_t k = 0; k < elastic->element_count; k++) {
        const lar_elastic_element *e = &elastic->element[k];
        const lar_pair_vectors *from[8];
        lar_pair_vectors *to[8];
        for (int a = 0; a < 8; a++) from[a] = &u[e->node[a]], to[a] = &f[e->node[a]];
        add_forces(e, from, to);
    }
    for (int32_t n = 0; elastic->spring && n < elastic->node_count; n++)
        for (int i = 0; i < 3; i++) f[n][i] += elastic->spring[n] * u[n][i];
}

void lar_elastic_diagonal(const lar_elastic *elastic, double (*diagonal)[3]) {
    for (int32_t k = 0; k < elastic->element_count; k++) {
        double K[24][24];
        lar_elastic_element_matrix(&elastic->element[k], K);
        for (int row = 0; row < 24; row++)
            diagonal[elastic->element[k].node[row / 3]][row % 3] += K[row][row];
    }
    for (int32_t n = 0; n < elastic->node_count; n++)
        for (int i = 0; i < 3; i++) {
            if (elastic->spring) diagonal[n][i] += elastic->spring[n];
            if (elastic->still[n] >> i & 1) diagonal[n][i] = 0;
        }
}

/* ---- the body ------------------------------------------------------------------------------- */

/* Marks what hangs together with nothing that is held. */
static lar_status find_still(const lar_mesh *mesh, const lar_elastic_material *material,
                             uint8_t *still, const double *spring, lar_error *error) {
    size_t nodes = (size_t)mesh->node_count;
    int32_t *parent = lar_calloc(nodes, sizeof *parent);
    bool *anchored = lar_calloc(nodes, sizeof *anchored);
    bool ready = parent && anchored;
    if (ready) lar_union_start(parent, mesh->node_count);
    for (int32_t e = 0; ready && e < mesh->element_count; e++)
        for (int a = 1; a < 8 && material[e].shear > 0; a++)
            lar_union_join(parent, mesh->element[e][0], mesh->element[e][a]);
    for (int32_t n = 0; ready && n < mesh->node_count; n++)
        if (still[n] == LAR_AXIS_ALL || (spring && spring[n] > 0))
            anchored[lar_union_root(parent, n)] = true;
    for (int32_t n = 0; ready && n < mesh->node_count; n++)
        if (!anchored[lar_union_root(parent, n)]) still[n] = LAR_AXIS_ALL;
    free(parent);
    free(anchored);
    return ready ? LAR_OK : lar_fail_memory(error, 5 * nodes, "the body's pieces");
}

static bool moves(const lar_elastic *elastic, const int32_t node[8]) {
    for (int a = 0; a < 8; a++)
        if (elastic->still[node[a]] != LAR_AXIS_ALL) return true;
    return false;
}

lar_status lar_elastic_create(const lar_mesh *mesh, const lar_elastic_material *material,
                              uint8_t *still, const double *spring, lar_elastic *elastic,
                              lar_error *error) {
    size_t elements = (size_t)mesh->element_count;
    *elastic = (lar_elastic){.mesh = mesh,
                             .node_count = mesh->node_count,
                             .element = lar_calloc(elements, sizeof *elastic->element),
                             .still = still,
                             .spring = spring};
    if (!elastic->element)
        return lar_fail_memory(error, elements * sizeof *elastic->element, "a static estimate");
    lar_status status = find_still(mesh, material, still, spring, error);
    for (int32_t e = 0; !status && e < mesh->element_count; e++) {
        if (!(material[e].shear > 0) || !moves(elastic, mesh->element[e])) continue;
        lar_elastic_element *element = &elastic->element[elastic->element_count++];
        double corner[8][3];
        lar_mesh_corners(mesh, e, corner);
        memcpy(element->node, mesh->element[e], sizeof element->node);
        prepare(element, corner, &material[e]);
    }
    return status;
}
