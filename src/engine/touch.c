#include "engine/touch.h"

lar_status lar_touch_create(const lar_model *model, const int32_t *local,
                            const lar_condition_share *share, const lar_tool_list *list,
                            const lar_tools *tools, lar_touch *touch, lar_error *error) {
    (void)model, (void)local, (void)share, (void)error;
    *touch = (lar_touch){.list = list, .tools = tools};
    return LAR_OK;
}

void lar_touch_destroy(lar_touch *touch) {
    *touch = (lar_touch){0};
}

void lar_touch_apply(lar_touch *touch, const lar_condition_context *context, lar_state *state) {
    (void)touch, (void)context, (void)state;
}

void lar_touch_half_work(const lar_touch *touch, const lar_condition_context *context,
                         lar_state *state) {
    (void)touch, (void)context, (void)state;
}
