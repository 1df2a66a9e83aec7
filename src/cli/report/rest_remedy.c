#include "cli/report/rest_remedy.h"

#include <math.h>
#include <stdio.h>

/* While a body swings, damping takes what is left of its motion and little more; where it creeps,
 * (damping / frequency)^2 times its kinetic energy is still to come. Neither can do anything about
 * what goes to and fro from one step to the next: of the velocities half a step before and after
 * such a step, whose product is the kinetic energy, one is minus the other, and what looks saw, the
 * square of the former, is as much above zero. */
const char *rest_remedy(const lar_rest *rest, double kinetic, double damping, double time_step,
                        bool touching, char text[REST_REMEDY_SIZE]) {
    static const double CREEPS = 10, TREMBLES = 0.5;
    if (rest->looked == 1 && -kinetic > TREMBLES * rest->mean_before) {
        snprintf(text, REST_REMEDY_SIZE,
                 "it goes to and fro from step to step: a smaller time step lets it come to rest, "
                 "--time-step %.2g",
                 0.8 * time_step);
        return text;
    }
    if (!(damping > 0))
        return "without damping nothing takes the motion away, give the scene a damping";
    if (!rest->looked) return "give more time with --until-rest --time";
    if (rest->looked == 2)
        return "viscous terms still relax, for a dozen of their times and more; the scene without "
               "`viscous` (moduli times g0) comes to the same rest sooner";
    if (!(rest->left < 1))
        return "look whether something still falls or turns freely, or give more time with "
               "--until-rest --time";
    bool creeps = rest->left * fabs(rest->strain) > CREEPS * rest->mean_before;
    if (creeps && touching) {
        snprintf(text, REST_REMEDY_SIZE,
                 "it creeps, or trembles where bodies touch: less damping lets it come to rest "
                 "sooner, or --time-step %.2g, or give more time with --until-rest --time",
                 0.5 * time_step);
        return text;
    }
    if (creeps)
        return "it creeps: less damping lets it come to rest sooner, or give more time with "
               "--until-rest --time";
    return "it swings: more damping lets it come to rest sooner, or give more time with "
           "--until-rest --time";
}
