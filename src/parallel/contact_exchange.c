#include "parallel/contact_exchange.h"

#include <math.h>
#include <string.h>

#include "contact/history/body_friction.h"

/* ---- waiting --------------------------------------------------------------------------------- */

static lar_status wait_for_threads(const lar_processor *p, uint64_t round, lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t t = 0; t < p->thread_count && !status; t++)
        status = lar_processor_await(p, &p->exchange->sequence[t].round, round, error);
    return status;
}

/* ---- the exchange buffer --------------------------------------------------------------------- */

/* Where the node with this number here is, how fast, and its step. */
static void write_place(const lar_state *state, const double rest[3], int32_t local,
                        double to[LAR_PLACE_VALUES]) {
    const double *u = state->u + local, *v = state->v + local;
    const size_t y = state->stride, z = 2 * y;
    to[0] = rest[0] + u[0];
    to[1] = rest[1] + u[y];
    to[2] = rest[2] + u[z];
    to[3] = v[0];
    to[4] = v[y];
    to[5] = v[z];
    to[6] = state->level[local];
}

static inline double fastest_of(const double place[LAR_PLACE_VALUES], double max) {
    const double x = fabs(place[3]), y = fabs(place[4]), z = fabs(place[5]);
    /* Seldom; numbers that are none come here as well. */
    if (__builtin_expect(!((x <= max) & (y <= max) & (z <= max)), 0))
        max = lar_larger(lar_larger(lar_larger(max, x), y), z);
    return max;
}

void lar_contact_publish(lar_worker *worker, uint64_t round) {
    const lar_processor *p = worker->processor;
    lar_contact_exchange *exchange = p->exchange;
    const lar_contact_surface *surface = exchange->map->surface;
    const lar_publish_list publish = exchange->publish[worker->thread];
    lar_contact_sequence *sequence = &exchange->sequence[worker->thread];
    const lar_state state = worker->state;
    const int32_t *local = exchange->local;
    double(*place)[LAR_PLACE_VALUES] = exchange->place[round & 1], max = 0;
    for (int32_t i = 0; i < publish.count; i++) {
        int32_t node = publish.node[i];
        double *to = place[publish.slot[i]];
        write_place(&state, surface->rest[node], local[node], to);
        max = fastest_of(to, max);
    }
    for (int32_t i = 0; i < publish.count && exchange->stick[0]; i++)
        memcpy(exchange->stick[round & 1][publish.slot[i]],
               lar_stick_of(surface, &worker->state, publish.node[i]), sizeof *exchange->stick[0]);
    sequence->speed[round & 1] = max;
    __atomic_store_n(&sequence->round, round, __ATOMIC_RELEASE);
}

void lar_contact_begin(lar_processor *p) {
    lar_contact_exchange *exchange = p->exchange;
    if (!exchange) return;
    exchange->arrived.round = 0;
    for (int32_t t = 0; t < p->thread_count; t++) exchange->sequence[t].round = 0;
}

/* ---- packets --------------------------------------------------------------------------------- */

/* Where a packet of so many places begins in the receiver's buffer, and its size. */
static size_t packet_place(const lar_contact_map *map, int32_t from, int32_t to, int32_t count,
                           size_t *bytes) {
    *bytes = (size_t)count * lar_contact_node_bytes(map->surface);
    return map->shift[to] + map->region[from + 1] - LAR_PACKET_ALIGN - *bytes;
}

static void pack(const lar_contact_exchange *exchange, int side, int32_t slot, unsigned char *to) {
    memcpy(to, exchange->place[side][slot], sizeof *exchange->place[side]);
    if (exchange->stick[side])
        memcpy(to + sizeof *exchange->place[side], exchange->stick[side][slot],
               sizeof *exchange->stick[side]);
}

static void unpack(const lar_contact_exchange *exchange, int side, int32_t slot, const char *from) {
    memcpy(exchange->place[side][slot], from, sizeof *exchange->place[side]);
    if (exchange->stick[side])
        memcpy(exchange->stick[side][slot], from + sizeof *exchange->place[side],
               sizeof *exchange->stick[side]);
}

lar_status lar_contact_send(lar_worker *worker, uint64_t round, lar_error *error) {
    const lar_processor *p = worker->processor;
    const lar_contact_exchange *exchange = p->exchange;
    if (worker->thread != 0 || exchange->peer_count == 0) return LAR_OK;
    lar_status status = wait_for_threads(p, round, error);
    for (int32_t i = 0; i < exchange->peer_count && !status; i++) {
        const lar_contact_peer *peer = &exchange->peer[i];
        size_t bytes;
        size_t place = packet_place(exchange->map, p->self, peer->peer, peer->send_count, &bytes);
        unsigned char *to = lar_comm_room(p->comm, peer->peer, place, bytes, round);
        if (!to) to = exchange->gather;
        for (int32_t k = 0; k < peer->send_count; k++)
            pack(exchange, round & 1, peer->send[k],
                 to + (size_t)k * lar_contact_node_bytes(exchange->map->surface));
        status = lar_comm_put(p->comm, peer->peer, place, to, bytes, round, error);
    }
    return status;
}

/* Thread 0: what the others have sent goes into the exchange buffer. */
static lar_status receive_places(const lar_processor *p, uint64_t round, lar_error *error) {
    lar_contact_exchange *exchange = p->exchange;
    double max = 0;
    for (int32_t i = 0; i < exchange->peer_count; i++) {
        const lar_contact_peer *peer = &exchange->peer[i];
        size_t bytes;
        size_t place =
            packet_place(exchange->map, peer->peer, p->self, peer->receive_count, &bytes);
        const void *payload;
        lar_status status =
            lar_comm_wait(p->comm, peer->peer, place, bytes, round, &payload, error);
        if (status) return status;
        for (int32_t k = 0; k < peer->receive_count; k++) {
            unpack(exchange, round & 1, peer->receive[k],
                   (const char *)payload +
                       (size_t)k * lar_contact_node_bytes(exchange->map->surface));
            max = fastest_of(exchange->place[round & 1][peer->receive[k]], max);
        }
    }
    exchange->arrived.speed[round & 1] = max;
    __atomic_store_n(&exchange->arrived.round, round, __ATOMIC_RELEASE);
    return LAR_OK;
}

lar_status lar_contact_apply(lar_worker *worker, uint64_t round, lar_error *error) {
    lar_processor *p = worker->processor;
    lar_contact_exchange *exchange = p->exchange;
    lar_body_contact *contact = &worker->interactions.body_contact;
    lar_status status = wait_for_threads(p, round, error);
    if (status) return status;
    if (worker->thread == 0)
        status = receive_places(p, round, error);
    else
        status = lar_processor_await(p, &exchange->arrived.round, round, error);
    if (status) return status;
    double speed = exchange->arrived.speed[round & 1];
    for (int32_t t = 0; t < p->thread_count; t++)
        speed = lar_larger(speed, exchange->sequence[t].speed[round & 1]);
    contact->view.place = (const double(*)[LAR_PLACE_VALUES])exchange->place[round & 1];
    contact->view.stick = (const double(*)[LAR_STICK_VALUES])exchange->stick[round & 1];
    /* What stands in the exchange buffer has come here in the last step with this speed. */
    contact->travel += speed * worker->state.past;
    lar_body_contact_add(contact, &worker->context, &worker->state);
    lar_body_contact_half_work(contact, &worker->context, &worker->state);
    return LAR_OK;
}

/* ---- in time --------------------------------------------------------------------------------- */

void lar_contact_check_travel(lar_worker *worker, uint64_t rounds, bool ends) {
    const lar_body_contact *contact = &worker->interactions.body_contact;
    const lar_state *state = &worker->state;
    double allowed = 0.5 * contact->list.skin;
    double speed = fmax(2 * state->fastest, LAR_CONTACT_SPEED);
    bool late = !(contact->moved <= allowed) && !ends;
    if (late && !worker->fault.kind)
        worker->fault = (lar_fault){.kind = LAR_FAULT_TOO_FAST,
                                    .element = -1,
                                    .step = state->part == 0 ? state->step - 1 : state->step};
    if (contact->moved + (double)(rounds + 1) * speed * worker->context.time_step > allowed)
        lar_processor_ask_stop(worker->processor, worker->round + rounds);
}
