#include "step/mass_scaling.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/supports.h"

/* ---- how much ------------------------------------------------------------------------------- */

static void sum_up(const lar_model *model, const lar_element_rate *rate, lar_mass_scaling *told) {
    double mass = 0;
    *told = (lar_mass_scaling){.time_step = model->mass_step,
                               .largest_share = model->mass_share,
                               .factor = 1,
                               .worst = -1};
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double own = rate[e].mass - rate[e].added;
        mass += 8 * own;
        if (!(rate[e].added > 0)) continue;
        told->elements++;
        told->added += 8 * rate[e].added;
        if (!(rate[e].mass > told->factor * own)) continue;
        told->factor = rate[e].mass / own;
        told->worst = e;
    }
    told->share = told->added / mass;
}

/* The part of its mass that a model needs more for all elements to be stable up to `step`. */
static double share_for(const lar_model *model, const lar_element_rate *rate, double step) {
    double mass = 0, added = 0;
    for (lar_gid e = 0; e < model->mesh.element_count; e++) {
        double own = rate[e].mass - rate[e].added;
        double takes = 0.25 * step * step * rate[e].square * rate[e].mass;
        mass += own;
        if (takes > own) added += takes - own;
    }
    return added / mass;
}

/* The longest step of all elements that so large a share allows. */
static double step_for(const lar_model *model, const lar_element_rate *rate, double shortest,
                       double share) {
    double good = shortest, bad = 2 * shortest;
    while (share_for(model, rate, bad) <= share) bad *= 2;
    while (bad - good > 1e-6 * good) {
        double step = 0.5 * (good + bad);
        if (share_for(model, rate, step) <= share)
            good = step;
        else
            bad = step;
    }
    return good;
}

lar_status lar_mass_scaling_check(const lar_model *model, const lar_element_rate *rate,
                                  const lar_step_bound *bound, lar_error *error) {
    static const double ROUNDED = 0.994; /* three digits of it are never too much */
    lar_mass_scaling told;
    if (!(bound->step > bound->without)) return LAR_OK;
    sum_up(model, rate, &told);
    if (told.share <= model->mass_share) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: mass_scaling: a stable step of %g s takes %.3g %% more mass, above the "
                    "largest_share of %g %% (element %lld alone needs %.4g times its mass); with "
                    "this share time_step can be %.3g s (%.3g s without added mass), and "
                    "largest_share may be larger",
                    lar_model_source(model), model->mass_step, 100 * told.share,
                    100 * model->mass_share, (long long)model->mesh.element_id[told.worst],
                    told.factor, ROUNDED * step_for(model, rate, bound->without, model->mass_share),
                    bound->without);
}

/* ---- what becomes slower -------------------------------------------------------------------- */

/* Frequencies of slow motions fall by what these gain in mass: with a shape p of the motion along
 * an axis, sqrt(p'Mp / p'(M + dM)p). The most that any polynomial p of second degree of the place
 * gains is the largest eigenvalue of dM against M among these (theory.md). */
enum { TERMS = 10 };

static void powers(const double x[3], double p[TERMS]) {
    int k = 4;
    p[0] = 1;
    for (int i = 0; i < 3; i++) {
        p[1 + i] = x[i];
        for (int j = 0; j <= i; j++) p[k++] = x[i] * x[j];
    }
}

/* A = L^-1 D L^-T where G = L L'. Terms that the nodes cannot tell from those before are left out
 * (one layer of elements has no square across it). */
static void reduce(double G[TERMS][TERMS], double A[TERMS][TERMS]) {
    for (int i = 0; i < TERMS; i++) {
        double whole = G[i][i];
        for (int k = 0; k < i; k++) { /* row i loses what it has of the rows before */
            double part = G[k][k] > 0 ? G[i][k] / G[k][k] : 0;
            for (int j = 0; j < TERMS; j++) G[i][j] -= part * G[k][j];
            for (int j = 0; j < TERMS; j++) A[i][j] -= part * A[k][j];
            for (int j = 0; j < TERMS; j++) G[j][i] -= part * G[j][k];
            for (int j = 0; j < TERMS; j++) A[j][i] -= part * A[j][k];
        }
        if (!(G[i][i] > 1e-10 * whole)) G[i][i] = 0;
    }
    for (int i = 0; i < TERMS; i++)
        for (int j = 0; j < TERMS; j++)
            A[i][j] = G[i][i] > 0 && G[j][j] > 0 ? A[i][j] / sqrt(G[i][i] * G[j][j]) : 0;
}

/* Largest eigenvalue of a symmetric matrix without negative ones, never too small and at most
 * 10^(1/1024) times too large: from the trace of its 1024th power. */
static double largest(double A[TERMS][TERMS]) {
    double logarithm = 0;
    for (int power = 1;; power *= 2) {
        double trace = 0, square[TERMS][TERMS] = {{0}};
        for (int i = 0; i < TERMS; i++) trace += A[i][i];
        if (!(trace > 0)) return 0;
        logarithm += log(trace) / power;
        if (power == 1024) return exp(logarithm);
        for (int i = 0; i < TERMS; i++)
            for (int j = 0; j < TERMS; j++)
                for (int k = 0; k < TERMS; k++) square[i][j] += A[i][k] / trace * (A[k][j] / trace);
        memcpy(A, square, sizeof square);
    }
}

/* What the most that a motion along an axis gains is, as a part of its mass. */
static double most_gained(const lar_model *model, const double (*mass)[2],
                          const unsigned char *held, const lar_model_info *box, int axis) {
    double G[TERMS][TERMS] = {{0}}, A[TERMS][TERMS] = {{0}};
    for (lar_gid n = 0; n < model->mesh.node_count; n++) {
        double x[3], p[TERMS];
        if (held[n] >> axis & 1) continue;
        for (int i = 0; i < 3; i++)
            x[i] = (2 * model->mesh.position[n][i] - box->lower[i] - box->upper[i]) /
                   (box->upper[i] - box->lower[i]);
        powers(x, p);
        for (int i = 0; i < TERMS; i++)
            for (int j = 0; j < TERMS; j++) {
                G[i][j] += mass[n][0] * p[i] * p[j];
                A[i][j] += mass[n][1] * p[i] * p[j];
            }
    }
    reduce(G, A);
    return largest(A);
}

static lar_status find_slowing(const lar_model *model, const lar_element_rate *rate,
                               const lar_model_info *box, double *slowing, lar_error *error) {
    size_t nodes = (size_t)model->mesh.node_count;
    double(*mass)[2] = lar_calloc(nodes, sizeof *mass), most = 0; /* of the node; added */
    unsigned char *held = lar_calloc(nodes, 1);
    if (mass && held) {
        lar_supports_mark(NULL, model, held);
        for (lar_gid e = 0; e < model->mesh.element_count; e++)
            for (int a = 0; a < 8; a++) {
                double *of = mass[model->mesh.element[e][a]];
                of[0] += rate[e].mass - rate[e].added;
                of[1] += rate[e].added;
            }
        for (int axis = 0; axis < 3; axis++)
            most = fmax(most, most_gained(model, (const double(*)[2])mass, held, box, axis));
    }
    lar_status status = mass && held ? LAR_OK : lar_fail_memory(error, nodes * 17, "the masses");
    free(mass);
    free(held);
    *slowing = 1 - 1 / sqrt(1 + most);
    return status;
}

lar_status lar_mass_scaling_tell(const lar_model *model, const lar_element_rate *rate,
                                 const lar_step_bound *bound, const lar_model_info *box,
                                 lar_mass_scaling *told, lar_error *error) {
    sum_up(model, rate, told);
    told->stable_step = bound->without;
    told->strained_share = model->strained_share;
    told->possible_step = step_for(model, rate, bound->without, model->mass_share);
    return told->elements > 0 ? find_slowing(model, rate, box, &told->slowing, error) : LAR_OK;
}
