#include "engine/identity.h"

#include "base/hash.h"

static uint64_t hash_doubles(uint64_t hash, const double *value, size_t count) {
    for (size_t i = 0; i < count; i++) hash = lar_hash_double(hash, value[i]);
    return hash;
}

static uint64_t hash_curve(uint64_t hash, const lar_curve *curve) {
    hash = lar_hash_word(hash, (uint64_t)curve->kind << 32 | (uint32_t)curve->shape);
    hash = lar_hash_double(hash, curve->over);
    return hash_doubles(hash, curve->count ? curve->point[0] : NULL, 2 * (size_t)curve->count);
}

static uint64_t hash_conditions(uint64_t hash, const lar_conditions *c) {
    for (int32_t i = 0; i < c->constraint_count; i++) {
        const lar_constraint *k = &c->constraint[i];
        hash = lar_hash_word(hash, (uint64_t)(uint32_t)k->value << 32 | (uint32_t)k->curve);
        hash = lar_hash_double(hash, k->by);
    }
    for (int32_t i = 0; i < c->force_count; i++) {
        const lar_point_force *f = &c->force[i];
        hash = lar_hash_word(hash, (uint64_t)(uint32_t)f->node << 32 | (uint32_t)f->curve);
        hash = hash_doubles(hash, f->force, 3);
    }
    for (int32_t i = 0; i < c->pressure_count; i++) {
        const lar_face_pressure *p = &c->pressure[i];
        for (int a = 0; a < 4; a++) hash = lar_hash_word(hash, (uint32_t)p->node[a]);
        hash = lar_hash_word(hash, (uint32_t)p->curve);
        hash = lar_hash_double(hash, p->pressure);
    }
    return hash;
}

/* Blocks hold geometry, materials and local nodes of every element, whatever the instruction set;
 * their padding is zero. */
static uint64_t hash_blocks(uint64_t hash, const lar_domain *domain) {
    const uint64_t *word = domain->blocks;
    for (size_t i = 0; word && i < domain->block_bytes / sizeof *word; i++)
        hash = lar_hash_word(hash, word[i]);
    return hash;
}

uint64_t lar_identity(const lar_domain *whole, const lar_state *start, uint64_t division) {
    const lar_model *model = whole->model;
    size_t nodes = (size_t)whole->layout.node_padded;
    uint64_t hash = lar_hash_word(division, (uint64_t)whole->kind);
    hash = lar_hash_word(hash, start->step);
    hash = hash_doubles(hash, &whole->time_step, 1);
    hash = hash_doubles(hash, &model->damping, 1);
    hash = hash_doubles(hash, model->gravity, 3);
    for (int axis = 0; axis < 3; axis++)
        hash = lar_hash_word(hash, (uint32_t)model->gravity_curve[axis]);
    for (int i = 0; i < model->curve_count; i++) hash = hash_curve(hash, &model->curve[i]);
    hash = hash_doubles(hash, whole->push, nodes);
    hash = hash_doubles(hash, start->u, 4 * nodes);
    hash = hash_doubles(hash, start->v, 4 * nodes);
    return hash_blocks(hash_conditions(hash, &whole->acting.conditions), whole);
}
