#include "server/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "messages are little endian and are written as they lie in memory"
#endif

/* ---- the surface, once -------------------------------------------------------------------- */

/* Bodies: faces that hang together by their nodes, numbered in the order of their first faces.
 * `parent`: scratch, [nodes]. */
static void find_bodies(const uint32_t (*quad)[4], int32_t faces, int32_t nodes, int32_t *parent,
                        uint32_t *body) {
    lar_union_start(parent, nodes);
    for (int32_t f = 0; f < faces; f++)
        for (int a = 1; a < 4; a++)
            lar_union_join(parent, (int32_t)quad[f][0], (int32_t)quad[f][a]);
    /* A root is the least node of its body; its number is stored below zero. */
    int32_t count = 0;
    for (int32_t f = 0; f < faces; f++) {
        int32_t node = (int32_t)quad[f][0];
        while (parent[node] >= 0 && parent[node] != node) node = parent[node];
        if (parent[node] == node) parent[node] = -1 - count++;
        body[f] = (uint32_t)(-1 - parent[node]);
    }
}

/* Index among the surface's nodes, which are ascending. */
static uint32_t surface_index(const lar_surface_info *surface, int32_t node) {
    int32_t low = 0, high = surface->nodes - 1;
    while (low < high) {
        int32_t middle = (low + high) / 2;
        if (surface->node[middle] < node)
            low = middle + 1;
        else
            high = middle;
    }
    return (uint32_t)low;
}

/* How many families of fibres the elements behind the faces have at most. */
static int32_t count_families(const lar_model *model, const lar_surface_info *surface) {
    int32_t most = 0;
    for (int32_t f = 0; f < surface->faces && most < 2; f++) {
        int32_t here = lar_model_element_fibres(model, surface->element[f], NULL);
        if (here > most) most = here;
    }
    return most;
}

/* [faces][families][3] */
static void write_fibres(const lar_model *model, const lar_surface_info *surface, int32_t families,
                         float *out) {
    for (int32_t f = 0; f < surface->faces; f++) {
        double fibre[2][3];
        lar_model_element_fibres(model, surface->element[f], fibre);
        for (int32_t i = 0; i < 3 * families; i++) *out++ = (float)fibre[i / 3][i % 3];
    }
}

static void write_surface(const lar_model *model, const lar_surface_info *surface, int32_t families,
                          int32_t *parent, const float *processor, unsigned char *out) {
    const double(*rest)[3] = lar_model_positions(model);
    size_t n = (size_t)surface->nodes, f = (size_t)surface->faces;
    uint32_t *header = (uint32_t *)(void *)out;
    float *position = (float *)(void *)(header + 4);
    uint32_t(*quad)[4] = (uint32_t(*)[4])(void *)(position + 3 * n);
    uint32_t *material = (uint32_t *)(void *)(quad + f), *body = material + f, *owner = body + f;
    uint32_t *node = owner + n;
    header[0] = 1;
    header[1] = (uint32_t)n;
    header[2] = (uint32_t)f;
    header[3] = (uint32_t)families;
    write_fibres(model, surface, families, (float *)(void *)(node + n));
    for (size_t i = 0; i < n; i++) {
        int32_t k = surface->node[i];
        for (int axis = 0; axis < 3; axis++) position[3 * i + axis] = (float)rest[k][axis];
        owner[i] = (uint32_t)processor[k];
        node[i] = (uint32_t)k;
    }
    for (size_t i = 0; i < f; i++) {
        for (int a = 0; a < 4; a++) quad[i][a] = surface_index(surface, surface->face[i][a]);
        material[i] = (uint32_t)lar_model_element_material(model, surface->element[i]);
    }
    find_bodies((const uint32_t(*)[4])quad, surface->faces, surface->nodes, parent, body);
}

static lar_status make_surface(const lar_model *model, const float *processor, lar_blob *message,
                               lar_error *error) {
    lar_surface_info surface;
    lar_model_surface(model, &surface);
    int32_t families = count_families(model, &surface);
    size_t n = (size_t)surface.nodes, f = (size_t)surface.faces;
    size_t length = 16 + 20 * n + (24 + 12 * (size_t)families) * f;
    unsigned char *memory = lar_calloc_aligned(LAR_HEADROOM + length, 1);
    int32_t *parent = lar_calloc(n, sizeof *parent);
    if (!memory || !parent) {
        free(memory);
        free(parent);
        return lar_fail_memory(error, length, "the surface for viewers");
    }
    write_surface(model, &surface, families, parent, processor, memory + LAR_HEADROOM);
    free(parent);
    *message = (lar_blob){memory, length};
    return LAR_OK;
}

lar_status lar_surface_messages(const lar_simulation *simulation, const lar_model *model,
                                lar_blob *surface, lar_blob *embedded, lar_error *error) {
    size_t nodes = (size_t)lar_model_node_count(model);
    float *processor = lar_calloc(nodes, sizeof *processor);
    double(*u)[3] = lar_calloc(nodes, sizeof *u);
    lar_shown shown = {0};
    lar_status status = LAR_OK;
    if (!processor || !u)
        status = lar_fail_memory(error, 28 * nodes, "the processors of nodes for viewers");
    if (!status)
        status = lar_simulation_field(simulation, LAR_FIELD_PROCESSOR, (const double(*)[3])u,
                                      processor, error);
    if (!status) status = make_surface(model, processor, surface, error);
    if (!status) status = lar_shown_create(model, &shown, error);
    if (!status) status = lar_embedded_message(model, &shown, processor, embedded, error);
    lar_shown_destroy(&shown);
    free(processor);
    free(u);
    return status;
}

/* ---- frames ------------------------------------------------------------------------------- */

static uint32_t mix(uint32_t hash, uint32_t word) {
    return ((hash << 5 | hash >> 27) ^ word) * 0x9e3779b1u;
}

/* The hash of positions that a frame carries: two words over `count` words. */
static void position_hash(const uint32_t *word, size_t count, uint32_t hash[2]) {
    hash[0] = hash[1] = 0;
    for (size_t i = 0; i < count; i++) hash[i & 1] = mix(hash[i & 1], word[i]);
}

static size_t frame_bytes(const lar_painter *painter, bool values) {
    return LAR_FRAME_HEADER + (size_t)painter->shown.count * (values ? 16 : 12) +
           (size_t)painter->tools * LAR_TOOL_WORDS * 4;
}

lar_status lar_picture_create(const lar_painter *painter, lar_picture *picture, lar_error *error) {
    *picture = (lar_picture){0};
    for (int i = 0; i < LAR_FIELDS; i++) {
        size_t bytes = LAR_HEADROOM + frame_bytes(painter, i > 0);
        picture->frame[i].memory = lar_calloc_aligned(bytes, 1);
        if (picture->frame[i].memory) continue;
        lar_picture_destroy(picture);
        return lar_fail_memory(error, bytes, "a picture for viewers");
    }
    return LAR_OK;
}

void lar_picture_destroy(lar_picture *picture) {
    for (int i = 0; i < LAR_FIELDS; i++) free(picture->frame[i].memory);
    *picture = (lar_picture){0};
}

lar_status lar_painter_create(lar_session *session, const lar_model *model, lar_painter *painter,
                              lar_error *error) {
    lar_session_info info;
    lar_session_inspect(session, &info);
    *painter = (lar_painter){.session = session,
                             .simulation = info.simulation,
                             .tools = lar_simulation_tool_count(info.simulation),
                             .rest = lar_model_positions(model),
                             .nodes = lar_model_node_count(model)};
    painter->value = lar_calloc((size_t)painter->nodes, sizeof *painter->value);
    if (!painter->value)
        return lar_fail_memory(error, (size_t)painter->nodes * sizeof *painter->value,
                               "the colours of a picture");
    lar_status status = lar_shown_create(model, &painter->shown, error);
    if (!status) status = lar_snapshot_create(session, &painter->snapshot, error);
    if (status) lar_painter_destroy(painter);
    return status;
}

void lar_painter_destroy(lar_painter *painter) {
    lar_snapshot_destroy(painter->snapshot);
    lar_shown_destroy(&painter->shown);
    free(painter->value);
    *painter = (lar_painter){0};
}

static lar_status write_positions(const lar_painter *painter, float *out, lar_error *error) {
    const lar_snapshot *snapshot = painter->snapshot;
    for (int32_t i = 0; i < painter->shown.count; i++) {
        int32_t k = painter->shown.node[i];
        for (int axis = 0; axis < 3; axis++) {
            float x = (float)(painter->rest[k][axis] + snapshot->u[k][axis]);
            if (!isfinite(x))
                return lar_fail(error, LAR_ERROR_UNSTABLE,
                                "the state is not finite at step %llu; reset, or load a saved one",
                                (unsigned long long)snapshot->step);
            out[3 * (size_t)i + (size_t)axis] = x;
        }
    }
    return LAR_OK;
}

/* Values at the nodes and their range. What is not finite is zero: only the picture suffers. */
static void write_values(const lar_painter *painter, float *out, double range[2]) {
    for (int32_t i = 0; i < painter->shown.count; i++) {
        float value = painter->value[painter->shown.node[i]];
        if (!isfinite(value)) value = 0;
        out[i] = value;
        if (i == 0) range[0] = range[1] = value;
        range[0] = fmin(range[0], value);
        range[1] = fmax(range[1], value);
    }
}

static void write_tools(const lar_painter *painter, unsigned char *at) {
    uint32_t *word = (uint32_t *)(void *)at;
    for (int32_t tool = 0; tool < painter->tools; tool++, word += LAR_TOOL_WORDS) {
        lar_tool_pose pose = {.orientation = {1, 0, 0, 0}};
        lar_tool_force force = {0};
        lar_session_tool_force(painter->session, tool, &pose, &force, NULL);
        float part[14];
        for (int i = 0; i < 3; i++) {
            part[i] = (float)pose.position[i];
            part[8 + i] = (float)force.force[i];
            part[11 + i] = (float)force.torque[i];
        }
        for (int i = 0; i < 4; i++) part[3 + i] = (float)pose.orientation[i];
        part[7] = (float)pose.opening;
        memcpy(word, part, sizeof part);
        word[14] = (uint32_t)force.touching;
        word[15] = (uint32_t)force.held;
    }
}

typedef struct frame_head {
    uint32_t kind, nodes;
    uint64_t step;
    double time;
    uint64_t hash;
    uint32_t positions[2], field, values;
    double min, max;
    uint32_t tools, zero;
} frame_head;
_Static_assert(sizeof(frame_head) == LAR_FRAME_HEADER, "the header of a frame has no gaps");

/* One field's frame; `position` is the part that all frames of the picture share. */
static lar_status write_frame(lar_painter *painter, int field, const float *position,
                              const uint32_t hash[2], lar_blob *frame, lar_error *error) {
    const lar_snapshot *snapshot = painter->snapshot;
    size_t n = (size_t)painter->shown.count;
    unsigned char *out = lar_blob_data(frame);
    float *here = (float *)(void *)(out + LAR_FRAME_HEADER);
    double range[2] = {0, 0};
    lar_status status = LAR_OK;
    if (here != position) memcpy(here, position, n * 3 * sizeof *here);
    if (field > 0) {
        status = lar_simulation_field(painter->simulation, lar_field_names[field].field,
                                      (const double(*)[3])snapshot->u, painter->value, error);
        if (status) return status;
        write_values(painter, here + 3 * n, range);
    }
    write_tools(painter, (unsigned char *)(here + (field > 0 ? 4 : 3) * n));
    frame_head head = {.kind = 2,
                       .nodes = (uint32_t)n,
                       .step = snapshot->step,
                       .time = snapshot->time,
                       .hash = snapshot->hash,
                       .positions = {hash[0], hash[1]},
                       .field = lar_field_names[field].field,
                       .values = field > 0 ? (uint32_t)n : 0,
                       .min = range[0],
                       .max = range[1],
                       .tools = (uint32_t)painter->tools};
    memcpy(out, &head, sizeof head);
    frame->length = frame_bytes(painter, field > 0);
    return LAR_OK;
}

lar_status lar_painter_paint(lar_painter *painter, unsigned wanted, double seconds,
                             lar_picture *picture, lar_error *error) {
    for (int i = 0; i < LAR_FIELDS; i++) picture->frame[i].length = 0;
    lar_status status = lar_session_snapshot(painter->session, painter->snapshot, seconds, error);
    if (status) return status;
    picture->step = painter->snapshot->step;
    /* Positions lie where the first frame has them, and are copied into the others. */
    int first = 0;
    while (first < LAR_FIELDS - 1 && !(wanted & 1u << first)) first++;
    float *position = (float *)(void *)(lar_blob_data(&picture->frame[first]) + LAR_FRAME_HEADER);
    uint32_t hash[2];
    status = write_positions(painter, position, error);
    if (status) return status;
    position_hash((const uint32_t *)(const void *)position, 3 * (size_t)painter->shown.count, hash);
    for (int i = first; i < LAR_FIELDS && !status; i++)
        if (wanted & 1u << i)
            status = write_frame(painter, i, position, hash, &picture->frame[i], error);
    return status;
}
