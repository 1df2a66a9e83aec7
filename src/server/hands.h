/* Which viewer moves which tool: hands are assigned on request, instruments belong to whoever moves
 * them.
 *
 *     grab: free --> asked --> holding --> (release, leave) --> free
 *                      '-- nothing there: missed --> free
 *
 * The session takes hold and lets go (lar_session_ask_grasp). All of this is the server's thread's;
 * lar_hands_look sees the answers, every few milliseconds while lar_hands_busy.
 */
#ifndef LAR_SERVER_HANDS_H
#define LAR_SERVER_HANDS_H

#include "server/message.h"

typedef enum lar_hand_state { LAR_HAND_FREE = 0, LAR_HAND_ASKED, LAR_HAND_HOLDING } lar_hand_state;

typedef struct lar_hand {
    int32_t tool;
    lar_hand_state state;
    uint64_t viewer; /* whose it is, and under which number */
    int32_t number;
    uint64_t ticket; /* of its grasp */
    double to[3];    /* where it was last pulled */
} lar_hand;

/* Who moves a tool that is no hand. */
typedef struct lar_owner {
    uint64_t viewer; /* 0: nobody */
    int32_t serial;  /* of the tool: one that is added later is another's */
    int64_t moved;   /* [ns] */
    lar_tool_pose pose;
    uint64_t deaf_to; /* who moved it when the run was put somewhere else: until then [ns] what was
                         on its way from there is not heard */
    int64_t deaf_until;
} lar_owner;

/* News of a hand for its viewer: `state` is a word of the protocol. */
typedef void lar_hand_news(void *context, uint64_t viewer, int32_t number, int32_t tool,
                           const char *state);

typedef struct lar_hands {
    lar_session *session;
    int32_t first_spare, tools; /* the tools that may be added, and all */
    lar_hand_news *tell;
    void *context;
    int32_t count;    /* of hands */
    uint64_t tickets; /* given out */
    lar_hand hand[LAR_TOOLS_MAX];
    lar_owner owner[LAR_TOOLS_MAX]; /* by tool */
    uint64_t placed;                /* lar_session_status.placed, as last seen */
} lar_hands;

void lar_hands_create(lar_hands *hands, lar_session *session, lar_hand_news *tell, void *context);

/* Grab, pull, release: `command` is of these kinds. What is refused is told. */
void lar_hands_execute(lar_hands *hands, uint64_t viewer, const lar_command *command, int64_t now);
/* Moves an instrument; an error when it is another's, with who it is. */
lar_status lar_hands_move(lar_hands *hands, uint64_t viewer, const lar_command *command,
                          int64_t now, lar_error *error);
/* Whether it may be taken away: nobody else moves it. */
lar_status lar_hands_may_remove(lar_hands *hands, uint64_t viewer, int32_t tool, int64_t now,
                                lar_error *error);
/* The viewer is gone: it lets go of everything. */
void lar_hands_leave(lar_hands *hands, uint64_t viewer);

void lar_hands_look(lar_hands *hands, int64_t now);
/* Whether a hand waits for its answer, so that somebody should look soon again. */
bool lar_hands_busy(const lar_hands *hands);

/* Who moves a tool: "nobody", "you" (this viewer), "other", "device". */
const char *lar_hands_by(const lar_hands *hands, int32_t tool, uint64_t viewer, int64_t now);

#endif
