#include "study/inverse/profile.h"

#include <math.h>
#include <string.h>

#include "study/inverse/parameters.h"

/* Squares with parameter j at u and the others where they fit best. No answer there: INFINITY. */
static lar_status squares_at(const lar_inverse_solver *best, int j, double u, double *squares,
                             int *runs) {
    lar_inverse_solver s;
    bool converged;
    lar_status status = lar_inverse_solver_create(best->problem, &best->options, &s, best->error);
    memcpy(s.start, best->best_u, sizeof s.start);
    s.start[j] = u;
    s.fixed[j] = true;
    memcpy(s.pace, best->pace, sizeof s.pace); /* squares are compared with the best ones */
    s.paces_fixed = true;
    s.before = best->runs + *runs;
    s.doing = "looking how far parameters can go";
    if (!status) status = lar_inverse_minimise(&s, &converged);
    *squares = s.best_squares;
    *runs += s.runs;
    lar_inverse_solver_clear(&s);
    if (status == LAR_ERROR_UNSTABLE || status == LAR_ERROR_MODEL) status = LAR_OK;
    return status;
}

/* From the best towards a bound: where the squares have grown by `limit`. The first look is at the
 * bound itself; then the way there is halved. */
static lar_status side(const lar_inverse_solver *best, int j, double limit, double bound,
                       double *end, bool *open, int *runs) {
    enum { HALVINGS = 7 };
    double inside = best->best_u[j], outside = bound, squares;
    lar_status status = squares_at(best, j, bound, &squares, runs);
    *open = !status && squares - best->best_squares <= limit;
    for (int i = 0; i < HALVINGS && !*open && !status && !lar_inverse_stopped(best); i++) {
        double middle = 0.5 * (inside + outside);
        status = squares_at(best, j, middle, &squares, runs);
        if (squares - best->best_squares <= limit)
            inside = middle;
        else
            outside = middle;
    }
    *end = *open ? bound : 0.5 * (inside + outside);
    return status;
}

lar_status lar_inverse_profile(const lar_inverse_solver *best, int j, double limit, double *low,
                               double *high, bool *open_low, bool *open_high, int *runs) {
    const lar_inverse_parameter *p = &best->problem->parameter[j];
    double end[2] = {0};
    *open_low = *open_high = false;
    lar_status status = side(best, j, limit, lar_inverse_u_low(p), &end[0], open_low, runs);
    if (!status) status = side(best, j, limit, lar_inverse_u_high(p), &end[1], open_high, runs);
    *low = lar_inverse_value(p, end[0]);
    *high = lar_inverse_value(p, end[1]);
    return status;
}
