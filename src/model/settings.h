/* Settings: what may be changed while a simulation runs, in place of what the model says.
 *
 *     model (constant)                     settings (zero and one: as the model says)
 *     gravity, may follow a curve   <----  gravity, constant
 *     damping                       <----  damping
 *     parameters of a material      <----  times its factor: laws are linear in them
 *     activation of a material      <----  times what was set
 *
 * Plain numbers without pointers: they travel with the tools (contact/tools.h) to all processors,
 * are in checkpoints, and change between steps only.
 */
#ifndef LAR_MODEL_SETTINGS_H
#define LAR_MODEL_SETTINGS_H

#include <stdint.h>

#include "model/model.h"

/* The last factor is that of all further materials, too. */
enum { LAR_FACTORS_MAX = 64 };

static const double LAR_GRAVITY_MAX = 1000; /* [m/s^2] */

typedef struct lar_settings {
    int32_t gravity_set, damping_set; /* 0: as the model says */
    double gravity[3];                /* [m/s^2] */
    double damping;                   /* [1/s] */
    double factor[LAR_FACTORS_MAX];   /* of the stiffness of materials */
    double activation[LAR_FACTORS_MAX];
} lar_settings;

static inline void lar_settings_reset(lar_settings *settings) {
    *settings = (lar_settings){.gravity_set = 0};
    for (int i = 0; i < LAR_FACTORS_MAX; i++) settings->factor[i] = settings->activation[i] = 1;
}

/* Whether somebody has set an activation. */
static inline int lar_settings_activate(const lar_settings *settings) {
    int any = 0;
    for (int i = 0; i < LAR_FACTORS_MAX; i++) any = any || settings->activation[i] != 1;
    return any;
}

/* The factor that is a material's. */
static inline int lar_factor_of(int32_t material) {
    return material < LAR_FACTORS_MAX ? material : LAR_FACTORS_MAX - 1;
}

/* `settings` may be NULL, here and below: as the model says [1/s]. */
static inline double lar_damping_of(const lar_model *model, const lar_settings *settings) {
    return settings && settings->damping_set ? settings->damping : model->damping;
}

/* Whether gravity follows a curve. */
static inline int lar_gravity_varies(const lar_model *model, const lar_settings *settings) {
    const int *curve = model->gravity_curve;
    if (settings && settings->gravity_set) return 0;
    return curve[0] >= 0 || curve[1] >= 0 || curve[2] >= 0;
}

/* Gravity at `time` [m/s^2], for a step of `width` (lar_curve_mean); 0: at that moment. */
void lar_gravity_at(const lar_model *model, const lar_settings *settings, double time, double width,
                    double gravity[3]);

/* Whether they are such as the public calls let through: for what comes from files and from other
 * processes. `time_step`: see lar_damping_fits. */
int lar_settings_good(const lar_settings *settings, double time_step);

/* Within one step damping can stop a node, but not turn it around: v' = keep v needs keep > 0. */
static inline int lar_damping_fits(double damping, double time_step) {
    return damping >= 0 && 0.5 * damping * time_step < 1;
}

#endif
