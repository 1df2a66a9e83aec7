/* What a model tells about its parts through the public header. */
#include <string.h>

#include "base/vector.h"
#include "model/settings.h"

int32_t lar_model_node_count(const lar_model *model) {
    return model ? model->mesh.node_count : 0;
}

int32_t lar_model_element_count(const lar_model *model) {
    return model ? model->mesh.element_count : 0;
}

int32_t lar_model_material_count(const lar_model *model) {
    return model ? model->material_count : 0;
}

const char *lar_model_source(const lar_model *model) {
    if (!model) return "";
    return model->source && *model->source ? model->source : "model";
}

int lar_model_view(const lar_model *model, double from[3]) {
    static const double none[3];
    const double *view = model ? model->view : none;
    if (from) memcpy(from, view, sizeof none);
    return view[0] != 0 || view[1] != 0 || view[2] != 0;
}

int lar_model_gravity(const lar_model *model, double time, double gravity[3]) {
    double g[3] = {0};
    if (model) lar_gravity_at(model, NULL, time, 0, g);
    if (gravity) memcpy(gravity, g, sizeof g);
    return model && lar_gravity_varies(model, NULL);
}

int64_t lar_model_node_id(const lar_model *model, int32_t node) {
    bool known = model && node >= 0 && node < model->mesh.node_count;
    return known ? model->mesh.node_id[node] : -1;
}

int64_t lar_model_element_id(const lar_model *model, int32_t element) {
    bool known = model && element >= 0 && element < model->mesh.element_count;
    return known ? model->mesh.element_id[element] : -1;
}

static lar_status refuse_index(const char *what, int32_t index, int32_t count, lar_error *error) {
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no %s %ld; the model has %ld, counted from 0", what, (long)index,
                    (long)count);
}

static lar_status refuse_null(const char *function, lar_error *error) {
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s needs a model and a place for the answer; neither may be NULL", function);
}

lar_status lar_model_material(const lar_model *model, int32_t index, lar_material_info *info,
                              lar_error *error) {
    if (!model || !info) return refuse_null("lar_model_material", error);
    if (index < 0 || index >= model->material_count)
        return refuse_index("material", index, model->material_count, error);
    const lar_material *material = &model->material[index];
    *info = (lar_material_info){.name = material->name ? material->name : "",
                                .law = lar_law_name[material->law],
                                .density = material->density,
                                .shear_modulus = lar_material_shear(material),
                                .bulk_modulus = lar_material_bulk(material),
                                .viscous_terms = material->viscosity.terms,
                                .instant_shear_modulus = lar_material_instant_shear(material),
                                .fibres = lar_fibre_law_name[material->fibre.law],
                                .fibre_modulus = lar_fibre_modulus(&material->fibre),
                                .active_along = material->fibre.along,
                                .active_across = material->fibre.across};
    if (lar_fibre_directed(&material->fibre))
        info->fibre_families = lar_fibre_families(&material->fibre);
    if (material->fibre.law == LAR_FIBRE_HGO) info->fibre_dispersion = material->fibre.parameter[2];
    for (int32_t e = 0; e < model->mesh.element_count; e++)
        info->elements += model->element_material[e] == index;
    return LAR_OK;
}

int32_t lar_model_set_count(const lar_model *model) {
    return model ? model->mesh.set_count : 0;
}

lar_status lar_model_set(const lar_model *model, int32_t index, lar_set_info *info,
                         lar_error *error) {
    static const char *const kind[] = {"nodes", "elements", "faces"};
    if (!model || !info) return refuse_null("lar_model_set", error);
    if (index < 0 || index >= model->mesh.set_count)
        return refuse_index("set", index, model->mesh.set_count, error);
    const lar_set *set = &model->mesh.set[index];
    *info = (lar_set_info){.name = set->name, .kind = kind[set->kind], .count = set->count};
    return LAR_OK;
}

int32_t lar_model_notice_count(const lar_model *model) {
    return model ? model->notice_count : 0;
}

const char *lar_model_notice_text(const lar_model *model, int32_t index) {
    return index >= 0 && index < lar_model_notice_count(model) ? model->notice[index] : NULL;
}

void lar_model_surface(const lar_model *model, lar_surface_info *info) {
    static const lar_surface none = {0};
    if (!info) return;
    const lar_surface *surface = model ? &model->surface : &none;
    *info = (lar_surface_info){.faces = surface->face_count,
                               .nodes = surface->node_count,
                               .face = (const int32_t(*)[4])surface->corner,
                               .element = surface->element,
                               .node = surface->node};
}

static void surface_place(const lar_model *model, const double (*u)[3], int32_t node,
                          double place[3]) {
    for (int i = 0; i < 3; i++) place[i] = model->mesh.position[node][i] + (u ? u[node][i] : 0);
}

/* Half the cross product of a face's diagonals is its area, wherever its corners are. */
static void add_normals(const lar_model *model, const double (*u)[3], float (*normal)[3]) {
    const lar_surface *surface = &model->surface;
    for (int32_t f = 0; f < surface->face_count; f++) {
        double x[4][3], diagonal[2][3], area[3];
        for (int a = 0; a < 4; a++) surface_place(model, u, surface->corner[f][a], x[a]);
        for (int k = 0; k < 2; k++) lar_minus(x[k + 2], x[k], diagonal[k]);
        lar_cross(diagonal[0], diagonal[1], area);
        for (int a = 0; a < 4; a++)
            for (int i = 0; i < 3; i++)
                normal[surface->index_of[surface->corner[f][a]]][i] += (float)area[i];
    }
}

void lar_model_surface_move(const lar_model *model, const double (*u)[3], float (*place)[3],
                            float (*normal)[3]) {
    int32_t nodes = model ? model->surface.node_count : 0;
    for (int32_t n = 0; n < nodes && place; n++) {
        double at[3];
        surface_place(model, u, model->surface.node[n], at);
        for (int i = 0; i < 3; i++) place[n][i] = (float)at[i];
    }
    if (!normal || nodes == 0) return;
    memset(normal, 0, (size_t)nodes * sizeof *normal);
    add_normals(model, u, normal);
    for (int32_t n = 0; n < nodes; n++) {
        double sum[3] = {(double)normal[n][0], (double)normal[n][1], (double)normal[n][2]};
        double length = lar_length(sum);
        for (int i = 0; i < 3; i++) normal[n][i] = length > 0 ? (float)(sum[i] / length) : 0;
    }
}

int32_t lar_model_element_material(const lar_model *model, int32_t element) {
    bool known = model && element >= 0 && element < model->mesh.element_count;
    return known ? model->element_material[element] : -1;
}

int32_t lar_model_element_fibres(const lar_model *model, int32_t element, double fibre[2][3]) {
    double both[6] = {0};
    int32_t families = 0;
    if (lar_model_element_nodes(model, element)) {
        const lar_fibre *of = &lar_model_material_of(model, element)->fibre;
        if (lar_fibre_directed(of)) families = lar_fibre_families(of);
        lar_model_fibres(model, element, both);
    }
    if (fibre)
        for (int i = 0; i < 6; i++) fibre[i / 3][i % 3] = i < 3 * families ? both[i] : 0;
    return families;
}

int lar_model_embedded(const lar_model *model, lar_embedded_info *info) {
    const lar_embedded_surface *embedded = model ? &model->embedded : NULL;
    if (!embedded || embedded->surface.triangle_count == 0) return 0;
    if (info)
        *info = (lar_embedded_info){.vertices = embedded->surface.vertex_count,
                                    .triangles = embedded->surface.triangle_count,
                                    .triangle = (const int32_t(*)[3])embedded->surface.corner,
                                    .rest = (const double(*)[3])embedded->surface.vertex,
                                    .element = embedded->element,
                                    .weight = (const float(*)[8])embedded->weight};
    return 1;
}

void lar_model_embedded_move(const lar_model *model, const double (*u)[3], double (*place)[3]) {
    if (lar_model_embedded(model, NULL))
        lar_embedded_surface_move(&model->embedded, &model->mesh, u, place);
}

const int32_t *lar_model_element_nodes(const lar_model *model, int32_t element) {
    bool known = model && element >= 0 && element < model->mesh.element_count;
    return known ? model->mesh.element[element] : NULL;
}

int32_t lar_model_contact_count(const lar_model *model) {
    return model ? model->contact_count : 0;
}

lar_status lar_model_contact(const lar_model *model, int32_t index, lar_model_contact_info *info,
                             lar_error *error) {
    static const char *const kind[] = {"self", "between", "plane"};
    if (!model || !info) return refuse_null("lar_model_contact", error);
    if (index < 0 || index >= model->contact_count)
        return refuse_index("contact", index, model->contact_count, error);
    const lar_contact *contact = &model->contact[index];
    *info = (lar_model_contact_info){.kind = kind[contact->kind],
                                     .faces = contact->face_count,
                                     .against = contact->against_count,
                                     .friction = contact->friction};
    memcpy(info->through, contact->through, sizeof info->through);
    memcpy(info->normal, contact->normal, sizeof info->normal);
    return LAR_OK;
}

int32_t lar_model_tool_count(const lar_model *model) {
    return model ? model->tool_count : 0;
}

lar_status lar_model_tool(const lar_model *model, int32_t index, lar_tool_info *info,
                          lar_error *error) {
    if (!model || !info) return refuse_null("lar_model_tool", error);
    if (index < 0 || index >= model->tool_count)
        return refuse_index("tool", index, model->tool_count, error);
    *info = lar_tool_inspect(&model->tool[index]);
    return LAR_OK;
}

unsigned lar_model_tool_free(const lar_model *model, int32_t index) {
    return model && index >= 0 && index < model->tool_count ? model->tool[index].free : 0;
}
