#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "parallel/computer.h"
#include "step/guard.h"
#include "step/mass/heavier.h"
#include "step/viscous_history.h"

/* What travels for a node: the rows of the state's table. */
typedef double node_values[LAR_NODE_VALUES];

/* ---- gathering ----------------------------------------------------------------------------- */

/* A node of several processors has moved by the same bits on each. */
static void check_copies(const lar_computer *computer, const lar_processor *p) {
#ifndef NDEBUG
    const lar_layout *layout = &p->domain.layout, *whole = &computer->whole->layout;
    const lar_state *state = computer->state;
    for (lar_lid n = 0; n < layout->node_padded; n++) {
        if (layout->global[n] < 0) continue;
        node_values there, here;
        lar_state_read(state, whole->local[layout->global[n]], there);
        lar_state_read(&p->worker[0].state, n, here);
        assert(!memcmp(there, here, sizeof here));
    }
#else
    (void)computer, (void)p;
#endif
}

static void add_work(const lar_processor *p, int32_t threads, double *external, double *damped,
                     double *contact, double *exchanged) {
    for (int32_t t = 0; t < threads; t++) {
        *external += p->worker[t].state.external;
        *damped += p->worker[t].state.damped;
        *contact += p->worker[t].state.contact;
        *exchanged += p->worker[t].state.exchanged;
    }
    lar_guard_half_to_come(&p->domain, &p->worker[0].state, contact, external);
}

static void gather_here(const lar_computer *computer) {
    lar_state *state = computer->state;
    const lar_domain *whole = computer->whole;
    for (int32_t i = 0; i < computer->hosted; i++) {
        const lar_processor *p = &computer->processor[i];
        const lar_layout *layout = &p->domain.layout;
        const lar_state *own = &p->worker[0].state;
        for (lar_lid n = 0; n < layout->node_padded; n++) {
            lar_gid node = layout->global[n];
            if (node < 0 || computer->division.reporter[node] != p->self) continue;
            node_values value;
            lar_state_read(own, n, value);
            lar_state_write(state, whole->layout.local[node], value);
        }
        lar_viscous_copy(&p->domain, own, whole, state);
        add_work(p, computer->threads, &state->external, &state->damped, &state->contact,
                 &state->exchanged);
    }
    for (int32_t i = 0; i < computer->hosted; i++) check_copies(computer, &computer->processor[i]);
}

/* Nodes from `node` on that processor p reports, as its answer has them. Returns where to go on. */
static lar_gid take_answer(const lar_computer *computer, int32_t p, lar_gid node,
                           const node_values *value, int64_t count) {
    const lar_mesh *mesh = &computer->whole->model->mesh;
    for (int64_t i = 0; i < count && node < mesh->node_count; node++)
        if (computer->division.reporter[node] == p) {
            lar_state_write(computer->state, computer->whole->layout.local[node], value[i]);
            i++;
        }
    return node;
}

/* What processor p answers in a round, from *from on; *from: where to go on. Whether there may be
 * more. */
typedef bool take_part(lar_computer *computer, int32_t p, bool first, const lar_answer *answer,
                       const void *value, lar_gid *from);

static bool take_nodes(lar_computer *computer, int32_t p, bool first, const lar_answer *answer,
                       const void *value, lar_gid *from) {
    lar_state *state = computer->state;
    int64_t nodes = (int64_t)(answer->bytes / sizeof(node_values));
    *from = take_answer(computer, p, *from, value, nodes);
    if (first) {
        state->external += answer->external;
        state->damped += answer->damped;
        state->contact += answer->contact;
        state->exchanged += answer->exchanged;
    }
    return nodes == LAR_ANSWER_NODES;
}

/* Asks all others again and again, until nobody has more. */
static lar_status gather_rounds(lar_computer *computer, int32_t kind, take_part *take,
                                lar_error *error) {
    int32_t count = computer->division.grid.count;
    lar_gid *from = lar_calloc((size_t)count, sizeof *from);
    if (!from) return lar_fail_memory(error, 4 * (size_t)count, "the state");
    lar_status status = LAR_OK;
    bool more = true;
    for (uint64_t round = 0; more && !status; round++) {
        const lar_order order = {kind, round};
        more = false;
        status = lar_control_order(computer->control, &order, NULL, 0, error);
        for (int32_t p = 1; p < count && !status; p++) {
            const lar_answer *answer;
            const void *value;
            status = lar_control_hear(computer->control, p, &answer, &value, error);
            if (!status && take(computer, p, round == 0, answer, value, &from[p])) more = true;
        }
    }
    free(from);
    return status;
}

/* ---- what elements and nodes of other processes remember ------------------------------------- */

/* The processor that tells of an item. */
static int32_t teller_of(const lar_computer *computer, int32_t item) {
    lar_gid node = lar_history_node(computer->whole, item);
    return node < 0 ? computer->division.recoverer[item] : computer->division.reporter[node];
}

/* The items from *item on that processor p tells of. */
static bool take_history(lar_computer *computer, int32_t p, bool first, const lar_answer *answer,
                         const void *history, int32_t *item) {
    const lar_domain *whole = computer->whole;
    const double *value = history, *end = value + answer->bytes / sizeof *value;
    (void)first;
    for (; *item < lar_history_end(whole) && value < end; (*item)++) {
        if (teller_of(computer, *item) != p || !lar_viscous_here(whole, *item)) continue;
        lar_viscous_write(whole, computer->state, *item, value);
        value += lar_viscous_count(whole, *item);
    }
    return answer->bytes > 0;
}

/* One round: so many whole items as an answer has room for; nothing: there are no more. */
lar_status lar_computer_answer_history(lar_computer *computer, uint64_t round, lar_error *error) {
    enum { ITEMS = LAR_PART_BYTES / (LAR_HISTORY_MAX * (int)sizeof(double)) };
    const lar_processor *p = &computer->processor[0];
    const lar_state *own = &p->worker[0].state;
    const lar_answer answer = {.step = own->step};
    double value[ITEMS * LAR_HISTORY_MAX];
    size_t count = 0;
    uint64_t skip = round * ITEMS, taken = 0;
    for (int32_t i = 0; i < lar_history_end(&p->domain) && taken < ITEMS; i++) {
        if (!lar_viscous_here(&p->domain, i) || teller_of(computer, i) != p->self) continue;
        if (skip > 0) {
            skip--;
            continue;
        }
        lar_viscous_read(&p->domain, own, i, value + count);
        count += (size_t)lar_viscous_count(&p->domain, i);
        taken++;
    }
    return lar_control_answer(computer->control, &answer, value, count * sizeof *value, error);
}

lar_status lar_computer_gather(lar_computer *computer, lar_error *error) {
    if (computer->gathered) return LAR_OK;
    lar_status status = lar_computer_check(computer, error);
    if (status) return status;
    lar_state *state = computer->state;
    const lar_state *first = &computer->processor[0].worker[0].state;
    state->step = first->step;
    state->part = first->part; /* who leads free bodies looks between parts */
    state->parts = first->parts;
    state->external = state->damped = state->contact = state->exchanged = 0;
    gather_here(computer);
    if (computer->control) status = gather_rounds(computer, LAR_ORDER_GATHER, take_nodes, error);
    bool remembers = computer->whole->element_history || computer->whole->rubbing ||
                     computer->whole->grip_count > 0;
    if (!status && computer->control && remembers)
        status = gather_rounds(computer, LAR_ORDER_HISTORY, take_history, error);
    computer->gathered = !status;
    if (status) computer->broken = true;
    return status;
}

/* The nodes of one round of gathering. */
lar_status lar_computer_answer_nodes(lar_computer *computer, uint64_t round, lar_error *error) {
    const lar_processor *p = &computer->processor[0];
    const lar_state *own = &p->worker[0].state;
    lar_answer answer = {.step = own->step};
    node_values value[LAR_ANSWER_NODES];
    size_t count = 0;
    uint64_t skip = round * LAR_ANSWER_NODES;
    add_work(p, computer->threads, &answer.external, &answer.damped, &answer.contact,
             &answer.exchanged);
    for (lar_gid node = 0;
         node < computer->whole->model->mesh.node_count && count < LAR_ANSWER_NODES; node++) {
        if (computer->division.reporter[node] != p->self) continue;
        if (skip > 0) {
            skip--;
            continue;
        }
        lar_state_read(own, p->domain.layout.local[node], value[count++]);
    }
    return lar_control_answer(computer->control, &answer, value, count * sizeof *value, error);
}

/* ---- scattering ---------------------------------------------------------------------------- */

static void scatter_here(lar_computer *computer) {
    for (int32_t i = 0; i < computer->hosted; i++) {
        lar_burden_take(&computer->processor[i].domain, &computer->tools->heavier, NULL);
        lar_processor_scatter(&computer->processor[i], computer->whole, computer->state);
    }
}

static void remember_here(lar_computer *computer) {
    for (int32_t i = 0; i < computer->hosted; i++)
        lar_viscous_copy(computer->whole, computer->state, &computer->processor[i].domain,
                         &computer->processor[i].worker[0].state);
}

/* Which elements are heavier belongs to a state, where it can be. */
static size_t heavier_bytes(const lar_computer *computer) {
    return computer->whole->burden ? sizeof(lar_heavy_now) : 0;
}

/* All nodes to everyone, and behind them what is remembered, or this alone: each keeps what it has.
 */
static lar_status scatter_others(lar_computer *computer, bool all, lar_error *error) {
    const lar_domain *whole = computer->whole;
    size_t nodes = all ? (size_t)whole->model->mesh.node_count : 0;
    size_t values = lar_viscous_total(whole), heavier = all ? heavier_bytes(computer) : 0;
    size_t bytes = nodes * sizeof(node_values) + values * sizeof(double) + heavier;
    node_values *value = lar_calloc(bytes, 1);
    if (!value) return lar_fail_memory(error, bytes, "the state");
    for (size_t node = 0; node < nodes; node++)
        lar_state_read(computer->state, whole->layout.local[node], value[node]);
    lar_viscous_gather(whole, computer->state, (double *)(value + nodes));
    memcpy((double *)(value + nodes) + values, &computer->tools->heavier, heavier);
    const lar_order order = {LAR_ORDER_SCATTER, computer->state->step};
    lar_status status = lar_control_order(computer->control, &order, value, bytes, error);
    for (int32_t p = 1; p < computer->division.grid.count && !status; p++) {
        const lar_answer *answer;
        status = lar_control_hear(computer->control, p, &answer, NULL, error);
    }
    free(value);
    return status;
}

lar_status lar_computer_take_state(lar_computer *computer, uint64_t step, const void *payload,
                                   size_t bytes, lar_error *error) {
    const node_values *value = payload;
    size_t values = lar_viscous_total(computer->whole);
    bool all = bytes != values * sizeof(double);
    lar_gid nodes = all ? computer->whole->model->mesh.node_count : 0;
    size_t heavier = all ? heavier_bytes(computer) : 0;
    if (bytes != (size_t)nodes * sizeof *value + values * sizeof(double) + heavier)
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor 0 sends a state of %zu bytes for %d nodes; start all processors "
                        "again, from the same installation",
                        bytes, (int)nodes);
    for (lar_gid node = 0; node < nodes; node++)
        lar_state_write(computer->state, computer->whole->layout.local[node], value[node]);
    lar_viscous_scatter(computer->whole, computer->state, (const double *)(value + nodes));
    if (!all) {
        remember_here(computer);
        return LAR_OK;
    }
    memcpy(&computer->tools->heavier, (const double *)(value + nodes) + values, heavier);
    if (!lar_heavier_now_good(computer->whole, &computer->tools->heavier))
        return lar_fail(error, LAR_ERROR_PEER,
                        "processor 0 sends a state of another model; start all processors again, "
                        "from the same installation");
    computer->state->step = step;
    scatter_here(computer);
    return LAR_OK;
}

/* Nobody computes: everyone has answered the last advance. The work that has been done belongs to
 * nobody in particular; processor zero keeps it. */
lar_status lar_computer_scatter(lar_computer *computer, lar_error *error) {
    lar_status status = lar_computer_check(computer, error);
    if (status) return status;
    scatter_here(computer);
    lar_state *first = &computer->processor[0].worker[0].state;
    first->external = computer->state->external;
    first->damped = computer->state->damped;
    first->contact = computer->state->contact;
    first->exchanged = computer->state->exchanged;
    computer->gathered = true;
    computer->tools_sent = false;
    computer->contact.valid = false;
    computer->contact.info = (lar_contact_info){0};
    if (computer->control) status = scatter_others(computer, true, error);
    if (status) computer->broken = true;
    return status;
}

lar_status lar_computer_remember(lar_computer *computer, lar_error *error) {
    lar_status status = lar_computer_check(computer, error);
    if (status) return status;
    remember_here(computer);
    if (computer->control) status = scatter_others(computer, false, error);
    if (status) computer->broken = true;
    return status;
}
