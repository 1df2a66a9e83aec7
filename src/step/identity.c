#include "step/identity.h"

#include "base/hash.h"

static uint64_t hash_doubles(uint64_t hash, const double *value, size_t count) {
    for (size_t i = 0; i < count; i++) hash = lar_hash_double(hash, value[i]);
    return hash;
}

static uint64_t hash_curve(uint64_t hash, const lar_curve *curve) {
    hash = lar_hash_word(hash, (uint64_t)curve->kind << 32 | (uint32_t)curve->shape |
                                   (uint32_t)curve->repeats << 8);
    hash = lar_hash_double(hash, curve->over);
    return hash_doubles(hash, curve->count ? curve->point[0] : NULL, 2 * (size_t)curve->count);
}

static uint64_t hash_conditions(uint64_t hash, const lar_conditions *c) {
    for (int32_t i = 0; i < c->constraint_count; i++) {
        const lar_constraint *k = &c->constraint[i];
        hash = lar_hash_word(hash, (uint64_t)(uint32_t)(4 * k->node + k->axis) << 32 |
                                       (uint32_t)k->curve);
        hash = lar_hash_double(hash, k->by);
    }
    for (int32_t i = 0; i < c->force_count; i++) {
        const lar_point_force *f = &c->force[i];
        hash = lar_hash_word(hash, (uint64_t)(uint32_t)f->node << 32 | (uint32_t)f->curve);
        hash = hash_doubles(hash, f->force, 3);
    }
    for (int32_t i = 0; i < c->spring_count; i++)
        hash = lar_hash_double(lar_hash_word(hash, (uint32_t)c->spring[i].node),
                               c->spring[i].stiffness);
    for (int32_t i = 0; i < c->pressure_count; i++) {
        const lar_face_pressure *p = &c->pressure[i];
        for (int a = 0; a < 4; a++) hash = lar_hash_word(hash, (uint32_t)p->node[a]);
        hash = lar_hash_word(hash, (uint32_t)p->curve);
        hash = lar_hash_double(hash, p->pressure);
    }
    return hash;
}

/* Blocks begin with materials and local nodes of every element, and where the nodes are at rest is
 * the rest of them, whatever the instruction set and however they are kept. */
static uint64_t hash_blocks(uint64_t hash, const lar_domain *domain) {
    const uint64_t *word;
    for (int32_t r = 0; domain->blocks && r < domain->run_count; r++)
        for (int32_t b = 0; b < domain->run[r].count; b++) {
            const lar_block_run *run = &domain->run[r];
            lar_hex8_block whole;
            word = lar_run_block(run, b);
            if (run->rest) {
                domain->kernels->expand(run, b, &whole);
                word = (const void *)&whole.head;
            }
            for (size_t i = 0; i < sizeof(lar_block_head) / sizeof *word; i++)
                hash = lar_hash_word(hash, word[i]);
        }
    if (domain->rest) hash = hash_doubles(hash, domain->rest, 3 * domain->layout.axis_stride);
    word = (const void *)domain->more;
    for (size_t i = 0; word && i < domain->more_bytes / sizeof *word; i++)
        hash = lar_hash_word(hash, word[i]);
    word = (const void *)domain->fibres;
    for (size_t i = 0; word && i < domain->fibre_bytes / sizeof *word; i++)
        hash = lar_hash_word(hash, word[i]);
    word = (const void *)domain->second;
    for (size_t i = 0; word && i < domain->fibre_bytes / sizeof *word; i++)
        hash = lar_hash_word(hash, word[i]);
    word = (const void *)domain->folds;
    for (size_t i = 0; word && i < domain->fold_bytes / sizeof *word; i++)
        hash = lar_hash_word(hash, word[i]);
    word = (const void *)domain->relaxing;
    for (size_t i = 0; word && i < domain->relaxing_bytes / sizeof *word; i++)
        hash = lar_hash_word(hash, word[i]);
    return hash;
}

/* ---- part by part -------------------------------------------------------------------------- */

static uint64_t hash_indices(uint64_t hash, const int32_t *index, int32_t count) {
    hash = lar_hash_word(hash, (uint32_t)count);
    for (int32_t i = 0; i < count; i++) hash = lar_hash_word(hash, (uint32_t)index[i]);
    return hash;
}

static uint64_t hash_mesh(const lar_mesh *mesh) {
    uint64_t hash = hash_doubles(1, mesh->position[0], 3 * (size_t)mesh->node_count);
    for (lar_gid e = 0; e < mesh->element_count; e++)
        hash = hash_indices(hash, mesh->element[e], 8);
    return hash;
}

/* What is active all the time has the hash that it always had. */
static uint64_t hash_activation(uint64_t hash, const lar_model *model) {
    for (int i = 0; i < model->material_count; i++) {
        const lar_activation *a = &model->material[i].activation;
        if (!lar_activation_varies(a)) continue;
        hash = lar_hash_word(hash, (uint64_t)i);
        if (a->curve > 0) hash = hash_curve(hash, &model->curve[a->curve - 1]);
        hash = hash_doubles(hash, a->wave.direction, 3);
        hash = hash_doubles(hash,
                            (const double[]){a->wave.speed, a->wave.length, a->wave.every,
                                             a->wave.rest, a->wave.start},
                            5);
    }
    return hash;
}

/* What is without fibres has the hash that it always had. */
static uint64_t hash_fibres(uint64_t hash, const lar_model *model) {
    if (!lar_model_fibrous(model)) return hash;
    for (int i = 0; i < model->material_count; i++) {
        const lar_fibre *f = &model->material[i].fibre;
        hash = lar_hash_word(hash, (uint64_t)lar_fibre_kind_single(f));
        hash = hash_doubles(hash, f->parameter, LAR_FIBRE_PARAMETERS);
        hash = hash_doubles(hash, (const double[]){f->along, f->across}, 2);
    }
    for (lar_gid e = 0; e < model->mesh.element_count; e++)
        if (lar_fibre_directed(&lar_model_material_of(model, e)->fibre))
            hash = hash_doubles(hash, lar_model_fibre(model, e), 3);
    for (lar_gid e = 0; e < model->mesh.element_count; e++)
        if (lar_fibre_families(&lar_model_material_of(model, e)->fibre) == 2)
            hash = hash_doubles(hash, model->mesh.second[e], 3);
    return hash_activation(hash, model);
}

static uint64_t hash_materials(const lar_model *model) {
    uint64_t hash = lar_hash_word(2, (uint64_t)model->material_count);
    for (int i = 0; i < model->material_count; i++) {
        const lar_material *m = &model->material[i];
        hash = lar_hash_word(hash, (uint64_t)m->law);
        hash = lar_hash_double(hash, m->density);
        int count = lar_law_table[m->law].count; /* at least three: so many all laws once had */
        hash = hash_doubles(hash, m->parameter, count > 3 ? (size_t)count : 3);
        const lar_viscosity *v = &m->viscosity;
        if (v->terms == 0) continue; /* what is elastic has the hash that it always had */
        hash = lar_hash_word(hash, (uint64_t)lar_viscosity_kind(v));
        hash = lar_hash_double(hash, v->rest);
        hash = hash_doubles(hash, v->share, (size_t)v->terms);
        hash = hash_doubles(hash, v->time, (size_t)v->terms);
    }
    hash = hash_fibres(hash, model);
    if (model->mass_step > 0) hash = lar_hash_double(hash, model->mass_step);
    if (model->strained_share > 0) hash = lar_hash_double(hash, -model->strained_share);
    return hash_indices(hash, model->element_material, model->mesh.element_count);
}

static uint64_t hash_nodes(uint64_t hash, const lar_node_list *nodes) {
    return hash_indices(hash, nodes->node, nodes->count);
}

/* Gravity, damping and curves: what moves every node. */
static uint64_t hash_motion(uint64_t hash, const lar_model *model) {
    hash = hash_doubles(hash, &model->damping, 1);
    hash = hash_doubles(hash, model->gravity, 3);
    for (int axis = 0; axis < 3; axis++)
        hash = lar_hash_word(hash, (uint32_t)model->gravity_curve[axis]);
    for (int i = 0; i < model->curve_count; i++) hash = hash_curve(hash, &model->curve[i]);
    return hash;
}

static uint64_t hash_screw(uint64_t hash, const lar_screw *screw) {
    hash = hash_doubles(hash_doubles(hash, screw->point, 3), screw->axis, 3);
    hash = lar_hash_double(lar_hash_double(hash, screw->angle), screw->slide);
    return lar_hash_word(hash, (uint32_t)screw->curve);
}

/* What moves nodes as one body. */
static uint64_t hash_led(uint64_t hash, uint32_t number, const lar_tool *tool) {
    hash = lar_hash_word(hash, number | tool->free << 8);
    return tool->free ? hash_doubles(hash_doubles(hash, tool->point, 3), tool->axis, 3) : hash;
}

static uint64_t hash_model_conditions(const lar_model *model) {
    uint64_t hash = hash_motion(3, model);
    for (int i = 0; i < model->fix_count; i++)
        hash = lar_hash_word(hash_nodes(hash, &model->fix[i].nodes), model->fix[i].axes);
    for (int i = 0; i < model->move_count; i++) {
        const lar_move *m = &model->move[i];
        hash = lar_hash_word(hash_nodes(hash, &m->nodes), m->axes);
        hash = lar_hash_word(lar_hash_double(hash, m->by), (uint32_t)m->curve);
        for (int k = 0; k < m->screw_count; k++) hash = hash_screw(hash, &m->screw[k]);
        if (m->tool) hash = hash_led(hash, (uint32_t)m->tool, &model->tool[m->tool - 1]);
    }
    for (int i = 0; i < model->load_count; i++) {
        const lar_nodal_load *l = &model->load[i];
        hash = hash_doubles(hash_nodes(hash, &l->nodes), l->force, 3);
        hash = lar_hash_word(hash, (uint32_t)l->curve);
    }
    for (int i = 0; i < model->spring_count; i++) {
        const lar_spring_bed *s = &model->spring[i];
        hash = hash_doubles(hash_nodes(hash, &s->nodes), s->stiffness, (size_t)s->nodes.count);
    }
    for (int i = 0; i < model->pressure_count; i++) {
        const lar_pressure_load *p = &model->pressure[i];
        hash = lar_hash_double(hash_indices(hash, p->face, p->count), p->pressure);
        hash = lar_hash_word(hash, (uint32_t)p->curve);
    }
    for (int i = 0; i < model->initial_count; i++)
        hash =
            hash_doubles(hash_nodes(hash, &model->initial[i].nodes), model->initial[i].velocity, 3);
    return hash;
}

static uint64_t hash_contacts(const lar_model *model) {
    uint64_t hash = lar_hash_word(4, (uint64_t)model->contact_count);
    for (int i = 0; i < model->contact_count; i++) {
        const lar_contact *c = &model->contact[i];
        hash = lar_hash_word(hash, (uint64_t)c->kind);
        hash = hash_indices(hash, c->face, c->face_count);
        hash = hash_indices(hash, c->against, c->against_count);
        hash = hash_doubles(hash_doubles(hash, c->through, 3), c->normal, 3);
        if (c->friction > 0) hash = lar_hash_double(hash, c->friction);
        if (c->distance > 0) hash = lar_hash_double(hash, c->distance);
        if (c->restitution > 0) hash = lar_hash_double(hash, c->restitution);
    }
    return hash;
}

static uint64_t hash_row(uint64_t hash, const lar_tool_script_row *row) {
    hash = hash_doubles(lar_hash_double(hash, row->time), row->pose.position, 3);
    return lar_hash_double(hash_doubles(hash, row->pose.orientation, 4), row->pose.opening);
}

/* Spares come and go. */
static uint64_t hash_tools(const lar_tool_list *list) {
    int32_t count = list ? lar_spares_first(list) : 0;
    uint64_t hash = lar_hash_word(5, (uint64_t)count);
    for (int32_t i = 0; i < count; i++) {
        const lar_tool *t = &list->tool[i];
        hash = lar_hash_word(hash, (uint64_t)t->shape);
        hash = hash_doubles(hash, (const double[]){t->radius, t->length, t->spread}, 3);
        hash = hash_doubles(hash, t->rest.position, 3);
        hash = hash_doubles(hash, t->rest.orientation, 4);
        hash = lar_hash_double(hash, t->rest.opening);
        if (t->friction > 0) hash = lar_hash_double(hash, t->friction);
        for (size_t j = 0; j < t->path.count; j++) hash = hash_row(hash, &t->path.row[j]);
    }
    return hash;
}

void lar_model_identify(const lar_domain *whole, lar_model_identity *identity) {
    const lar_model *model = whole->model;
    *identity = (lar_model_identity){.nodes = (uint64_t)model->mesh.node_count,
                                     .elements = (uint64_t)model->mesh.element_count,
                                     .element_kind = (uint64_t)whole->kind,
                                     .time_step = whole->time_step,
                                     .mesh = hash_mesh(&model->mesh),
                                     .materials = hash_materials(model),
                                     .conditions = hash_model_conditions(model),
                                     .contact = hash_contacts(model),
                                     .tools = hash_tools(whole->surroundings.list)};
}

static uint64_t hash_set(uint64_t hash, const lar_set *set) {
    return hash_indices(lar_hash_word(hash, (uint64_t)set->kind), set->index, set->count);
}

uint64_t lar_set_hash(const lar_set *set) {
    return hash_set(0, set);
}

uint64_t lar_conditions_with_sets(const lar_model_identity *identity, const lar_model *model) {
    uint64_t hash = lar_hash_word(identity->conditions, (uint64_t)model->mesh.set_count);
    for (int i = 0; i < model->mesh.set_count; i++) hash = hash_set(hash, &model->mesh.set[i]);
    return hash;
}

/* ---- of a computer ------------------------------------------------------------------------- */

uint64_t lar_identity(const lar_domain *whole, const lar_state *start, uint64_t division) {
    const lar_model *model = whole->model;
    size_t nodes = (size_t)whole->layout.node_padded;
    uint64_t hash = lar_hash_word(division, (uint64_t)whole->kind);
    hash = lar_hash_word(hash, start->step);
    hash = hash_doubles(hash, &whole->time_step, 1);
    hash = hash_motion(hash, model);
    hash = lar_hash_word(hash, hash_contacts(model));
    const lar_tool_list *list = whole->surroundings.list;
    hash = lar_hash_word(hash, hash_tools(list));
    if (list && list->spares > 0) hash = lar_hash_word(hash, (uint64_t)list->spares);
    hash = hash_doubles(hash, whole->push, nodes);
    hash = hash_doubles(hash, start->u, 3 * start->stride);
    hash = hash_doubles(hash, start->v, 3 * start->stride);
    hash = hash_doubles(hash, start->level, start->stride);
    return hash_blocks(hash_conditions(hash, &whole->surroundings.conditions), whole);
}
