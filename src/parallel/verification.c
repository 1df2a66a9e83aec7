#include "parallel/verification.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A vector as a list: count and numbers. Copied out and in, because the sums are integers. */
typedef struct list {
    uint16_t count, number[LAR_LIST_MAX];
} list;

static list load(const int64_t *vector) {
    list l;
    memcpy(&l, vector, sizeof l);
    return l;
}

static void store(int64_t *vector, const list *l) {
    memcpy(vector, l, sizeof *l);
}

/* ---- passes ------------------------------------------------------------------------------- */

static bool passes_suffice(const lar_incidence *incidence, int32_t passes) {
    if (incidence->element_count / passes >= UINT16_MAX) return false;
    for (int32_t k = 0; k < incidence->node_count; k++) {
        const int32_t *element = incidence->element + incidence->first[k];
        int64_t count = incidence->first[k + 1] - incidence->first[k];
        for (int64_t i = 0; count > LAR_LIST_MAX && i < count; i++) {
            int same = 0;
            for (int64_t j = 0; j < count; j++) same += element[j] % passes == element[i] % passes;
            if (same > LAR_LIST_MAX) return false;
        }
    }
    return true;
}

lar_status lar_verification_create(const lar_model *model, lar_verification *verification,
                                   lar_error *error) {
    lar_verification made = {.model = model, .passes = 1};
    lar_status status = lar_incidence_build(&model->mesh, &made.incidence, error);
    if (status) return status;
    while (!passes_suffice(&made.incidence, made.passes)) made.passes++;
    *verification = made;
    return LAR_OK;
}

void lar_verification_destroy(lar_verification *verification) {
    lar_incidence_clear(&verification->incidence);
    *verification = (lar_verification){0};
}

/* ---- instead of adding --------------------------------------------------------------------- */

void lar_list_join(int64_t sum[3], const int64_t part[3]) {
    list into = load(sum), from = load(part);
    if (into.count > LAR_LIST_MAX || from.count > LAR_LIST_MAX ||
        into.count + from.count > LAR_LIST_MAX) {
        into.count = LAR_LIST_MAX + 1;
    } else {
        memcpy(into.number + into.count, from.number, from.count * sizeof *from.number);
        into.count = (uint16_t)(into.count + from.count);
    }
    store(sum, &into);
}

static void take(const lar_state *state, int32_t node, int64_t vector[3]) {
    for (int i = 0; i < 3; i++) vector[i] = state->force[lar_state_at(state, node, i)];
}

static void put(lar_state *state, int32_t node, const int64_t vector[3]) {
    for (int i = 0; i < 3; i++) state->force[lar_state_at(state, node, i)] = vector[i];
}

static void insert(lar_state *state, int32_t node, int32_t number) {
    list one = {1, {(uint16_t)number}};
    int64_t sum[3], part[3];
    store(part, &one);
    take(state, node, sum);
    lar_list_join(sum, part);
    put(state, node, sum);
}

void lar_verification_recover(const lar_verification *verification, const lar_domain *domain,
                              int32_t first, int32_t count, lar_state *state) {
    int32_t passes = verification->passes, pass = (int32_t)(state->step % (uint64_t)passes);
    for (int32_t r = first; r < first + count; r++) {
        const lar_block_run *run = &domain->run[r];
        for (int32_t b = 0; b < run->count; b++) {
            const lar_lanes *lanes = &domain->layout.block[domain->run_first[r] + b];
            for (int lane = 0; lane < LAR_BLOCK; lane++) {
                lar_gid e = lanes->element[lane];
                if (e < 0 || e % passes != pass) continue;
                lar_lid node[8]; /* that the kernel would use */
                if (domain->kind == LAR_ELEMENT_HEX8) lar_run_nodes(run, b, lane, node);
                for (int a = 0; a < 8; a++) {
                    if (domain->kind != LAR_ELEMENT_HEX8)
                        node[a] = domain->layout.local[domain->layout.corner[e][a]];
                    insert(state, node[a], e / passes);
                }
            }
        }
    }
}

/* ---- instead of moving --------------------------------------------------------------------- */

static int compare_numbers(const void *a, const void *b) {
    return (int)*(const uint16_t *)a - (int)*(const uint16_t *)b;
}

/* What the list should be. */
static list expected_list(const lar_verification *verification, lar_gid node, uint64_t step) {
    const lar_incidence *incidence = &verification->incidence;
    int32_t passes = verification->passes, pass = (int32_t)(step % (uint64_t)passes);
    list l = {0};
    if (node < 0) return l; /* spare */
    for (int64_t i = incidence->first[node]; i < incidence->first[node + 1]; i++)
        if (incidence->element[i] % passes == pass)
            l.number[l.count++] = (uint16_t)(incidence->element[i] / passes);
    return l;
}

static lar_status report(const lar_verification *verification, int32_t processor, lar_gid node,
                         uint64_t step, const list *found, const list *wanted, lar_error *error) {
    const lar_mesh *mesh = &verification->model->mesh;
    int32_t passes = verification->passes, pass = (int32_t)(step % (uint64_t)passes);
    char what[160] = "holds more elements than a list can";
    int i = 0, j = 0;
    while (found->count <= LAR_LIST_MAX && (i < found->count || j < wanted->count)) {
        bool extra =
            j == wanted->count || (i < found->count && found->number[i] < wanted->number[j]);
        bool lacks =
            i == found->count || (j < wanted->count && wanted->number[j] < found->number[i]);
        if (extra || lacks) {
            int32_t e = (extra ? found->number[i] : wanted->number[j]) * passes + pass;
            bool known = e < mesh->element_count;
            snprintf(what, sizeof what,
                     extra ? "got element %lld once too often" : "did not get element %lld",
                     known ? (long long)mesh->element_id[e] : (long long)e);
            break;
        }
        i++;
        j++;
    }
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "verification: in step %llu node %lld on processor %d %s; the schedule does "
                    "not fit this model or this program: make it anew with lariat partition, and "
                    "report it if it stays",
                    (unsigned long long)step, node < 0 ? -1LL : (long long)mesh->node_id[node],
                    (int)processor, what);
}

lar_status lar_verification_compare(const lar_verification *verification, const lar_domain *domain,
                                    int32_t processor, int32_t first, int32_t end, lar_state *state,
                                    lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t n = first; n < end; n++) {
        int64_t vector[3];
        take(state, n, vector);
        list found = load(vector);
        lar_gid node = domain->layout.global[n];
        list wanted = expected_list(verification, node, state->step);
        if (found.count <= LAR_LIST_MAX)
            qsort(found.number, found.count, sizeof *found.number, compare_numbers);
        if (!status && (found.count != wanted.count ||
                        memcmp(found.number, wanted.number, wanted.count * sizeof(uint16_t)) != 0))
            status = report(verification, processor, node, state->step, &found, &wanted, error);
        put(state, n, (const int64_t[3]){0});
    }
    return status;
}
