/* One change of gravity, damping, stiffness, parameters of materials, activation, tools, forces on
 * nodes or supports: what is asked of a session, recorded and replayed. */
#ifndef LAR_SESSION_SETTING_H
#define LAR_SESSION_SETTING_H

#include "base/error.h"

/* The numbers stand in recordings. */
typedef enum lar_setting_kind {
    LAR_SETTING_GRAVITY = 0,   /* value[0..2] */
    LAR_SETTING_MODEL_GRAVITY, /* as the model says */
    LAR_SETTING_DAMPING,       /* value[0] */
    LAR_SETTING_STIFFNESS,     /* value[0], of material `of`; -1: all */
    LAR_SETTING_ADD_TOOL,      /* of = lar_setting_of_tool: radius, length, spread */
    LAR_SETTING_REMOVE_TOOL,   /* tool `of` */
    LAR_SETTING_FORCE,         /* value[0..2], zeros: none, on node `of`; -1: all are gone */
    LAR_SETTING_FORCE_ON,      /* the same on every node of set `of` of the model */
    LAR_SETTING_ACTIVATION,    /* value[0], of material `of`; -1: all that are active */
    LAR_SETTING_SUPPORT,       /* axes value[0] of node `of`; value[1]: held (not 0) or released */
    LAR_SETTING_SUPPORT_ON,    /* the same of every node of set `of` of the model */
    LAR_SETTING_PARAMETER,     /* value[0], of material `of`: its parameter value[1], counted as in
                                  model/parameters.h; -1: all are the model's */
    LAR_SETTING_KINDS
} lar_setting_kind;

typedef struct lar_setting {
    lar_setting_kind kind;
    int32_t of;
    uint32_t members; /* lar_setting_members of set `of`, as it was recorded; 0: not told */
    double value[3];
} lar_setting;

/* Tells sets apart that have the same number in two models: a hash of the nodes of the set that it
 * is about; 0 where it is about none. */
uint32_t lar_setting_members(const lar_setting *setting, const lar_simulation *simulation);

/* Shape and place among the spares of a tool that is added, as one number. */
static inline int32_t lar_setting_of_tool(int32_t shape, int32_t place) {
    return LAR_TOOL_HAND * place + shape;
}

/* LAR_ERROR_MODEL where it was recorded of another set; else as the call that it stands for. */
lar_status lar_setting_apply(const lar_setting *setting, lar_simulation *simulation,
                             lar_error *error);

#endif
