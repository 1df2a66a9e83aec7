/* A recording that is played in a session: at the clock's pace, and from any place of it.
 *
 *     records    state  move move hash ... reset move ... hash end     all in memory, by place
 *     place      0-------------------------->|---------------> length  steps that were computed
 *     keys       ^        ^        ^         ^        ^                states, kept as they come by
 *
 * A recording may go back (reset, load); its places only grow: they count the steps that were
 * computed. To go to a place the nearest key before it is taken up, and what lies between is
 * computed, from the same bits to the same bits. Every hash on the way is compared.
 */
#ifndef LAR_SESSION_RECORDING_PLAYER_H
#define LAR_SESSION_RECORDING_PLAYER_H

#include "simulation/simulation.h"
#include "session/recording/file.h"

enum { LAR_KEYS_MAX = 64 };

typedef struct lar_play_record {
    lar_record record;
    uint64_t place;
    lar_bytes state; /* of LAR_RECORD_STATE */
} lar_play_record;

/* A state that was come by, before the records of its place. */
typedef struct lar_play_key {
    uint64_t place;
    size_t next;
    lar_bytes state;
} lar_play_key;

typedef struct lar_player {
    char *path;
    lar_recording_header header;
    lar_play_record *record;
    size_t count, capacity;
    uint64_t length; /* in steps */
    uint64_t place;  /* now */
    uint64_t goal;   /* where somebody wants to go, computed as fast as it goes */
    size_t next;     /* record */
    lar_play_key key[LAR_KEYS_MAX];
    int keys, keys_max;
    uint64_t key_every; /* steps */
    bool rests;         /* when it comes to its goal */
} lar_player;

/* Reads the whole file. The caller closes the player. */
lar_status lar_player_open(const char *path, lar_player **player, lar_error *error);
void lar_player_close(lar_player *player); /* NULL is fine */

/* Puts the simulation where the recording begins; refuses one of another model. */
lar_status lar_player_begin(lar_player *player, lar_simulation *simulation, lar_error *error);
/* Goes on by `steps`, at most to the end. LAR_ERROR_FORMAT when a hash differs. A recording that
 * ends because its run broke ends here, without an error, one tick before. */
lar_status lar_player_advance(lar_player *player, lar_simulation *simulation, uint64_t steps,
                              lar_error *error);
/* The place to go to; goes back to a key at once when it lies behind. */
lar_status lar_player_seek(lar_player *player, lar_simulation *simulation, uint64_t place,
                           lar_error *error);

/* Wherever somebody wanted to go, it stays here. */
static inline void lar_player_stay(lar_player *player) {
    player->goal = 0;
    player->rests = false;
}

#endif
