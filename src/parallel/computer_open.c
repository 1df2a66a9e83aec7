/* The parallel computer is put together, and taken apart. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/hash.h"
#include "base/pin.h"
#include "parallel/computer.h"
#include "step/identity.h"

static lar_status open_comm(lar_computer *computer, lar_processor *p, lar_error *error) {
    const lar_options *options = computer->options;
    const lar_schedule *schedule = &computer->division.schedules.of[p->self];
    lar_comm_options comm = lar_comm_options_default();
    if (options->comm) comm.backend = options->comm;
    comm.self = p->self;
    comm.count = computer->division.grid.count;
    comm.receive_bytes = computer->shift[p->self] +
                         (size_t)p->layers * (size_t)schedule->receive_bytes +
                         lar_contact_bytes(&computer->contact.map);
    comm.identity = computer->identity;
    comm.time_step = computer->whole->time_step;
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
static void compile_on_thread(void *context, int32_t number) {
    lar_computer *computer = context;
    lar_thread_result *result = &computer->result[number];
    if (number % computer->threads != 0) return;
    lar_processor *p = lar_processor_of(computer, number);
    const lar_schedule *schedule =
        &computer->division.schedules.of[computer->first + number / computer->threads];
    lar_processor_setting setting = {.whole = computer->whole,
                                     .interactions = computer->interactions,
                                     .reporter = computer->division.reporter,
                                     .check = computer->checking ? &computer->check : NULL,
                                     .shift = computer->shift,
                                     .delays = computer->options->delays,
                                     .low_latency =
                                         computer->team || shares_memory(computer->options)};
    result->status = lar_processor_create(&setting, schedule, p, &result->error);
    if (!result->status) lar_processor_scatter(p, computer->whole, computer->state);
}

static void rendezvous_on_thread(void *context, int32_t number) {
    lar_computer *computer = context;
    lar_thread_result *result = &computer->result[number];
    if (number % computer->threads != 0) return;
    result->status = open_comm(computer, lar_processor_of(computer, number), &result->error);
}

static lar_status size_buffers(lar_computer *computer, bool several, lar_error *error) {
    int32_t count = computer->division.grid.count;
    computer->shift = lar_calloc((size_t)count, sizeof *computer->shift);
    computer->clock = lar_calloc((size_t)count, sizeof *computer->clock);
    if (!computer->shift || !computer->clock)
        return lar_fail_memory(error, 16 * (size_t)count, "the processors");
    for (int32_t p = 0; several && p < count; p++) computer->shift[p] = lar_control_bytes(count, p);
    return LAR_OK;
}

/* Whether so many threads, in this and other processes, get a core each. */
static bool pins(const lar_options *options, int32_t threads) {
    int32_t cores = options->pin ? lar_pin_cores() : 0;
    return options->pin == 1 ? threads <= cores : cores > 0 && threads == cores;
}

/* What is kept of the options for another division (redivide.c): all but their strings. */
static void keep_options(lar_computer *computer) {
    const lar_options *options = computer->options;
    bool cuts = !options->distribution && !options->schedules;
    computer->kept = *options;
    computer->kept.grid = computer->kept.scheme = computer->kept.channels = NULL;
    computer->kept.distribution = computer->kept.schedules = computer->kept.comm = NULL;
    computer->kept.master = NULL;
    computer->kept.listener = -1;
    /* This thread may be bound, by another simulation. Who binds none does not look for cores. */
    int32_t count = computer->division.grid.count, cores = lar_usable_cores(),
            bound = options->pin ? lar_pin_cores() : 0;
    computer->balance.adapts = cuts && computer->team && count > 1 && computer->threads == 1 &&
                               (count <= cores || count <= bound) && !computer->checking;
    computer->balance.corrected = 1;
}

/* `distribution`: NULL takes that of the options. */
static lar_status prepare(lar_computer *computer, const lar_distribution *distribution,
                          lar_error *error) {
    const lar_options *options = computer->options;
    const lar_model *model = computer->whole->model;
    lar_status status =
        distribution
            ? lar_division_from(model, distribution, &computer->wanted, &computer->division, error)
            : lar_division_create(model, options, &computer->division, error);
    if (!status && !distribution) status = lar_division_options(options, &computer->wanted, error);
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
        lar_identity(computer->whole, computer->state, computer->division.schedules.of[0].division);
    /* Forces are nothing to who expects lists. */
    computer->identity = lar_hash_word(computer->identity, computer->checking);
    if (computer->checking) status = lar_verification_create(model, &computer->check, error);
    if (!status) status = size_buffers(computer, several, error);
    if (!status) status = lar_contact_open(computer, error);
    if (!status && !several) status = lar_comm_team_create(count, &computer->team, error);
    if (status) return status;
    computer->processor = lar_calloc((size_t)computer->hosted, sizeof *computer->processor);
    computer->result = lar_calloc((size_t)lar_all_threads(computer), sizeof *computer->result);
    if (!computer->processor || !computer->result)
        return lar_fail_memory(error, (size_t)lar_all_threads(computer) * sizeof *computer->result,
                               "the processors");
    if (!distribution) keep_options(computer);
    status = lar_balance_create(&computer->balance, count, error);
    if (status || computer->pool) return status;
    return lar_thread_pool_create(lar_all_threads(computer),
                                  pins(options, count * computer->threads),
                                  computer->first * computer->threads, &computer->pool, error);
}

/* They meet when all here are compiled: otherwise the others would wait for one that does not come.
 */
static lar_status open_processors(lar_computer *computer, bool *met, lar_error *error) {
    lar_thread_pool_run(computer->pool, compile_on_thread, computer);
    lar_status status = lar_first_failure(computer, error);
    if (status) return status;
    *met = true;
    lar_thread_pool_run(computer->pool, rendezvous_on_thread, computer);
    status = lar_first_failure(computer, error);
    if (!status && computer->hosted < computer->division.grid.count)
        status = lar_control_create(computer->processor[0].comm, &computer->control, error);
    return status;
}

/* Divides, compiles and meets the others; what cannot be is left to destroy. */
static lar_status open_computer(lar_computer *computer, const lar_distribution *distribution,
                                bool *met, lar_error *error) {
    double begin = lar_clock_seconds();
    computer->gathered = true;
    computer->process = getpid();
    lar_status status = prepare(computer, distribution, error);
    if (!status) status = open_processors(computer, met, error);
    lar_schedule_set_clear(&computer->division.schedules);
    computer->options = NULL;
    lar_balance_begin(computer, lar_clock_seconds() - begin);
    return status;
}

lar_status lar_computer_create(const lar_domain *whole, lar_interactions *interactions,
                               lar_state *state, lar_tools *tools, lar_tool_list *list,
                               const lar_options *options, lar_computer **out, lar_error *error) {
    lar_computer *computer = lar_calloc(1, sizeof *computer);
    lar_status status = LAR_OK;
    bool met = false;
    if (!computer) {
        status = lar_fail_memory(error, sizeof *computer, "the parallel computer");
    } else {
        computer->options = options;
        computer->whole = whole;
        computer->interactions = interactions;
        computer->state = state;
        computer->tools = tools;
        computer->list = list;
        status = open_computer(computer, NULL, &met, error);
    }
    /* Only the rendezvous of processor zero takes the listener over. */
    if (options->listener >= 0 && !(met && computer->first == 0)) close(options->listener);
    if (status)
        lar_computer_destroy(computer);
    else
        *out = computer;
    return status;
}

static void close_on_thread(void *context, int32_t number) {
    lar_computer *computer = context;
    if (number % computer->threads != 0) return;
    lar_processor *p = lar_processor_of(computer, number);
    lar_comm_close(p->comm);
    lar_processor_destroy(p);
}

/* Processor zero lets the other processes go. Who goes before that, or cannot say so, is given up:
 * after a goodbye alone the others would wait for as long as they live. */
static void dismiss_processes(lar_computer *computer) {
    lar_comm *comm = computer->processor ? computer->processor[0].comm : NULL;
    if (!comm || computer->hosted == computer->division.grid.count) return;
    const lar_order finish = {.kind = LAR_ORDER_FINISH};
    if (computer->first == 0 && computer->control && !computer->broken)
        computer->finished = lar_control_order(computer->control, &finish, NULL, 0, NULL) == LAR_OK;
    if (!computer->finished) lar_comm_abort(comm);
}

/* In a forked child, which has none of the threads, one after the other. */
static void close_processors(lar_computer *computer, bool here) {
    if (!computer->pool) return;
    if (here) lar_thread_pool_run(computer->pool, close_on_thread, computer);
    for (int32_t i = 0; !here && i < lar_all_threads(computer); i++) close_on_thread(computer, i);
}

void lar_computer_destroy(lar_computer *computer) {
    if (!computer) return;
    bool here = computer->process == getpid();
    if (here) dismiss_processes(computer);
    lar_control_destroy(computer->control);
    close_processors(computer, here);
    lar_thread_pool_destroy(computer->pool);
    lar_comm_team_destroy(computer->team);
    lar_contact_close(computer);
    lar_verification_destroy(&computer->check);
    lar_division_destroy(&computer->division);
    free(computer->processor);
    free(computer->result);
    free(computer->shift);
    free(computer->clock);
    free(computer->balance.busy);
    free(computer);
}

/* The processors of a computer whose threads are another's, too. */
static void leave_pool(lar_computer *computer) {
    close_processors(computer, true);
    computer->pool = NULL;
}

lar_status lar_computer_create_like(lar_computer *old, const lar_distribution *distribution,
                                    lar_computer **out, lar_error *error) {
    lar_computer *computer = lar_calloc(1, sizeof *computer);
    if (!computer) return lar_fail_memory(error, sizeof *computer, "the parallel computer");
    computer->options = &old->kept;
    computer->kept = old->kept;
    computer->wanted = old->wanted;
    computer->whole = old->whole;
    computer->interactions = old->interactions;
    computer->state = old->state;
    computer->tools = old->tools;
    computer->list = old->list;
    computer->pool = old->pool;
    computer->balance = old->balance;
    computer->balance.busy = NULL;
    bool met;
    lar_status status = open_computer(computer, distribution, &met, error);
    if (!status) status = lar_computer_scatter(computer, error);
    if (status) {
        if (computer->processor) leave_pool(computer);
        computer->pool = NULL;
        lar_computer_destroy(computer);
        return status;
    }
    computer->report = old->report;
    computer->interval = old->interval;
    /* One of the new threads goes on counting, where the others begin with nothing. */
    lar_contact_info *seen = &computer->processor[0].worker[0].interactions.tool_contact.seen;
    *seen = old->report.contact;
    seen->touching = 0;
    seen->deepest = 0;
    computer->contact.info.steps = seen->steps;
    leave_pool(old);
    lar_computer_destroy(old);
    *out = computer;
    return LAR_OK;
}
