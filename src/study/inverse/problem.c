#include "study/inverse/problem.h"

#include <stdlib.h>

const char *const lar_inverse_kind_name[LAR_INVERSE_KINDS] = {
    "tension", "compression", "indentation", "aspiration", "markers", "surface"};

void lar_inverse_problem_clear(lar_inverse_problem *p) {
    for (int j = 0; j < p->parameters; j++) {
        free(p->parameter[j].material);
        free(p->parameter[j].name);
    }
    for (int k = 0; k < p->experiments; k++) {
        lar_inverse_experiment *e = &p->experiment[k];
        lar_model_destroy(e->model);
        lar_embedded_surface_clear(&e->points);
        free(e->name);
        free(e->scene);
        free(e->data);
        free(e->pressure);
        free(e->aspiration.node);
        free(e->aspiration.suction);
        free(e->row_line);
        free(e->time);
        free(e->along);
        free(e->measured);
        free(e->error);
    }
    free(p->path);
    free(p->title);
    *p = (lar_inverse_problem){0};
}

bool lar_inverse_new_moment(const lar_inverse_experiment *e, int32_t i) {
    const double(*suction)[2] = (const double(*)[2])e->aspiration.suction;
    if (i == 0) return true;
    return e->in_time ? e->time[i] != e->time[i - 1] : suction[i][1] != suction[i - 1][1];
}

const char *lar_inverse_whole(const lar_inverse_experiment *e) {
    return e->kind == LAR_INVERSE_SURFACE ? "the body's length" : "the largest";
}

int32_t lar_inverse_problem_values(const lar_inverse_problem *p) {
    int32_t values = 0;
    for (int k = 0; k < p->experiments; k++) values += p->experiment[k].values;
    return values;
}
