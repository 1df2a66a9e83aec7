#include "parallel/sudden.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* So many steps after it nodes are as fast as it makes them, for who looks at these. */
enum { STEPS = 4 };

lar_status lar_sudden_create(const lar_model *model, lar_sudden *sudden, lar_error *error) {
    const size_t curves = (size_t)model->curve_count;
    *sudden = (lar_sudden){0};
    if (curves == 0) return LAR_OK;
    sudden->size = lar_calloc(curves, sizeof *sudden->size);
    if (!sudden->size) return lar_fail_memory(error, curves * sizeof *sudden->size, "curves");
    for (size_t c = 0; c < curves; c++) {
        const lar_curve *curve = &model->curve[c];
        sudden->size[c] = curve->kind == LAR_CURVE_RAMP || curve->count == 0;
        for (int i = 0; i < curve->count; i++)
            sudden->size[c] = fmax(sudden->size[c], fabs(curve->point[i][1]));
    }
    return LAR_OK;
}

void lar_sudden_destroy(lar_sudden *sudden) {
    free(sudden->size);
    *sudden = (lar_sudden){0};
}

void lar_sudden_note(lar_sudden *sudden, const lar_tools *tools, uint64_t step, bool fresh) {
    const size_t bytes =
        offsetof(lar_forces, entry) + (size_t)tools->forces.count * sizeof tools->forces.entry[0];
    if (!fresh && memcmp(&sudden->settings, &tools->settings, sizeof tools->settings) == 0 &&
        memcmp(&sudden->forces, &tools->forces, bytes) == 0)
        return;
    sudden->since = step;
    sudden->settings = tools->settings;
    memcpy(&sudden->forces, &tools->forces, bytes);
}

/* Whether a curve goes farther in the last steps than it could in so many from its beginning to its
 * end. */
static bool jumps(const lar_sudden *sudden, const lar_domain *whole, uint64_t step) {
    static const double SHARE = 0.25;
    const lar_model *model = whole->model;
    const double now = (double)(step + 1) * whole->time_step, dt = whole->time_step;
    for (int c = 0; c < model->curve_count; c++) {
        const double before = lar_curve_value(&model->curve[c], fmax(0, now - STEPS * dt));
        const double way = lar_curve_value(&model->curve[c], now) - before;
        if (!(fabs(way) <= SHARE * sudden->size[c])) return true;
    }
    return false;
}

uint64_t lar_sudden_next(const lar_sudden *sudden, const lar_domain *whole, uint64_t step,
                         uint64_t end) {
    if (step < sudden->since + STEPS) return step;
    while (step < end && !jumps(sudden, whole, step)) step++;
    return step;
}
