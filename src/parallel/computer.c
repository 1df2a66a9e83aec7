#include "parallel/computer.h"

#include <assert.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "step/mass/heavier.h"

/* ---- what went wrong ----------------------------------------------------------------------- */

/* How little a thread's failure says: it may be a consequence of another one. */
static int consequence(const lar_computer *computer, int32_t number) {
    const lar_processor *p = lar_processor_of(computer, number);
    if (p->worker && p->worker[number % computer->threads].follows) return 2;
    return computer->result[number].status == LAR_ERROR_PEER;
}

lar_status lar_first_failure(lar_computer *computer, lar_error *error) {
    const lar_thread_result *chosen = NULL;
    int min = 3;
    for (int32_t i = 0; i < lar_all_threads(computer); i++) {
        if (!computer->result[i].status || consequence(computer, i) >= min) continue;
        chosen = &computer->result[i];
        min = consequence(computer, i);
    }
    if (!chosen) return LAR_OK;
    computer->broken = true;
    if (error) *error = chosen->error;
    return chosen->status;
}

/* Of what several have found in a step the one that a processor alone would have found: elements
 * before nodes, the first element, the fastest node. */
static bool earlier(const lar_fault *a, const lar_fault *b) {
    if (!a->kind || !b->kind) return a->kind;
    if (a->step != b->step) return a->step < b->step;
    if (a->part != b->part) return a->part < b->part;
    if (a->kind != b->kind) return a->kind < b->kind;
    if (a->speed != b->speed) return a->speed > b->speed;
    return a->element < b->element;
}

static void first_fault(const lar_computer *computer, lar_fault *fault) {
    for (int32_t i = 0; i < computer->hosted; i++)
        for (int32_t t = 0; t < computer->threads; t++) {
            const lar_fault *other = &computer->processor[i].worker[t].fault;
            if (earlier(other, fault)) *fault = *other;
        }
}

/* ---- advancing ----------------------------------------------------------------------------- */

/* T 6.5.2: no two processors are further apart than the exchanges between them. Only those of one
 * process see each other's clocks. Every thread sets its processor's clock forward before it sends
 * again: another thread may be late, a step at most. */
static void check_clocks(lar_computer *computer, int32_t self, uint64_t round) {
#ifndef NDEBUG
    uint64_t *own = &computer->clock[self], shown = __atomic_load_n(own, __ATOMIC_RELAXED);
    while (shown < round && !__atomic_compare_exchange_n(own, &shown, round, false,
                                                         __ATOMIC_ACQ_REL, __ATOMIC_RELAXED))
        continue;
    for (int32_t i = 0; i < computer->hosted; i++) {
        int32_t other = computer->first + i;
        uint64_t theirs = __atomic_load_n(&computer->clock[other], __ATOMIC_ACQUIRE);
        uint64_t apart = theirs > round ? theirs - round : round - theirs;
        int32_t max = computer->division.distance[self * computer->division.grid.count + other];
        assert(apart <= (uint64_t)max + (computer->threads > 1));
    }
#else
    (void)computer, (void)self, (void)round;
#endif
}

/* The round in which a step begins that a thread has before it: parts of steps are rounds. */
static uint64_t round_of(const lar_computer *computer, const lar_worker *worker, uint64_t step) {
    uint64_t parts = (uint64_t)computer->tools->division.parts;
    return worker->round + (step - worker->state.step) * parts - (uint64_t)worker->state.part;
}

static bool must_stop(const lar_computer *computer, const lar_worker *worker) {
    uint64_t stop = __atomic_load_n(&worker->processor->stop, __ATOMIC_RELAXED);
    return worker->round >= computer->until || (stop && worker->round >= stop);
}

/* After a part of a step, or all of it: does somebody here want everyone to stop? One round more
 * than the way to the farthest processor, because other threads of this one may have sent already.
 * Contact may need a list within a step; all else waits for the end of one. */
static void after_round(lar_computer *computer, lar_worker *worker, int32_t number, bool *faulted) {
    lar_processor *p = worker->processor;
    uint64_t done = worker->state.step, heard = (uint64_t)computer->division.spread + 1;
    uint64_t stop = round_of(computer, worker, done + heard);
    if (p->exchange) lar_contact_check_travel(worker, heard, must_stop(computer, worker));
    if (worker->fault.kind && !*faulted) {
        *faulted = true;
        lar_fault_examine(&p->domain, &worker->state, worker->context.first, worker->context.end,
                          &worker->fault);
        lar_processor_ask_stop(p, stop);
    }
    if (number == 0 && computer->first == 0 && computer->callback && worker->state.part == 0 &&
        !computer->callback(computer->callback_context, done)) {
        computer->called_off = true;
        lar_processor_ask_stop(p, stop);
    }
    check_clocks(computer, p->self, worker->round);
}

static void advance_thread(void *context, int32_t number) {
    lar_computer *computer = context;
    lar_thread_result *result = &computer->result[number];
    lar_processor *p = lar_processor_of(computer, number);
    lar_worker *worker = &p->worker[number % computer->threads];
    /* In the stretch before, which ended within that step: what it was is known. */
    bool faulted = worker->fault.kind != LAR_FAULT_NONE;
    double begin = computer->balance.samples ? lar_clock_seconds() : 0;
    if (begin > 0) lar_comm_time_waits(p->comm, true);
    if (p->exchange) lar_contact_publish(worker, worker->round + 1);
    while (!must_stop(computer, worker)) {
        result->status = lar_worker_step(worker, &result->error);
        if (result->status) break;
        after_round(computer, worker, number, &faulted);
    }
    if (begin > 0) lar_balance_note(computer, p, lar_clock_seconds() - begin);
    /* Nobody shall wait for this processor; after a verdict this changes nothing. */
    if (result->status && worker->thread == 0) lar_comm_abort(p->comm);
}

/* What the threads here have felt in the last advance. */
static void report_here(const lar_computer *computer, lar_report *report) {
    *report = (lar_report){0};
    for (int32_t i = 0; i < lar_all_threads(computer); i++) {
        const lar_worker *worker = &lar_processor_of(computer, i)->worker[i % computer->threads];
        lar_report_add(report, &worker->interactions, &worker->state);
    }
}

static void stiffen_on_thread(void *context, int32_t number) {
    lar_computer *computer = context;
    if (number % computer->threads == 0)
        lar_domain_stiffen(&lar_processor_of(computer, number)->domain, &computer->tools->settings,
                           &computer->tools->parameters);
}

/* What strained elements have more is accounted for by the first thread of each processor. */
static void take_masses(lar_processor *p, const lar_tools *tools) {
    if (!lar_burden_take(&p->domain, &tools->heavier, &p->worker[0].state)) return;
    for (int32_t t = 0; t < p->thread_count; t++) /* with what they weigh */
        p->worker[t].interactions.tool_contact.plane_contact.known = false;
}

/* What has been set since the last stretch: gravity and damping are read in every step, materials
 * are made anew. */
static void take_settings(lar_computer *computer) {
    const lar_domain *domain = &computer->processor[0].domain;
    uint64_t interval = lar_interval_length(computer->whole, computer->tools);
    for (int32_t i = 0; i < computer->hosted; i++) {
        computer->processor[i].domain.interval = interval;
        take_masses(&computer->processor[i], computer->tools);
    }
    if (!lar_domain_follows(domain, &computer->tools->settings, &computer->tools->parameters))
        lar_thread_pool_run(computer->pool, stiffen_on_thread, computer);
}

static lar_status take_supports(lar_computer *computer, lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t i = 0; i < lar_all_threads(computer) && !status; i++) {
        lar_worker *worker = &lar_processor_of(computer, i)->worker[i % computer->threads];
        status = lar_step_support(&worker->context, &computer->tools->supports,
                                  &worker->interactions, error);
    }
    return status;
}

/* `first`: of the stretches of an advance. */
static lar_status advance_here(lar_computer *computer, uint64_t until, bool first,
                               lar_error *error) {
    computer->until = until;
    take_settings(computer);
    lar_status status = take_supports(computer, error);
    if (status) return status;
    for (int32_t i = 0; i < lar_all_threads(computer); i++) {
        lar_interactions *interactions =
            &lar_processor_of(computer, i)->worker[i % computer->threads].interactions;
        if (first) lar_report_begin(interactions);
        lar_report_stretch(interactions);
        lar_processor_of(computer, i)->worker[i % computer->threads].state.need = 0;
        lar_needs_clear(&lar_processor_of(computer, i)->worker[i % computer->threads].needs);
    }
    for (int32_t i = 0; i < computer->hosted; i++) lar_contact_begin(&computer->processor[i]);
    lar_balance_sample(computer);
    lar_thread_pool_run(computer->pool, advance_thread, computer);
    for (int32_t i = 0; i < computer->hosted; i++) lar_processor_pause(&computer->processor[i]);
    report_here(computer, &computer->report);
    return lar_first_failure(computer, error);
}

static lar_status hear_all(lar_computer *computer, lar_fault *fault, lar_error *error) {
    lar_status status = LAR_OK;
    for (int32_t p = 1; p < computer->division.grid.count && !status; p++) {
        const lar_answer *answer;
        const void *report;
        status = lar_control_hear(computer->control, p, &answer, &report, error);
        if (status) break;
        if (earlier(&answer->fault, fault)) *fault = answer->fault;
        lar_report own = {0}; /* a payload is aligned to 8 only */
        if (lar_report_fits(report, answer->bytes)) memcpy(&own, report, answer->bytes);
        lar_report_join(&computer->report, &own);
    }
    return status;
}

static lar_status refuse_fork(const lar_computer *computer, const char *what, lar_error *error) {
    if (computer->process == getpid()) return LAR_OK;
    return lar_fail(error, LAR_ERROR_PEER,
                    "the %s of this simulation are in the process that this one was forked from; "
                    "make another simulation here, or one of one thread before",
                    what);
}

lar_status lar_computer_check(const lar_computer *computer, lar_error *error) {
    if (computer->broken)
        return lar_fail(
            error, LAR_ERROR_PEER,
            "the parallel computer has lost a processor and cannot go on; start it again");
    return computer->control ? refuse_fork(computer, "connections", error) : LAR_OK;
}

/* Where the tools go travels with the order to go on, when it has changed: so all use it from the
 * same step on (T 6.5.1). */
static lar_status order_advance(lar_computer *computer, uint64_t until, bool first,
                                lar_error *error) {
    const lar_order order = {first ? LAR_ORDER_ADVANCE : LAR_ORDER_CONTINUE, until};
    size_t bytes = computer->tools_sent ? 0 : lar_tools_bytes(computer->tools);
    lar_status status = lar_control_order(computer->control, &order, computer->tools, bytes, error);
    if (!status) computer->tools_sent = true;
    return status;
}

static lar_status advance_all(lar_computer *computer, uint64_t until, bool first, lar_fault *fault,
                              lar_error *error) {
    lar_status status = computer->control ? order_advance(computer, until, first, error) : LAR_OK;
    computer->gathered = false;
    if (!status) status = advance_here(computer, until, first, error);
    first_fault(computer, fault);
    if (!status && computer->control) status = hear_all(computer, fault, error);
    return status;
}

/* The round before which all stop next: for a search, where an interval ends, what has begun of a
 * step when all is `over`, or the next one where somebody leads free bodies. */
static uint64_t next_stop(const lar_computer *computer, uint64_t end, bool over) {
    const lar_worker *first = &computer->processor[0].worker[0];
    uint64_t step = first->state.step;
    uint64_t until = lar_interval_end(computer->whole, &computer->tools->division, step);
    if (over) until = step + 1;
    if (computer->lead) return first->round + 1;
    until = lar_contact_until(computer, step, until < end ? until : end);
    return until > step ? round_of(computer, first, until) : first->round + 1;
}

/* Stretch by stretch: intervals (step/interval.h), and where contact needs a new list, which may be
 * within a step that is divided. */
lar_status lar_computer_advance(lar_computer *computer, uint64_t steps, bool first,
                                lar_step_callback *callback, void *context, lar_fault *fault,
                                lar_error *error) {
    lar_status status = lar_computer_check(computer, error);
    if (!status && computer->hosted * computer->threads > 1)
        status = refuse_fork(computer, "threads", error);
    if (status) return status;
    const lar_state *state = &computer->processor[0].worker[0].state;
    const uint64_t *step = &state->step, end = *step + steps;
    bool over = false;
    computer->callback = callback;
    computer->callback_context = context;
    computer->called_off = false;
    /* A fault before the first stretch leaves no step over which these could be a mean. */
    if (first) memset(computer->report.tool, 0, sizeof computer->report.tool);
    if (first) lar_interval_restart(&computer->interval);
    for (; *step < end; first = false) { /* what is decided before a step is decided once */
        uint64_t begin = *step;
        lar_fault full = {0};
        status = lar_contact_refresh(computer, &full, error);
        if (!fault->kind) *fault = full;
        if (status || full.kind) break;
        if (state->part == 0 && lar_interval_decide(computer->whole, begin, computer->tools))
            computer->tools_sent = false;
        if (computer->lead) {
            status = computer->lead(computer->leader, error);
            computer->tools_sent = false;
            if (status) break;
        }
        status = advance_all(computer, next_stop(computer, end, over), first, fault, error);
        lar_interval_harvest(&computer->interval, computer->whole, &computer->report, *step - begin,
                             computer->tools);
        lar_contact_count(computer, *step - begin);
        over = fault->kind || computer->called_off;
        if (status || (over && state->part == 0)) break;
    }
    fault->too_many_pairs = fault->kind == LAR_FAULT_TOO_FAST && computer->contact.too_many_pairs;
    if (status) computer->broken = true;
    return status;
}

lar_status lar_computer_look(lar_computer *computer, lar_error *error) {
    if (!computer->control || computer->broken) return LAR_OK;
    lar_status status = lar_comm_look(computer->processor[0].comm, error);
    if (status) computer->broken = true;
    return status;
}

/* ---- the other processes ------------------------------------------------------------------- */

static lar_status refuse_order(lar_error *error) {
    return lar_fail(error, LAR_ERROR_PEER,
                    "processor 0 asks for what this processor does not know; start all processors "
                    "again, from the same installation");
}

/* Faces and tools are looked up by these. */
static bool grasps_fit(const lar_computer *computer, const lar_tools *tools) {
    int32_t faces = computer->whole->model->surface.face_count;
    for (int32_t i = 0; i < tools->grasp_count; i++) {
        const lar_grasp *grasp = &tools->grasps[i];
        if (grasp->tool < 0 || grasp->tool >= tools->count || grasp->face < 0 ||
            grasp->face >= faces)
            return false;
    }
    return true;
}

static lar_status take_tools(lar_computer *computer, const void *payload, size_t bytes,
                             lar_error *error) {
    if (bytes == 0) return LAR_OK;
    lar_tools *tools = computer->tools;
    if (bytes < offsetof(lar_tools, grasps) || bytes > sizeof *tools) return refuse_order(error);
    int32_t count = tools->count;
    memcpy(tools, payload, bytes);
    bool fits = tools->count == count && tools->grasp_count >= 0 &&
                tools->grasp_count <= LAR_GRASPS_MAX && lar_tools_bytes(tools) == bytes &&
                lar_bearings_good(&tools->bearings) && grasps_fit(computer, tools) &&
                lar_settings_good(&tools->settings, computer->whole->time_step) &&
                lar_forces_good(&tools->forces, computer->whole->model,
                                lar_domain_force_max(computer->whole)) &&
                lar_supports_good(&tools->supports, computer->whole->model) &&
                lar_parameters_good(&tools->parameters, &tools->settings, computer->whole->model) &&
                lar_spares_good(tools->spare, computer->list->spares) &&
                lar_heavier_now_good(computer->whole, &tools->heavier);
    if (!fits) return refuse_order(error);
    lar_spares_take(tools, computer->list);
    return LAR_OK;
}

static lar_status execute(lar_computer *computer, const lar_order *order, const void *payload,
                          size_t bytes, lar_error *error) {
    const lar_processor *p = &computer->processor[0];
    lar_control *control = computer->control;
    lar_answer answer = {0};
    if (order->kind == LAR_ORDER_HISTORY)
        return lar_computer_answer_history(computer, order->argument, error);
    if (order->kind == LAR_ORDER_GATHER)
        return lar_computer_answer_nodes(computer, order->argument, error);
    lar_status status = LAR_OK;
    if (order->kind == LAR_ORDER_ADVANCE || order->kind == LAR_ORDER_CONTINUE) {
        bool first = order->kind == LAR_ORDER_ADVANCE;
        status = take_tools(computer, payload, bytes, error);
        if (!status) status = advance_here(computer, order->argument, first, error);
        first_fault(computer, &answer.fault);
        answer.step = p->worker[0].state.step;
        if (status) return status;
        return lar_control_answer(control, &answer, &computer->report,
                                  lar_report_bytes(&computer->report), error);
    }
    if (order->kind == LAR_ORDER_SCATTER)
        status = lar_computer_take_state(computer, order->argument, payload, bytes, error);
    else if (order->kind == LAR_ORDER_CONTACT)
        status = lar_contact_execute(computer, payload, bytes, error);
    else
        status = refuse_order(error);
    return status ? status : lar_control_answer(control, &answer, NULL, 0, error);
}

lar_status lar_computer_serve(lar_computer *computer, lar_error *error) {
    lar_status status = LAR_OK;
    while (computer->control && !status && !computer->finished) {
        lar_order order;
        const void *payload;
        size_t bytes;
        status = lar_control_await(computer->control, &order, &payload, &bytes, error);
        if (status) break;
        if (order.kind == LAR_ORDER_FINISH)
            computer->finished = true;
        else
            status = execute(computer, &order, payload, bytes, error);
    }
    if (status) computer->broken = true;
    return status;
}
