#include "server/hands.h"

#include <string.h>

#include "base/clock.h"
#include "base/error.h"

/* An instrument is its mover's for so long after the last move [ns]. */
static const int64_t OWNED = 1000000000;
/* What a viewer sends before it knows of a reset is here by then [ns]: status comes every 0.1 s. */
static const int64_t ON_ITS_WAY = 300000000;
void lar_hands_create(lar_hands *hands, lar_session *session, lar_hand_news *tell, void *context) {
    lar_session_info about;
    lar_simulation_info simulation;
    lar_session_inspect(session, &about);
    lar_simulation_inspect(about.simulation, &simulation);
    *hands = (lar_hands){.session = session,
                         .first_spare = simulation.tools,
                         .tools = simulation.tools + simulation.spares,
                         .tell = tell,
                         .context = context};
    for (int32_t i = 0; i < hands->tools; i++) {
        lar_tool_info info;
        lar_session_tool_info(session, i, &info, NULL);
        hands->owner[i].serial = info.serial;
        if (info.shape == LAR_TOOL_HAND) hands->hand[hands->count++] = (lar_hand){.tool = i};
        hands->owner[i].pose = info.rest;
    }
}

/* ---- hands ---------------------------------------------------------------------------------- */

static void put(lar_hands *hands, const lar_hand *hand, double opening) {
    lar_tool_pose pose = {.orientation = {1, 0, 0, 0}, .opening = opening};
    memcpy(pose.position, hand->to, sizeof pose.position);
    lar_session_tool_move(hands->session, hand->tool, &pose, NULL);
}

/* In the order of what was asked for; where that is too much already, by its newest place. */
static void let_go(lar_hands *hands, lar_hand *hand) {
    if (lar_session_ask_release(hands->session, hand->tool, NULL)) put(hands, hand, 1);
    hand->state = LAR_HAND_FREE;
    hand->viewer = 0;
}

static void tell(lar_hands *hands, const lar_hand *hand, const char *state) {
    hands->tell(hands->context, hand->viewer, hand->number, hand->tool, state);
}

/* The run was put somewhere else: instruments are where its state has them, and nobody's;
 * hands let go, also of what that state has them hold. */
static void look_where_it_is(lar_hands *hands, const lar_session_status *status, int64_t now) {
    if (status->placed == hands->placed) return;
    hands->placed = status->placed;
    for (int32_t i = 0; i < hands->tools; i++) {
        lar_owner *owner = &hands->owner[i];
        if (owner->viewer == 0) continue;
        *owner = (lar_owner){
            .serial = owner->serial, .deaf_to = owner->viewer, .deaf_until = now + ON_ITS_WAY};
    }
    for (int32_t i = 0; i < hands->count; i++) {
        if (hands->hand[i].state != LAR_HAND_HOLDING) continue;
        tell(hands, &hands->hand[i], "lost");
        let_go(hands, &hands->hand[i]);
    }
}

/* A tool that was added is nobody's yet. */
static void look_at_tools(lar_hands *hands) {
    for (int32_t i = hands->first_spare; i < hands->tools; i++) {
        lar_tool_info info;
        lar_session_tool_info(hands->session, i, &info, NULL);
        if (hands->owner[i].serial != info.serial)
            hands->owner[i] = (lar_owner){.serial = info.serial, .pose = info.rest};
    }
}

static void look_again(lar_hands *hands, int64_t now) {
    lar_session_status status;
    lar_session_status_get(hands->session, &status);
    look_where_it_is(hands, &status, now);
    look_at_tools(hands);
}

static lar_hand *find(lar_hands *hands, uint64_t viewer, int32_t number) {
    for (int32_t i = 0; i < hands->count; i++)
        if (hands->hand[i].state != LAR_HAND_FREE && hands->hand[i].viewer == viewer &&
            hands->hand[i].number == number)
            return &hands->hand[i];
    return NULL;
}

static lar_hand *find_free(lar_hands *hands, int64_t now) {
    for (int32_t i = 0; i < hands->count; i++)
        if (hands->hand[i].state == LAR_HAND_FREE &&
            strcmp(lar_hands_by(hands, hands->hand[i].tool, 0, now), "nobody") == 0)
            return &hands->hand[i];
    return NULL;
}

static void grab(lar_hands *hands, uint64_t viewer, const lar_command *command, int64_t now) {
    lar_hand *hand = find(hands, viewer, command->hand);
    if (!hand) hand = find_free(hands, now);
    if (!hand) {
        hands->tell(hands->context, viewer, command->hand, -1, "refused");
        return;
    }
    hand->viewer = viewer;
    hand->number = command->hand;
    memcpy(hand->to, command->point, sizeof hand->to);
    hand->state = LAR_HAND_ASKED;
    hand->ticket = ++hands->tickets;
    if (!lar_session_ask_grasp(hands->session, hand->tool, command->point, hand->ticket, NULL))
        return;
    tell(hands, hand, "refused");
    let_go(hands, hand);
}

void lar_hands_execute(lar_hands *hands, uint64_t viewer, const lar_command *command, int64_t now) {
    lar_hand *hand = find(hands, viewer, command->hand);
    if (command->kind == LAR_COMMAND_GRAB) {
        grab(hands, viewer, command, now);
    } else if (hand && command->kind == LAR_COMMAND_PULL) {
        memcpy(hand->to, command->point, sizeof hand->to);
        if (hand->state == LAR_HAND_HOLDING) put(hands, hand, 0);
    } else if (hand && command->kind == LAR_COMMAND_RELEASE) {
        let_go(hands, hand);
    }
}

/* The session has answered: it has hold of something, or is open again. */
static void take_answer(lar_hands *hands, lar_hand *hand) {
    lar_grasp_answer answer;
    if (lar_session_grasp_answer(hands->session, hand->tool, &answer, NULL) ||
        answer.ticket != hand->ticket)
        return;
    tell(hands, hand, answer.held > 0 ? "holding" : "missed");
    if (answer.held > 0) {
        hand->state = LAR_HAND_HOLDING;
        put(hands, hand, 0);
    } else {
        let_go(hands, hand);
    }
}

static void go_on(lar_hands *hands, lar_hand *hand, const lar_session_status *status) {
    lar_tool_force force;
    if (hand->state == LAR_HAND_ASKED) {
        take_answer(hands, hand);
        return;
    }
    if (lar_session_tool_force(hands->session, hand->tool, NULL, &force, NULL)) return;
    if (force.held > 0 || status->state != LAR_SESSION_PLAYING) return;
    tell(hands, hand, "lost");
    let_go(hands, hand);
}

void lar_hands_look(lar_hands *hands, int64_t now) {
    lar_session_status status;
    lar_session_status_get(hands->session, &status);
    look_where_it_is(hands, &status, now);
    look_at_tools(hands);
    for (int32_t i = 0; i < hands->count; i++)
        if (hands->hand[i].state != LAR_HAND_FREE) go_on(hands, &hands->hand[i], &status);
}

bool lar_hands_busy(const lar_hands *hands) {
    for (int32_t i = 0; i < hands->count; i++)
        if (hands->hand[i].state == LAR_HAND_ASKED) return true;
    return false;
}

/* ---- instruments ----------------------------------------------------------------------------- */

const char *lar_hands_by(const lar_hands *hands, int32_t tool, uint64_t viewer, int64_t now) {
    const lar_owner *owner = &hands->owner[tool];
    uint64_t who = owner->viewer && now - owner->moved < OWNED ? owner->viewer : 0;
    lar_device_status device;
    if (!lar_session_device(hands->session, tool, &device, NULL) && device.name) return "device";
    for (int32_t i = 0; i < hands->count; i++)
        if (hands->hand[i].tool == tool && hands->hand[i].state != LAR_HAND_FREE)
            who = hands->hand[i].viewer;
    return who == 0 ? "nobody" : who == viewer ? "you" : "other";
}

static lar_status check_owner(const lar_hands *hands, uint64_t viewer, int32_t tool, int64_t now,
                              lar_error *error) {
    const char *by = lar_hands_by(hands, tool, viewer, now);
    lar_tool_info info;
    lar_session_tool_info(hands->session, tool, &info, NULL);
    if (strcmp(by, "device") == 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT, "%s is moved by a device", info.name);
    if (strcmp(by, "other") == 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s is moved by another viewer; try again when it rests", info.name);
    return LAR_OK;
}

lar_status lar_hands_may_remove(lar_hands *hands, uint64_t viewer, int32_t tool, int64_t now,
                                lar_error *error) {
    look_again(hands, now);
    return check_owner(hands, viewer, tool, now, error);
}

lar_status lar_hands_move(lar_hands *hands, uint64_t viewer, const lar_command *command,
                          int64_t now, lar_error *error) {
    lar_owner *owner = &hands->owner[command->tool];
    lar_tool_info info;
    lar_session_tool_info(hands->session, command->tool, &info, NULL);
    if (info.shape == LAR_TOOL_HAND)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "%s is a hand; take hold of the surface with grab", info.name);
    if (info.shape == LAR_TOOL_NONE)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "place %ld has no tool: none was added there, or it was removed",
                        (long)command->tool);
    look_again(hands, now);
    if (owner->deaf_to == viewer && now < owner->deaf_until) return LAR_OK;
    lar_tool_pose pose;
    lar_status status = check_owner(hands, viewer, command->tool, now, error);
    if (!status) status = lar_session_tool_force(hands->session, command->tool, &pose, NULL, error);
    if (status) return status;
    if (owner->viewer == viewer && now - owner->moved < OWNED) pose = owner->pose;
    memcpy(pose.position, command->point, sizeof pose.position);
    if (command->turns) memcpy(pose.orientation, command->orientation, sizeof pose.orientation);
    if (command->opens) pose.opening = command->opening;
    status = lar_session_tool_move(hands->session, command->tool, &pose, error);
    if (status) return status;
    owner->viewer = viewer;
    owner->moved = now;
    owner->pose = pose;
    return LAR_OK;
}

void lar_hands_leave(lar_hands *hands, uint64_t viewer) {
    look_again(hands, lar_clock_ns());
    for (int32_t i = 0; i < hands->count; i++)
        if (hands->hand[i].state != LAR_HAND_FREE && hands->hand[i].viewer == viewer)
            let_go(hands, &hands->hand[i]);
    for (int32_t tool = 0; tool < hands->tools; tool++) {
        lar_owner *owner = &hands->owner[tool];
        if (owner->viewer != viewer) continue;
        owner->viewer = 0;
        lar_tool_info info;
        lar_session_tool_info(hands->session, tool, &info, NULL);
        if (info.shape != LAR_TOOL_GRASPER) continue;
        owner->pose.opening = 1;
        lar_session_tool_move(hands->session, tool, &owner->pose, NULL);
    }
}
