#include "engine/hold.h"

lar_status lar_hold_update(const lar_domain *whole, const lar_state *state,
                           const lar_tool_list *list, int32_t tool, const lar_tool_pose *pose,
                           lar_tools *tools, lar_error *error) {
    (void)whole, (void)state, (void)list, (void)tool, (void)pose, (void)tools, (void)error;
    return LAR_OK;
}
