#include "step/mass/heavier.h"

#include <math.h>
#include <string.h>

#include "contact/tool_body.h"

/* Beyond this steps are divided: what is eight times as heavy swings nearly three times as slowly.
 */
static const double FACTOR_MAX = 8;
static const double NEARLY = 1.03125; /* that is not held any more */

/* ---- who is heavier ------------------------------------------------------------------------- */

static double larger(double a, double b) {
    return a > b ? a : b;
}

/* Which of two stays where there is room for one. */
static bool by_need(const lar_heavy *a, const lar_heavy *b) {
    return a->lately != b->lately ? a->lately > b->lately : a->element < b->element;
}

/* Sorted by insertion: they are few, and nearly in order. */
static void sort(lar_heavy *of, int32_t count,
                 bool (*in_order)(const lar_heavy *, const lar_heavy *)) {
    for (int32_t i = 1; i < count; i++) {
        lar_heavy moved = of[i];
        int32_t k = i;
        for (; k > 0 && in_order(&moved, &of[k - 1]); k--) of[k] = of[k - 1];
        of[k] = moved;
    }
}

static bool by_element(const lar_heavy *a, const lar_heavy *b) {
    return a->element < b->element;
}

void lar_heavier_harvest(const lar_needs *needs, lar_heavy_list *list) {
    lar_heavy *all = list->of;
    int32_t before = list->count;
    list->beyond_need = larger(list->beyond_need, needs->beyond);
    for (int32_t i = 0; i < needs->count; i++) {
        const lar_need *need = &needs->of[i];
        int32_t k = 0;
        while (k < before && all[k].element != need->element) k++;
        if (k == before && list->count == LAR_HEAVY_LIST) { /* never before a decision */
            list->beyond_need = larger(list->beyond_need, need->need);
            continue;
        }
        if (k == before) {
            k = list->count++;
            all[k] = (lar_heavy){.element = need->element, .factor = 1, .held = 1};
        }
        all[k].need = larger(all[k].need, need->need);
    }
    if (list->count > before) sort(all, list->count, by_element);
}

static void fade(double fading, double *need, double *lately) {
    *lately = larger(fmin(*need, LAR_NEED_MAX), fading * *lately);
    *need = 0;
}

static void cut(lar_heavy_list *list, int32_t count) {
    memset(&list->of[count], 0, (size_t)(list->count - count) * sizeof *list->of);
    list->count = count;
}

void lar_heavier_fade(double fading, lar_heavy_list *list) {
    for (int32_t i = 0; i < list->count && list->deep > 0; i++)
        list->beyond_need = larger(list->beyond_need, list->of[i].need + list->deep);
    list->deep = 0;
    for (int32_t i = 0; i < list->count; i++) fade(fading, &list->of[i].need, &list->of[i].lately);
    fade(fading, &list->beyond_need, &list->beyond);
    if (list->count <= LAR_HEAVIER_MAX) return;
    sort(list->of, list->count, by_need);
    list->beyond = larger(list->beyond, list->of[LAR_HEAVIER_MAX].lately);
    cut(list, LAR_HEAVIER_MAX);
    sort(list->of, list->count, by_element);
}

/* In eighths, and no less than asked for. */
static double stepped(double factor) {
    return 0.125 * ceil(8 * factor);
}

/* Springs of tools are fitted to masses without what is more, so that counts for both. */
static double factor_for(const lar_heavy *heavy, const lar_heavy_room *room) {
    double takes = heavy->lately + room->springs;
    return takes > room->max ? stepped(takes / room->max) : 1;
}

/* All corners together [kg]. */
static double mass_of(const lar_domain *whole, lar_gid e) {
    return 8 * whole->rate[e].mass;
}

bool lar_heavier_bears(const lar_domain *whole, const lar_heavy_list *list,
                       const lar_heavy_room *room) {
    double added = 0, most = whole->burden ? whole->burden->most : 0;
    if (list->beyond + room->springs > room->max) return false;
    for (int32_t i = 0; i < list->count; i++) {
        double factor = factor_for(&list->of[i], room);
        if (factor > FACTOR_MAX) return false;
        added += (factor - 1) * mass_of(whole, list->of[i].element);
    }
    return added <= most;
}

/* Where more is held than may be, what fades goes at once. */
void lar_heavier_settle(const lar_domain *whole, const lar_heavy_room *room, double fading,
                        lar_heavy_list *list) {
    bool bears = lar_heavier_bears(whole, list, room);
    double wanted[LAR_HEAVIER_MAX], added = 0;
    for (int32_t i = 0; i < list->count; i++) {
        lar_heavy *heavy = &list->of[i];
        wanted[i] = bears ? factor_for(heavy, room) : 1;
        heavy->held = larger(wanted[i], 1 + fading * (heavy->held - 1));
        added += (stepped(heavy->held) - 1) * mass_of(whole, heavy->element);
    }
    int32_t kept = 0;
    for (int32_t i = 0; i < list->count; i++) {
        lar_heavy heavy = list->of[i];
        if (added > whole->burden->most) heavy.held = wanted[i];
        /* Nearly nothing is nothing, or an eighth would be held for ever. */
        if (heavy.held < NEARLY) heavy.held = 1;
        heavy.factor = stepped(heavy.held);
        if (heavy.factor > 1 || heavy.lately > whole->room.max) list->of[kept++] = heavy;
    }
    cut(list, kept);
}

bool lar_heavier_name(const lar_heavy_list *list, lar_heavy_now *now) {
    lar_heavy_now made = {0};
    for (int32_t i = 0; i < list->count; i++) {
        if (!(list->of[i].factor > 1)) continue;
        made.element[made.count] = list->of[i].element;
        made.eighths[made.count++] = (uint8_t)(8 * list->of[i].factor);
    }
    bool changed = memcmp(&made, now, sizeof made) != 0;
    *now = made;
    return changed;
}

double lar_heavier_added(const lar_domain *whole, const lar_heavy_now *now) {
    double added = 0;
    for (int32_t i = 0; i < now->count; i++)
        added += (0.125 * now->eighths[i] - 1) * mass_of(whole, now->element[i]);
    return added;
}

bool lar_heavier_now_good(const lar_domain *whole, const lar_heavy_now *now) {
    bool good = now->count >= 0 && now->count <= LAR_HEAVIER_MAX && now->padding == 0;
    for (int32_t i = 0, last = -1; good && i < now->count; i++) {
        good = now->element[i] > last && now->element[i] < whole->model->mesh.element_count &&
               now->eighths[i] > 8 && now->eighths[i] <= 8 * FACTOR_MAX;
        last = now->element[i];
    }
    if (!whole->burden) return good && now->count == 0;
    return good && lar_heavier_added(whole, now) <= whole->burden->most;
}

static bool good_heavy(const lar_heavy *heavy) {
    return heavy->padding == 0 && heavy->factor >= 1 && heavy->factor <= FACTOR_MAX &&
           heavy->factor == stepped(heavy->factor) && heavy->need >= 0 && heavy->lately >= 0 &&
           heavy->lately <= LAR_NEED_MAX && heavy->held >= 1 && heavy->held <= FACTOR_MAX;
}

bool lar_heavier_good(const lar_domain *whole, const lar_heavy_list *list) {
    bool good = list->count >= 0 && list->count <= LAR_HEAVY_LIST && list->deep >= 0 &&
                list->beyond_need >= 0 && list->beyond >= 0 && list->beyond <= LAR_NEED_MAX;
    int32_t heavier = 0, elements = whole->model->mesh.element_count;
    for (int32_t i = 0; good && i < list->count; i++) {
        const lar_heavy *heavy = &list->of[i];
        good = heavy->element >= 0 && heavy->element < elements &&
               (i == 0 || heavy->element > heavy[-1].element) && good_heavy(heavy);
        heavier += heavy->factor > 1;
    }
    if (!good || heavier > LAR_HEAVIER_MAX) return false;
    if (!whole->burden && list->count > 0) return false;
    lar_heavy_now now = {0};
    lar_heavier_name(list, &now);
    return lar_heavier_now_good(whole, &now);
}

/* ---- masses --------------------------------------------------------------------------------- */

/* Node n has so much mass; what follows from it follows. Velocities stay, so the kinetic energy
 * changes by as much as is returned [J], where this domain accounts for the node. */
static double weigh(lar_domain *domain, lar_lid n, double mass, const lar_state *state) {
    const lar_burden *burden = domain->burden;
    double v[3] = {0};
    if (state) lar_state_velocity(state, n, v);
    double change = domain->weight[n] > 0 ? mass - domain->mass[n] : 0;
    domain->mass[n] = mass;
    if (domain->weight[n] > 0) domain->weight[n] = mass;
    domain->added[n] = (burden->added ? burden->added[n] : 0) + (mass - burden->mass[n]);
    domain->push[n] = lar_domain_push_of(domain, mass);
    return 0.5 * change * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Adds up what a node of several heavier elements has more, in the order of the elements, which is
 * the same wherever the node is. */
static void list_nodes(lar_domain *domain, double *more) {
    const lar_mesh *mesh = &domain->model->mesh;
    lar_burden *burden = domain->burden;
    burden->node_count = 0;
    for (int32_t i = 0; i < burden->now.count; i++) {
        lar_gid e = burden->now.element[i];
        double own = (0.125 * burden->now.eighths[i] - 1) * domain->rate[e].mass;
        for (int a = 0; a < 8; a++) {
            lar_lid n = domain->layout.local[mesh->element[e][a]];
            int32_t k = 0;
            if (n < 0) continue;
            while (k < burden->node_count && burden->node[k] != n) k++;
            if (k == burden->node_count) {
                burden->node[burden->node_count++] = n;
                more[k] = 0;
            }
            more[k] += own;
        }
    }
}

bool lar_burden_take(lar_domain *domain, const lar_heavy_now *now, lar_state *state) {
    lar_burden *burden = domain->burden;
    double more[8 * LAR_HEAVIER_MAX], work = 0;
    if (!burden || memcmp(&burden->now, now, sizeof *now) == 0) return false;
    for (int32_t i = 0; i < burden->node_count; i++)
        work += weigh(domain, burden->node[i], burden->mass[burden->node[i]], state);
    burden->now = *now;
    list_nodes(domain, more);
    for (int32_t i = 0; i < burden->node_count; i++) {
        lar_lid n = burden->node[i];
        work += weigh(domain, n, burden->mass[n] + more[i], state);
    }
    if (state) state->external += work;
    return true;
}

double lar_burden_factor(const lar_domain *domain, lar_gid e) {
    const lar_burden *burden = domain->burden;
    for (int32_t i = 0; burden && i < burden->now.count; i++)
        if (burden->now.element[i] == e) return 0.125 * burden->now.eighths[i];
    return 1;
}
