/* Who has to do with which groups, once per search, and what that is decided from, once. */
#include <stdlib.h>
#include <string.h>

#include "contact/history/body_friction.h"
#include "divide/incidence.h"
#include "parallel/contact_exchange.h"

/* ---- the map --------------------------------------------------------------------------------- */

static size_t region_bytes(const lar_contact_surface *surface, int32_t nodes) {
    size_t bytes = (size_t)nodes * lar_contact_node_bytes(surface) + LAR_PACKET_ALIGN;
    return (bytes + LAR_PACKET_ALIGN - 1) / LAR_PACKET_ALIGN * LAR_PACKET_ALIGN;
}

/* The processors of the elements around a node, each once, ascending, behind `has`. */
static int32_t list_owners(const lar_incidence *around, const int32_t *elements, int32_t node,
                           int32_t *has) {
    int32_t count = 0;
    for (int64_t i = around->first[node]; i < around->first[node + 1]; i++) {
        int32_t owner = elements[around->element[i]], at = 0;
        while (at < count && has[at] < owner) at++;
        if (at < count && has[at] == owner) continue;
        memmove(has + at + 1, has + at, (size_t)(count - at) * sizeof *has);
        has[at] = owner;
        count++;
    }
    return count;
}

static lar_status allocate_map(lar_contact_map *map, const lar_incidence *around,
                               lar_error *error) {
    size_t nodes = (size_t)map->surface->node_count, faces = (size_t)map->surface->face_count;
    size_t owners = 0;
    for (size_t n = 0; n < nodes; n++) {
        int32_t node = map->surface->node[n].node;
        owners += (size_t)(around->first[node + 1] - around->first[node]);
    }
    map->reporter = lar_calloc(nodes, sizeof *map->reporter);
    map->recoverer = lar_calloc(faces, sizeof *map->recoverer);
    map->has_first = lar_calloc(nodes + 1, sizeof *map->has_first);
    map->has = lar_calloc(owners, sizeof *map->has);
    map->region = lar_calloc((size_t)map->processors + 1, sizeof *map->region);
    if (map->reporter && map->recoverer && map->has_first && map->has && map->region) return LAR_OK;
    return lar_fail_memory(error, 4 * (2 * nodes + faces + owners), "who has which surfaces");
}

lar_status lar_contact_map_create(const lar_model *model, const lar_contact_surface *surface,
                                  int32_t processors, const int32_t *elements,
                                  const int32_t *reporter, const size_t *shift,
                                  lar_contact_map *map, lar_error *error) {
    *map = (lar_contact_map){.surface = surface, .processors = processors, .shift = shift};
    lar_incidence around = {0};
    lar_status status = lar_incidence_build(&model->mesh, &around, error);
    if (!status) status = allocate_map(map, &around, error);
    for (int32_t n = 0; n < surface->node_count && !status; n++) {
        int32_t node = surface->node[n].node, first = map->has_first[n];
        map->reporter[n] = reporter[node];
        map->has_first[n + 1] = first + list_owners(&around, elements, node, map->has + first);
        map->region[reporter[node] + 1]++;
    }
    for (int32_t f = 0; f < surface->face_count && !status; f++)
        map->recoverer[f] = elements[surface->face[f].element];
    for (int32_t p = 0; p < processors && !status; p++)
        map->region[p + 1] = map->region[p] + region_bytes(surface, (int32_t)map->region[p + 1]);
    lar_incidence_clear(&around);
    return status;
}

void lar_contact_map_clear(lar_contact_map *map) {
    free(map->reporter);
    free(map->recoverer);
    free(map->has_first);
    free(map->has);
    free(map->region);
    *map = (lar_contact_map){0};
}

static bool has_node(const lar_contact_map *map, int32_t processor, int32_t node) {
    for (int32_t i = map->has_first[node]; i < map->has_first[node + 1]; i++)
        if (map->has[i] == processor) return true;
    return false;
}

/* ---- who takes part -------------------------------------------------------------------------- */

/* Whether nodes remember something of a group: the one node of which it is its offset and what it
 * is flush with, all that a point is made of where they stick. */
static bool remembers(const lar_contact_surface *surface, int nodes) {
    return surface->rough || nodes == 1;
}

/* The groups that go with group g, first <= h < end: of a node on a sharp edge all, for which of
 * one body's faces it sees depends on those of others (lar_joint_of). */
static void find_together(const lar_contact_surface *s, const lar_contact_list *list, int32_t g,
                          int32_t *first, int32_t *end) {
    const int32_t node = list->group[g].node;
    *first = g;
    *end = g + 1;
    if (s->node[node].inward[0] < 0) return;
    while (*first > 0 && list->group[*first - 1].node == node) --*first;
    while (*end < list->group_count && list->group[*end].node == node) ++*end;
}

/* Whether a processor adds forces of a group, or has the node and keeps what it remembers. */
static bool concerns_one(const lar_contact_map *map, const lar_contact_list *list,
                         const lar_contact_group *group, int32_t processor) {
    const lar_contact_surface *s = map->surface;
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(s, group->node, parent, weight);
    for (int k = 0; k < count; k++)
        if (map->reporter[parent[k]] == processor ||
            (remembers(s, count) && has_node(map, processor, parent[k])))
            return true;
    for (int32_t i = group->first; i < group->first + group->count; i++) {
        int32_t f = list->face[i];
        if (map->recoverer[f] == processor &&
            lar_contact_active(&s->node[group->node], &s->face[f]))
            return true;
    }
    return false;
}

static bool concerns(const lar_contact_map *map, const lar_contact_list *list, int32_t g,
                     int32_t processor) {
    int32_t first, end;
    bool does = false;
    find_together(map->surface, list, g, &first, &end);
    for (int32_t h = first; h < end && !does; h++)
        does = concerns_one(map, list, &list->group[h], processor);
    return does;
}

/* Marks the nodes of a group. */
static void mark_nodes(const lar_contact_map *map, const lar_contact_list *list,
                       const lar_contact_group *group, uint8_t *marked) {
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(map->surface, group->node, parent, weight);
    for (int k = 0; k < count; k++) marked[parent[k]] = 1;
    const int32_t *inward = map->surface->node[group->node].inward;
    for (int k = 0; k < 3 && inward[k] >= 0; k++) marked[inward[k]] = 1;
    for (int32_t i = group->first; i < group->first + group->count; i++)
        for (int a = 0; a < 4; a++) marked[map->surface->face[list->face[i]].corner[a]] = 1;
}

/* Marks all nodes whose places a processor needs. */
static void mark_needed(const lar_contact_map *map, const lar_contact_list *list, int32_t processor,
                        uint8_t *marked) {
    memset(marked, 0, (size_t)map->surface->node_count);
    for (int32_t g = 0; g < list->group_count; g++)
        if (concerns(map, list, g, processor)) mark_nodes(map, list, &list->group[g], marked);
}

/* ---- one processor --------------------------------------------------------------------------- */

static void add_slot(lar_contact_exchange *exchange, int32_t node) {
    if (exchange->slot[node] >= 0) return;
    int32_t slot = exchange->slot[node] = exchange->slot_count++;
    if (exchange->mover[node] < 0) return;
    lar_publish_list *publish = &exchange->publish[exchange->mover[node]];
    publish->slot[publish->count] = slot;
    publish->node[publish->count++] = node;
}

/* What `other` needs of this processor's nodes goes into its own exchange buffer too. */
static void plan_peer(lar_contact_exchange *exchange, const lar_contact_list *list, int32_t self,
                      int32_t other) {
    const lar_contact_map *map = exchange->map;
    lar_contact_peer *peer = &exchange->peer[exchange->peer_count];
    peer->peer = other;
    peer->send_count = peer->receive_count = 0;
    mark_needed(map, list, other, exchange->marked);
    for (int32_t n = 0; n < map->surface->node_count; n++) {
        if (!exchange->marked[n] || map->reporter[n] != self || has_node(map, other, n)) continue;
        add_slot(exchange, n);
        peer->send[peer->send_count++] = exchange->slot[n];
    }
    for (int32_t n = 0; n < map->surface->node_count; n++)
        if (exchange->slot[n] >= 0 && exchange->mover[n] < 0 && map->reporter[n] == other)
            peer->receive[peer->receive_count++] = exchange->slot[n];
    if (peer->send_count + peer->receive_count > 0) exchange->peer_count++;
}

/* Whether a thread adds something in a group, or keeps what its node remembers. */
static bool takes(const lar_body_contact *contact, const lar_contact_list *list,
                  const lar_contact_group *group) {
    const lar_contact_surface *s = contact->surface;
    const int32_t *face = list->face + group->first;
    int32_t parent[LAR_CONTACT_PARENTS];
    double weight[LAR_CONTACT_PARENTS];
    int count = lar_contact_parents(s, group->node, parent, weight);
    bool does = false;
    for (int k = 0; k < count; k++)
        does = does || contact->adds_node[parent[k]] ||
               (remembers(s, count) && contact->keeps[parent[k]]);
    for (int32_t i = 0; i < group->count && !does; i++)
        does = contact->adds_corner[face[i]] &&
               lar_contact_active(&s->node[group->node], &s->face[face[i]]);
    return does;
}

/* The groups that a thread takes, and those that go with them. */
static void take_groups(lar_worker *worker, const lar_contact_list *list) {
    lar_body_contact *contact = &worker->interactions.body_contact;
    lar_contact_list *own = &contact->list;
    own->group_count = own->face_count = 0;
    own->skin = list->skin;
    for (int32_t g = 0; g < list->group_count; g++) {
        const lar_contact_group *group = &list->group[g];
        const int32_t *face = list->face + group->first;
        int32_t first, end;
        bool taken = false;
        find_together(contact->surface, list, g, &first, &end);
        for (int32_t h = first; h < end && !taken; h++)
            taken = takes(contact, list, &list->group[h]);
        if (!taken) continue;
        own->group[own->group_count++] =
            (lar_contact_group){group->node, own->face_count, group->count, group->gap};
        memcpy(own->face + own->face_count, face, (size_t)group->count * sizeof *face);
        memcpy(own->gap + own->face_count, list->gap + group->first,
               (size_t)group->count * sizeof *own->gap);
        own->face_count += group->count;
    }
    lar_body_contact_restart(contact);
}

void lar_contact_compile(lar_processor *p, const lar_contact_map *map,
                         const lar_contact_list *list) {
    lar_contact_exchange *exchange = p->exchange;
    exchange->map = map;
    exchange->slot_count = exchange->peer_count = 0;
    memset(exchange->slot, -1, (size_t)map->surface->node_count * sizeof *exchange->slot);
    for (int32_t t = 0; t < p->thread_count; t++) exchange->publish[t].count = 0;
    mark_needed(map, list, p->self, exchange->marked);
    for (int32_t n = 0; n < map->surface->node_count; n++)
        if (exchange->marked[n]) add_slot(exchange, n);
    for (int32_t other = 0; other < map->processors; other++)
        if (other != p->self) plan_peer(exchange, list, p->self, other);
    for (int32_t t = 0; t < p->thread_count; t++) take_groups(&p->worker[t], list);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static lar_status create_contact(const lar_body_contact *whole, int32_t thread, lar_processor *p,
                                 lar_error *error) {
    const lar_contact_surface *surface = whole->surface;
    const lar_contact_exchange *exchange = p->exchange;
    lar_body_contact *contact = &p->worker[thread].interactions.body_contact;
    size_t nodes = (size_t)surface->node_count, faces = (size_t)surface->face_count;
    size_t groups = (size_t)whole->list.group_room, pairs = (size_t)whole->list.face_room;
    uint8_t *adds_node = lar_calloc(nodes, 1), *adds_corner = lar_calloc(faces, 1);
    uint8_t *keeps = lar_calloc(nodes, 1);
    *contact = (lar_body_contact){.surface = surface,
                                  .law = whole->law,
                                  .rigid = whole->rigid,
                                  .time_step = whole->time_step,
                                  .view = {.local = exchange->local, .slot = exchange->slot},
                                  .adds_node = adds_node,
                                  .adds_corner = adds_corner,
                                  .keeps = keeps,
                                  .due = lar_calloc(groups, sizeof *contact->due),
                                  .last = lar_calloc(groups, sizeof *contact->last),
                                  .near = lar_calloc(groups, sizeof *contact->near),
                                  .away = lar_calloc(pairs, sizeof *contact->away),
                                  .part = lar_calloc(groups, sizeof *contact->part),
                                  .offset = lar_calloc(3 * groups, sizeof *contact->offset)};
    contact->list.group = lar_calloc(groups, sizeof *contact->list.group);
    contact->list.face = lar_calloc(pairs, sizeof *contact->list.face);
    contact->list.gap = lar_calloc(pairs, sizeof *contact->list.gap);
    if (!adds_node || !adds_corner || !keeps || !contact->due || !contact->last || !contact->near ||
        !contact->away || !contact->part || !contact->offset || !contact->list.group ||
        !contact->list.face || !contact->list.gap)
        return lar_fail_memory(error, groups * sizeof *contact->part + 4 * pairs,
                               "contact of bodies");
    lar_status status = lar_body_friction_create(surface, contact, error);
    if (status) return status;
    for (size_t n = 0; n < nodes; n++) {
        adds_node[n] = exchange->loader[n] == thread;
        keeps[n] = exchange->mover[n] == thread;
    }
    for (size_t f = 0; f < faces; f++) adds_corner[f] = exchange->pusher[f] == thread;
    return LAR_OK;
}

static lar_status allocate_exchange(const lar_contact_surface *surface, int32_t processors,
                                    int32_t threads, lar_contact_exchange *exchange,
                                    lar_error *error) {
    size_t nodes = (size_t)surface->node_count, faces = (size_t)surface->face_count;
    bool fits = true;
#define LAR_EXCHANGE_ARRAY(name, count)                                                            \
    fits = fits && (exchange->name = lar_calloc_aligned((count), sizeof *exchange->name)) != NULL
    LAR_EXCHANGE_ARRAY(local, nodes);
    LAR_EXCHANGE_ARRAY(mover, nodes);
    LAR_EXCHANGE_ARRAY(loader, nodes);
    LAR_EXCHANGE_ARRAY(pusher, faces);
    LAR_EXCHANGE_ARRAY(slot, nodes);
    LAR_EXCHANGE_ARRAY(place[0], nodes);
    LAR_EXCHANGE_ARRAY(place[1], nodes);
    for (int side = 0; side < 2 && surface->rough; side++) LAR_EXCHANGE_ARRAY(stick[side], nodes);
    LAR_EXCHANGE_ARRAY(publish, (size_t)threads);
    LAR_EXCHANGE_ARRAY(sequence, (size_t)threads);
    LAR_EXCHANGE_ARRAY(peer, (size_t)processors);
    LAR_EXCHANGE_ARRAY(marked, nodes);
#undef LAR_EXCHANGE_ARRAY
    fits = fits &&
           (exchange->gather = lar_calloc_aligned(nodes, lar_contact_node_bytes(surface))) != NULL;
    for (int32_t t = 0; t < threads && fits; t++) {
        exchange->publish[t].slot = lar_calloc(nodes, sizeof *exchange->publish[t].slot);
        exchange->publish[t].node = lar_calloc(nodes, sizeof *exchange->publish[t].node);
        fits = exchange->publish[t].slot && exchange->publish[t].node;
    }
    exchange->peer_room = fits ? processors : 0;
    for (int32_t i = 0; i < processors && fits; i++) {
        exchange->peer[i].send = lar_calloc(nodes, sizeof *exchange->peer[i].send);
        exchange->peer[i].receive = lar_calloc(nodes, sizeof *exchange->peer[i].receive);
        fits = exchange->peer[i].send && exchange->peer[i].receive;
    }
    return fits ? LAR_OK
                : lar_fail_memory(error, nodes * (200 + 8 * (size_t)processors), "contact places");
}

lar_status lar_contact_exchange_create(const lar_body_contact *whole,
                                       const lar_condition_share *share, const int32_t *reporter,
                                       int32_t processors, lar_processor *p, lar_error *error) {
    const lar_contact_surface *surface = whole->surface;
    if (!surface) return LAR_OK;
    const int32_t *local = p->domain.layout.local;
    lar_contact_exchange *exchange = p->exchange = lar_calloc_aligned(1, sizeof *exchange);
    if (!exchange) return lar_fail_memory(error, sizeof *exchange, "contact places");
    lar_status status = allocate_exchange(surface, processors, p->thread_count, exchange, error);
    if (status) return status;
    for (int32_t n = 0; n < surface->node_count; n++) {
        int32_t node = surface->node[n].node;
        exchange->local[n] = local[node];
        exchange->mover[n] = share->holds[node];
        exchange->loader[n] = reporter[node] == p->self ? share->loads[node] : -1;
    }
    for (int32_t f = 0; f < surface->face_count; f++)
        exchange->pusher[f] = share->presses[surface->face[f].element];
    for (int32_t t = 0; t < p->thread_count && !status; t++)
        status = create_contact(whole, t, p, error);
    return status;
}

void lar_contact_exchange_destroy(lar_processor *p) {
    lar_contact_exchange *exchange = p->exchange;
    if (!exchange) return;
    for (int32_t t = 0; t < p->thread_count; t++) {
        lar_body_contact *contact = &p->worker[t].interactions.body_contact;
        free(contact->adds_node);
        free(contact->adds_corner);
        free(contact->keeps);
        free(contact->list.group);
        free(contact->list.face);
        free(contact->list.gap);
        contact->adds_node = contact->adds_corner = contact->keeps = NULL;
        contact->list = (lar_contact_list){0};
        if (!exchange->publish) continue;
        free(exchange->publish[t].slot);
        free(exchange->publish[t].node);
    }
    for (int32_t i = 0; exchange->peer && i < exchange->peer_room; i++) {
        free(exchange->peer[i].send);
        free(exchange->peer[i].receive);
    }
    free(exchange->local);
    free(exchange->mover);
    free(exchange->loader);
    free(exchange->pusher);
    free(exchange->slot);
    free(exchange->place[0]);
    free(exchange->place[1]);
    free(exchange->stick[0]);
    free(exchange->stick[1]);
    free(exchange->publish);
    free(exchange->sequence);
    free(exchange->peer);
    free(exchange->gather);
    free(exchange->marked);
    free(exchange);
    p->exchange = NULL;
}
