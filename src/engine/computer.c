#include "engine/computer.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/pin.h"
#include "engine/identity.h"

static int32_t seats(const lar_computer *computer) {
    return computer->hosted * computer->threads;
}

static lar_processor *processor_of(const lar_computer *computer, int32_t seat) {
    return &computer->processor[seat / computer->threads];
}

/* ---- what went wrong ----------------------------------------------------------------------- */

/* How little a seat's failure says: it may be a consequence of another one. */
static int consequence(const lar_computer *computer, int32_t seat) {
    const lar_processor *p = processor_of(computer, seat);
    if (p->worker && p->worker[seat % computer->threads].follows) return 2;
    return computer->seat[seat].status == LAR_ERROR_PEER;
}

static lar_status first_failure(lar_computer *computer, lar_error *error) {
    const lar_seat *chosen = NULL;
    int least = 3;
    for (int32_t i = 0; i < seats(computer); i++) {
        if (!computer->seat[i].status || consequence(computer, i) >= least) continue;
        chosen = &computer->seat[i];
        least = consequence(computer, i);
    }
    if (!chosen) return LAR_OK;
    computer->broken = true;
    if (error) *error = chosen->error;
    return chosen->status;
}

static bool earlier(const lar_trip *a, const lar_trip *b) {
    return a->kind && (!b->kind || a->step < b->step);
}

static void first_trip(const lar_computer *computer, lar_trip *trip) {
    for (int32_t i = 0; i < computer->hosted; i++)
        for (int32_t t = 0; t < computer->threads; t++) {
            const lar_trip *other = &computer->processor[i].worker[t].trip;
            if (earlier(other, trip)) *trip = *other;
        }
}

/* ---- opening ------------------------------------------------------------------------------- */

static lar_status open_comm(lar_computer *computer, lar_processor *p, lar_error *error) {
    const lar_options *options = computer->options;
    const lar_schedule *schedule = &computer->division.schedules.of[p->self];
    lar_comm_options comm = lar_comm_options_default();
    if (options->comm) comm.backend = options->comm;
    comm.self = p->self;
    comm.count = computer->division.grid.count;
    comm.receive_bytes = computer->shift[p->self] + (size_t)schedule->receive_bytes;
    comm.identity = computer->identity;
    comm.team = computer->team;
    comm.master = options->master;
    comm.listener = p->self == 0 ? options->listener : -1;
    /* A processor that lives may be slow on a busy machine; whether it lives is watched anyway, and
     * within one process it cannot die alone. */
    comm.patience = computer->team ? 120 : 20;
    return lar_comm_open(&comm, &p->comm, error);
}

static bool shares_memory(const lar_options *options) {
    return options->comm && strcmp(options->comm, "shm") == 0;
}

/* Every processor is compiled in its own first thread. */
static void compile_seat(void *context, int32_t number) {
    lar_computer *computer = context;
    lar_seat *seat = &computer->seat[number];
    if (number % computer->threads != 0) return;
    lar_processor *p = processor_of(computer, number);
    const lar_schedule *schedule =
        &computer->division.schedules.of[computer->first + number / computer->threads];
    lar_processor_setting setting = {.whole = computer->whole,
                                     .reporter = computer->division.reporter,
                                     .check = computer->checking ? &computer->check : NULL,
                                     .shift = computer->shift,
                                     .delays = computer->options->delays,
                                     .near = computer->team || shares_memory(computer->options)};
    seat->status = lar_processor_create(&setting, schedule, p, &seat->error);
    if (!seat->status) lar_processor_scatter(p, computer->whole, computer->start);
}

static void meet_seat(void *context, int32_t number) {
    lar_computer *computer = context;
    lar_seat *seat = &computer->seat[number];
    if (number % computer->threads != 0) return;
    seat->status = open_comm(computer, processor_of(computer, number), &seat->error);
}

static lar_status size_buffers(lar_computer *computer, bool several, lar_error *error) {
    int32_t count = computer->division.grid.count;
    computer->shift = lar_calloc((size_t)count, sizeof *computer->shift);
    computer->clock = lar_calloc((size_t)count, sizeof *computer->clock);
    if (!computer->shift || !computer->clock)
        return lar_fail_memory(error, 16 * (size_t)count, "the processors");
    for (int32_t p = 0; several && p < count; p++) computer->shift[p] = lar_control_bytes(count, p);
    for (int32_t p = 0; p < count; p++) computer->clock[p] = computer->start->step;
    return LAR_OK;
}

/* Whether so many threads, in this and other processes, get a core each. */
static bool pins(const lar_options *options, int32_t threads) {
    int32_t cores = options->pin ? lar_pin_cores() : 0;
    return options->pin == 1 ? threads <= cores : cores > 0 && threads == cores;
}

static lar_status prepare(lar_computer *computer, lar_error *error) {
    const lar_options *options = computer->options;
    const lar_model *model = computer->whole->model;
    lar_status status = lar_division_create(model, options, &computer->division, error);
    if (status) return status;
    int32_t count = computer->division.grid.count;
    bool several = options->comm && strcmp(options->comm, "threads") != 0;
    if (options->processor < 0 || options->processor >= count)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "processor %d of a grid of %d; they count from 0", (int)options->processor,
                        (int)count);
    computer->threads = computer->division.schedules.of[0].threads;
    computer->first = several ? options->processor : 0;
    computer->hosted = several ? 1 : count;
    computer->checking = options->verify != 0;
    computer->identity =
        lar_identity(computer->whole, computer->start, computer->division.schedules.of[0].division);
    /* Forces are nothing to who expects lists. */
    computer->identity = lar_hash_word(computer->identity, computer->checking);
    if (computer->checking) status = lar_verification_create(model, &computer->check, error);
    if (!status) status = size_buffers(computer, several, error);
    if (!status && !several) status = lar_comm_team_create(count, &computer->team, error);
    if (status) return status;
    computer->processor = lar_calloc((size_t)computer->hosted, sizeof *computer->processor);
    computer->seat = lar_calloc((size_t)seats(computer), sizeof *computer->seat);
    if (!computer->processor || !computer->seat)
        return lar_fail_memory(error, (size_t)seats(computer) * sizeof *computer->seat,
                               "the processors");
    return lar_crew_create(seats(computer), pins(options, count * computer->threads),
                           computer->first * computer->threads, &computer->crew, error);
}

/* They meet when all here are compiled: otherwise the others would wait for one that does not come.
 */
static lar_status open_processors(lar_computer *computer, bool *met, lar_error *error) {
    lar_crew_run(computer->crew, compile_seat, computer);
    lar_status status = first_failure(computer, error);
    if (status) return status;
    *met = true;
    lar_crew_run(computer->crew, meet_seat, computer);
    status = first_failure(computer, error);
    if (!status && computer->hosted < computer->division.grid.count)
        status = lar_control_create(computer->processor[0].comm, &computer->control, error);
    return status;
}

lar_status lar_computer_create(const lar_domain *whole, const lar_state *state,
                               const lar_options *options, lar_computer **out, lar_error *error) {
    lar_computer *computer = lar_calloc(1, sizeof *computer);
    lar_status status = LAR_OK;
    bool met = false;
    if (!computer) {
        status = lar_fail_memory(error, sizeof *computer, "the parallel computer");
    } else {
        computer->options = options;
        computer->whole = whole;
        computer->start = state;
        status = prepare(computer, error);
        if (!status) status = open_processors(computer, &met, error);
        lar_schedule_set_clear(&computer->division.schedules);
        computer->options = NULL;
        computer->start = NULL;
    }
    /* Only the meeting of processor zero takes the listener over. */
    if (options->listener >= 0 && !(met && computer->first == 0)) close(options->listener);
    if (status)
        lar_computer_destroy(computer);
    else
        *out = computer;
    return status;
}

static void close_seat(void *context, int32_t number) {
    lar_computer *computer = context;
    if (number % computer->threads != 0) return;
    lar_processor *p = processor_of(computer, number);
    lar_comm_close(p->comm);
    lar_processor_destroy(p);
}

/* Processor zero lets the other processes go. Who goes before that, or cannot say so, is given up:
 * after a goodbye alone the others would wait for as long as they live. */
static void take_leave(lar_computer *computer) {
    lar_comm *comm = computer->processor ? computer->processor[0].comm : NULL;
    if (!comm || computer->hosted == computer->division.grid.count) return;
    const lar_order finish = {.kind = LAR_ORDER_FINISH};
    if (computer->first == 0 && computer->control && !computer->broken)
        computer->finished = lar_control_order(computer->control, &finish, NULL) == LAR_OK;
    if (!computer->finished) lar_comm_abort(comm);
}

void lar_computer_destroy(lar_computer *computer) {
    if (!computer) return;
    take_leave(computer);
    lar_control_destroy(computer->control);
    if (computer->crew) lar_crew_run(computer->crew, close_seat, computer);
    lar_crew_destroy(computer->crew);
    lar_comm_team_destroy(computer->team);
    lar_verification_destroy(&computer->check);
    lar_division_destroy(&computer->division);
    free(computer->processor);
    free(computer->seat);
    free(computer->shift);
    free(computer->clock);
    free(computer);
}

/* ---- advancing ----------------------------------------------------------------------------- */

/* T 6.5.2: no two processors are further apart than the exchanges between them. Only those of one
 * process see each other's clocks. Every thread sets its processor's clock forward before it sends
 * again: another thread may be late, a step at most. */
static void check_clocks(lar_computer *computer, int32_t self, uint64_t step) {
#ifndef NDEBUG
    uint64_t *own = &computer->clock[self], shown = __atomic_load_n(own, __ATOMIC_RELAXED);
    while (shown < step && !__atomic_compare_exchange_n(own, &shown, step, false, __ATOMIC_ACQ_REL,
                                                        __ATOMIC_RELAXED))
        continue;
    for (int32_t i = 0; i < computer->hosted; i++) {
        int32_t other = computer->first + i;
        uint64_t theirs = __atomic_load_n(&computer->clock[other], __ATOMIC_ACQUIRE);
        uint64_t apart = theirs > step ? theirs - step : step - theirs;
        int32_t most = computer->division.distance[self * computer->division.grid.count + other];
        assert(apart <= (uint64_t)most + (computer->threads > 1));
    }
#else
    (void)computer, (void)self, (void)step;
#endif
}

/* After a step: does somebody here want everyone to stop? One step more than the way to the
 * farthest processor, because other threads of this one may have sent already. */
static void after_step(lar_computer *computer, lar_worker *worker, int32_t seat, bool *tripped) {
    lar_processor *p = worker->processor;
    uint64_t done = worker->state.step, stop = done + (uint64_t)computer->division.spread + 1;
    if (worker->trip.kind && !*tripped) {
        *tripped = true;
        lar_trip_examine(&p->domain, &worker->state, &worker->trip);
        lar_processor_ask_stop(p, stop);
    }
    if (seat == 0 && computer->first == 0 && computer->watch &&
        !computer->watch(computer->watch_context, done))
        lar_processor_ask_stop(p, stop);
    check_clocks(computer, p->self, done);
}

static void advance_seat(void *context, int32_t number) {
    lar_computer *computer = context;
    lar_seat *seat = &computer->seat[number];
    lar_processor *p = processor_of(computer, number);
    lar_worker *worker = &p->worker[number % computer->threads];
    bool tripped = false;
    while (worker->state.step < computer->until) {
        uint64_t stop = __atomic_load_n(&p->stop, __ATOMIC_RELAXED);
        if (stop && worker->state.step >= stop) break;
        seat->status = lar_worker_step(worker, &seat->error);
        if (seat->status) break;
        after_step(computer, worker, number, &tripped);
    }
    /* Nobody shall wait for this processor; after a verdict this changes nothing. */
    if (seat->status && worker->thread == 0) lar_comm_abort(p->comm);
}

static lar_status advance_here(lar_computer *computer, uint64_t until, lar_error *error) {
    computer->until = until;
    lar_crew_run(computer->crew, advance_seat, computer);
    for (int32_t i = 0; i < computer->hosted; i++) computer->processor[i].stop = 0;
    return first_failure(computer, error);
}

static lar_status hear_all(lar_computer *computer, lar_trip *trip, lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t p = 1; p < computer->division.grid.count && !status; p++) {
        const lar_answer *answer;
        status = lar_control_hear(computer->control, p, &answer, error);
        if (!status && earlier(&answer->trip, trip)) *trip = answer->trip;
    }
    return status;
}

static lar_status refuse_broken(lar_error *error) {
    return lar_fail(error, LAR_ERROR_PEER,
                    "the parallel computer has lost a processor and cannot go on; start it again");
}

lar_status lar_computer_advance(lar_computer *computer, uint64_t steps, lar_watch *watch,
                                void *context, lar_trip *trip, lar_error *error) {
    if (computer->broken) return refuse_broken(error);
    uint64_t until = computer->processor[0].worker[0].state.step + steps;
    const lar_order order = {LAR_ORDER_ADVANCE, until};
    computer->watch = watch;
    computer->watch_context = context;
    lar_status status = LAR_OK;
    if (computer->control) status = lar_control_order(computer->control, &order, error);
    if (!status) status = advance_here(computer, until, error);
    first_trip(computer, trip);
    if (!status && computer->control) status = hear_all(computer, trip, error);
    if (status) computer->broken = true;
    return status;
}

/* ---- gathering ----------------------------------------------------------------------------- */

static void take_node(const lar_domain *whole, lar_gid node, const double *u, const double *v,
                      lar_state *state) {
    size_t there = 4 * (size_t)whole->layout.local[node];
    memcpy(state->u + there, u, 3 * sizeof *u);
    memcpy(state->v + there, v, 3 * sizeof *v);
}

/* A node of several processors has moved by the same bits on each. */
static void check_copies(const lar_computer *computer, const lar_processor *p,
                         const lar_state *state) {
#ifndef NDEBUG
    const lar_layout *layout = &p->domain.layout, *whole = &computer->whole->layout;
    for (lar_lid n = 0; n < layout->node_padded; n++) {
        if (layout->global[n] < 0) continue;
        size_t there = 4 * (size_t)whole->local[layout->global[n]], here = 4 * (size_t)n;
        assert(!memcmp(state->u + there, p->worker[0].state.u + here, 3 * sizeof(double)));
        assert(!memcmp(state->v + there, p->worker[0].state.v + here, 3 * sizeof(double)));
    }
#else
    (void)computer, (void)p, (void)state;
#endif
}

static void add_work(const lar_processor *p, int32_t threads, double *external, double *damped,
                     double *contact) {
    for (int32_t t = 0; t < threads; t++) {
        *external += p->worker[t].state.external;
        *damped += p->worker[t].state.damped;
        *contact += p->worker[t].state.contact;
    }
}

static void gather_here(const lar_computer *computer, lar_state *state) {
    const lar_domain *whole = computer->whole;
    for (int32_t i = 0; i < computer->hosted; i++) {
        const lar_processor *p = &computer->processor[i];
        const lar_layout *layout = &p->domain.layout;
        const lar_state *own = &p->worker[0].state;
        for (lar_lid n = 0; n < layout->node_padded; n++) {
            lar_gid node = layout->global[n];
            if (node >= 0 && computer->division.reporter[node] == p->self)
                take_node(whole, node, own->u + 4 * (size_t)n, own->v + 4 * (size_t)n, state);
        }
        add_work(p, computer->threads, &state->external, &state->damped, &state->contact);
    }
    for (int32_t i = 0; i < computer->hosted; i++)
        check_copies(computer, &computer->processor[i], state);
}

/* Nodes from `node` on that processor p reports, as the answer has them. Returns where to go on. */
static lar_gid take_answer(const lar_computer *computer, int32_t p, lar_gid node,
                           const lar_answer *answer, lar_state *state) {
    const lar_mesh *mesh = &computer->whole->model->mesh;
    for (int64_t i = 0; i < answer->nodes && node < mesh->node_count; node++)
        if (computer->division.reporter[node] == p) {
            take_node(computer->whole, node, answer->value[i], answer->value[i] + 3, state);
            i++;
        }
    return node;
}

static lar_status gather_others(lar_computer *computer, lar_state *state, lar_error *error) {
    int32_t count = computer->division.grid.count;
    lar_gid *from = lar_calloc((size_t)count, sizeof *from);
    if (!from) return lar_fail_memory(error, 4 * (size_t)count, "the state");
    lar_status status = LAR_OK;
    bool more = true;
    for (uint64_t round = 0; more && !status; round++) {
        const lar_order order = {LAR_ORDER_GATHER, round};
        more = false;
        status = lar_control_order(computer->control, &order, error);
        for (int32_t p = 1; p < count && !status; p++) {
            const lar_answer *answer;
            status = lar_control_hear(computer->control, p, &answer, error);
            if (status) break;
            from[p] = take_answer(computer, p, from[p], answer, state);
            more = more || answer->nodes == LAR_ANSWER_NODES;
            if (round > 0) continue;
            state->external += answer->external;
            state->damped += answer->damped;
            state->contact += answer->contact;
        }
    }
    free(from);
    return status;
}

lar_status lar_computer_gather(lar_computer *computer, lar_state *state, lar_error *error) {
    if (computer->broken) return refuse_broken(error);
    state->step = computer->processor[0].worker[0].state.step;
    state->external = state->damped = state->contact = 0;
    gather_here(computer, state);
    lar_status status = LAR_OK;
    if (computer->control) status = gather_others(computer, state, error);
    if (status) computer->broken = true;
    return status;
}

/* ---- the other processes ------------------------------------------------------------------- */

/* The nodes of one round of gathering. */
static void fill_answer(const lar_computer *computer, uint64_t round, lar_answer *answer) {
    const lar_processor *p = &computer->processor[0];
    const lar_layout *layout = &p->domain.layout;
    const lar_state *own = &p->worker[0].state;
    const lar_mesh *mesh = &computer->whole->model->mesh;
    uint64_t skip = round * LAR_ANSWER_NODES;
    answer->nodes = 0;
    answer->external = answer->damped = answer->contact = 0;
    add_work(p, computer->threads, &answer->external, &answer->damped, &answer->contact);
    for (lar_gid node = 0; node < mesh->node_count && answer->nodes < LAR_ANSWER_NODES; node++) {
        if (computer->division.reporter[node] != p->self) continue;
        if (skip > 0) {
            skip--;
            continue;
        }
        size_t n = 4 * (size_t)layout->local[node];
        memcpy(answer->value[answer->nodes], own->u + n, 3 * sizeof(double));
        memcpy(answer->value[answer->nodes] + 3, own->v + n, 3 * sizeof(double));
        answer->nodes++;
    }
}

lar_status lar_computer_serve(lar_computer *computer, lar_error *error) {
    lar_control *control = computer->control;
    lar_answer *answer = control ? control->answer : NULL;
    lar_status status = LAR_OK;
    while (control && !status && !computer->finished) {
        lar_order order;
        status = lar_control_obey(control, &order, error);
        computer->finished = !status && order.kind == LAR_ORDER_FINISH;
        if (status || computer->finished) break;
        if (order.kind == LAR_ORDER_ADVANCE)
            status = advance_here(computer, order.argument, error);
        else
            fill_answer(computer, order.argument, answer);
        if (status) break;
        answer->step = computer->processor[0].worker[0].state.step;
        first_trip(computer, &answer->trip);
        status = lar_control_answer(control, error);
    }
    if (status) computer->broken = true;
    return status;
}
