/* A prediction beside the clock: the same model, here, on one and on two processors, predicted from
 * what was measured in the same run. The fastest samples compare: what else runs on the machine can
 * only add to them. */
#ifndef LAR_STUDY_PREDICT_PREDICT_CHECK_H
#define LAR_STUDY_PREDICT_PREDICT_CHECK_H

#include "study/bench/kernel.h"
#include "study/predict/predict.h"

enum { LAR_PREDICT_CHECKS = 2 };

typedef struct lar_predict_check {
    char grid[LAR_PREDICT_CHECKS][LAR_GRID_TEXT];
    const char *comm;
    double predicted[LAR_PREDICT_CHECKS];    /* step [s] */
    lar_spread measured[LAR_PREDICT_CHECKS]; /* [s] */
} lar_predict_check;

/* Runs the scaling benchmark (`scene`: for processes that it starts) and gives
 * `machine`, which was measured already, the time per element of its plain loop. */
lar_status lar_predict_check_here(const lar_model *model, const char *scene, const char *comm,
                                  int repeat, lar_cluster *machine, lar_predict_check *out,
                                  lar_error *error);

#endif
