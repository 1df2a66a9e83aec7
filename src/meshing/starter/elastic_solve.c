#include <stdlib.h>
#include <string.h>

#include "meshing/starter/elastic_coarse.h"

enum { STEPS_MAX = 400, STEPS_LAST = 10 };

typedef struct search {
    const lar_elastic *elastic;
    lar_coarse coarse;
    double (*diagonal)[3];
    lar_load_vectors *r, *z, *p, *Kp;
    double rz[LAR_LOADS];
    double gain[STEPS_LAST][LAR_LOADS];
} search;

static void sum_products(int32_t nodes, const lar_load_vectors *a, const lar_load_vectors *b,
                         double sum[LAR_LOADS]) {
    LAR_EACH_LOAD sum[l] = 0;
    for (int32_t n = 0; n < nodes; n++)
        for (int i = 0; i < 3; i++) LAR_EACH_LOAD sum[l] += a[n][i][l] * b[n][i][l];
}

/* z from r, and r . z. */
static void precondition(search *s, double rz[LAR_LOADS]) {
    for (int32_t n = 0; n < s->elastic->node_count; n++)
        for (int i = 0; i < 3; i++) {
            double inverse = s->diagonal[n][i] > 0 ? 1 / s->diagonal[n][i] : 0;
            LAR_EACH_LOAD s->z[n][i][l] = inverse * s->r[n][i][l];
        }
    lar_coarse_add(&s->coarse, (const lar_load_vectors *)s->r, s->z);
    sum_products(s->elastic->node_count, (const lar_load_vectors *)s->r,
                 (const lar_load_vectors *)s->z, rz);
}

static void turn(search *s, const double beta[LAR_LOADS]) {
    for (int32_t n = 0; n < s->elastic->node_count; n++)
        for (int i = 0; i < 3; i++)
            LAR_EACH_LOAD s->p[n][i][l] = s->z[n][i][l] + beta[l] * s->p[n][i][l];
}

/* One step; what each load's work grows by. */
static void step(search *s, lar_load_vectors *u, double gain[LAR_LOADS]) {
    double pKp[LAR_LOADS] = {0}, alpha[LAR_LOADS], rz[LAR_LOADS], beta[LAR_LOADS];
    lar_elastic_forces(s->elastic, (const lar_load_vectors *)s->p, s->Kp);
    sum_products(s->elastic->node_count, (const lar_load_vectors *)s->p,
                 (const lar_load_vectors *)s->Kp, pKp);
    LAR_EACH_LOAD alpha[l] = pKp[l] > 0 ? s->rz[l] / pKp[l] : 0;
    LAR_EACH_LOAD gain[l] = alpha[l] * s->rz[l];
    for (int32_t n = 0; n < s->elastic->node_count; n++)
        for (int i = 0; i < 3; i++) LAR_EACH_LOAD {
                u[n][i][l] += alpha[l] * s->p[n][i][l];
                s->r[n][i][l] -= alpha[l] * s->Kp[n][i][l];
            }
    precondition(s, rz);
    LAR_EACH_LOAD beta[l] = s->rz[l] > 0 ? rz[l] / s->rz[l] : 0;
    LAR_EACH_LOAD s->rz[l] = rz[l];
    turn(s, beta);
}

/* Whether the last steps have added less than a hundredth to every load's work. */
static bool done(const search *s, int steps, const double work[LAR_LOADS]) {
    static const double LITTLE = 0.01;
    if (steps < STEPS_LAST) return false;
    LAR_EACH_LOAD {
        double last = 0;
        for (int k = 0; k < STEPS_LAST; k++) last += s->gain[k][l];
        if (last > LITTLE * work[l]) return false;
    }
    return true;
}

static lar_status begin(search *s, const lar_elastic *elastic, lar_error *error) {
    size_t nodes = (size_t)elastic->node_count;
    *s = (search){.elastic = elastic,
                  .diagonal = lar_calloc(nodes, sizeof *s->diagonal),
                  .r = lar_calloc(nodes, sizeof *s->r),
                  .z = lar_calloc(nodes, sizeof *s->z),
                  .p = lar_calloc(nodes, sizeof *s->p),
                  .Kp = lar_calloc(nodes, sizeof *s->Kp)};
    if (!s->diagonal || !s->r || !s->z || !s->p || !s->Kp)
        return lar_fail_memory(error, nodes * (sizeof *s->diagonal + 4 * sizeof *s->r),
                               "conjugate gradients");
    lar_elastic_diagonal(elastic, s->diagonal);
    return lar_coarse_create(elastic, &s->coarse, error);
}

static void end(search *s) {
    lar_coarse_clear(&s->coarse);
    free(s->diagonal);
    free(s->r);
    free(s->z);
    free(s->p);
    free(s->Kp);
}

lar_status lar_elastic_solve(const lar_elastic *elastic, const lar_load_vectors *f,
                             lar_load_vectors *u, double work[LAR_LOADS], lar_error *error) {
    const double none[LAR_LOADS] = {0};
    search s;
    LAR_EACH_LOAD work[l] = 0;
    lar_status status = begin(&s, elastic, error);
    if (!status) { /* what r has where nothing moves does no work: z is 0 there */
        size_t bytes = (size_t)elastic->node_count * sizeof *f;
        memset(u, 0, bytes);
        memcpy(s.r, f, bytes);
        precondition(&s, s.rz);
        turn(&s, none);
    }
    for (int steps = 0; !status && steps < STEPS_MAX && !done(&s, steps, work); steps++) {
        double *gain = s.gain[steps % STEPS_LAST];
        step(&s, u, gain);
        LAR_EACH_LOAD work[l] += gain[l];
        if (elastic->goes_on && !elastic->goes_on(elastic->asker))
            status = lar_fail(error, LAR_ERROR_ARGUMENT, "stopped as asked, while measuring");
    }
    end(&s);
    return status;
}
