#include "model/rest.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double PI = 3.14159265358979;

double lar_model_rest_damping(const lar_model *model) {
    const lar_mesh *mesh = &model->mesh;
    double length = 0.0, slowest = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t i = 0; i < mesh->node_count; i++) {
            low = fmin(low, mesh->position[i][axis]);
            high = fmax(high, mesh->position[i][axis]);
        }
        length = fmax(length, high - low);
    }
    for (int i = 0; i < model->material_count; i++)
        slowest = fmin(slowest,
                       sqrt(lar_material_shear(&model->material[i]) / model->material[i].density));
    double damping = PI * slowest / length;
    return isfinite(damping) ? damping : 0.0;
}

double lar_model_slow_period(const lar_model *model) {
    double damping = lar_model_rest_damping(model); /* 2 omega */
    return damping > 0.0 ? 4.0 * PI / damping : 1.0;
}

double lar_model_memory(const lar_model *model) {
    static const double MEMORY = 0.05, DAMPED = 1; /* [s], [1/s] */
    const double swing = lar_model_slow_period(model);
    if (model->own_units) return swing;
    return model->damping >= DAMPED ? MEMORY : fmax(MEMORY, swing);
}

void lar_model_slow_to(lar_model *model, double period) {
    double share = period / lar_model_slow_period(model), factor = share * share;
    for (int i = 0; i < model->material_count; i++) model->material[i].density *= factor;
    for (int axis = 0; axis < 3; axis++) model->gravity[axis] /= factor;
}

/* The shortest time in which a curve would go through all its values, as fast as it is somewhere
 * before `end` [s]: of a ramp its length, of a wave a third of its period. Jumps take no time and
 * are not asked. */
static double fastest_of(const lar_curve *curve, double end) {
    double low = INFINITY, high = -INFINITY, rate = 0;
    if (curve->kind == LAR_CURVE_RAMP) return curve->over > 0 ? fmin(curve->over, end) : end;
    for (int i = 0; i < curve->count; i++) {
        const double *to = curve->point[i], *from = i > 0 ? curve->point[i - 1] : to;
        if (from[0] > end) break;
        low = fmin(low, to[1]);
        high = fmax(high, to[1]);
        if (to[0] > from[0]) rate = fmax(rate, fabs(to[1] - from[1]) / (to[0] - from[0]));
    }
    return rate > 0 ? fmin((high - low) / rate, end) : end;
}

static bool rubs(const lar_model *model) {
    bool any = false;
    for (int i = 0; i < model->contact_count; i++) any = any || model->contact[i].friction > 0;
    return any;
}

/* What is said where curves are faster than is followed. */
static void add_limit(lar_rest_words *words, double fastest, double followed) {
    const size_t said = strlen(words->text);
    if (followed > 1.01 * fastest) /* not for rounding */
        snprintf(words->text + said, sizeof words->text - said,
                 "; what a curve does within %.3g s takes some %.3g s, or the deck would take too "
                 "many steps",
                 fastest, followed);
}

lar_rest_words lar_model_follow_static(lar_model *model, const char *what) {
    static const double FEW = 2, MANY = 20, VISCOUS = 100, FOLLOWS = 20, VISCOUS_DAMPING = 0.1;
    static const double MOST = 20000; /* swings in all: steps have an end */
    const double end = model->duration;
    double period = end / VISCOUS, fastest = end;
    lar_rest_words words;
    for (int i = 0; i < model->curve_count; i++)
        fastest = fmin(fastest, fastest_of(&model->curve[i], end));
    model->by_material_time = end > 0 && lar_model_viscous(model);
    model->until_rest = !model->by_material_time;
    if (model->until_rest) period = fmin(fmax(lar_model_slow_period(model), end / MANY), end / FEW);
    /* What remembers how it came there must not lag behind. */
    double followed = fmax(fastest, end * FOLLOWS / MOST);
    if (model->by_material_time || rubs(model))
        period = fmin(period, followed / FOLLOWS);
    else
        followed = fastest;
    if (end > 0) lar_model_slow_to(model, period);
    model->damping = lar_model_rest_damping(model);
    model->damps_itself = model->until_rest;
    for (int i = 0; end > 0 && i < model->curve_count; i++)
        lar_curve_hold_from(&model->curve[i], end);
    if (model->until_rest) {
        snprintf(words.text, sizeof words.text,
                 "the %s is static: Lariat follows it in time, with a damping of at most %.3g 1/s, "
                 "until it is at rest",
                 what, model->damping);
        add_limit(&words, fastest, followed);
        return words;
    }
    model->damping *= VISCOUS_DAMPING;
    snprintf(words.text, sizeof words.text,
             "the %s is static and a material viscous: Lariat follows it in the material's time to "
             "the deck's end, %g s, with little mass and a damping of %.3g 1/s; only a slender "
             "body that bends may lag behind its loads",
             what, end, model->damping);
    add_limit(&words, fastest, followed);
    return words;
}

bool lar_model_repeats(const lar_model *model) {
    bool any = false;
    for (int i = 0; i < model->curve_count; i++) any = any || model->curve[i].repeats;
    for (int i = 0; i < model->material_count; i++) {
        const lar_wave *wave = &model->material[i].activation.wave;
        any = any || (wave->speed > 0 && wave->every > 0);
    }
    return any;
}

double lar_model_loads_end(const lar_model *model) {
    double end = 0.0;
    for (int i = 0; i < model->curve_count; i++) end = fmax(end, lar_curve_end(&model->curve[i]));
    for (int i = 0; i < model->material_count; i++) {
        const lar_wave *wave = &model->material[i].activation.wave;
        if (wave->speed > 0 && !(wave->every > 0))
            end = fmax(end, (wave->span + wave->length) / wave->speed);
    }
    for (int i = 0; i < model->tool_count; i++) {
        const lar_tool_script *path = &model->tool[i].path;
        if (path->count > 0) end = fmax(end, path->row[path->count - 1].time);
    }
    return end;
}
