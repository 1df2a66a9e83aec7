#include "simulation/checkpoint.h"

#include <fcntl.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/pose.h"
#include "contact/spares.h"
#include "contact/tool_body.h"
#include "simulation/checkpoint_rows.h"
#include "step/identity.h"
#include "step/mass/heavier.h"
#include "step/viscous_history.h"

/* ---- what stands in a file ------------------------------------------------------------------ */

/* Version 3 had no settings: neither them nor what they take of a step. Up to version 5 a step had
 * 32 shares. A state with added tools has an odd version from 5 on, any other one an even one. One
 * with forces that were set on nodes has version 8 or 9, one with an activation that was set 10 or
 * 11, with forces or without, one with strained elements that are heavier, or may soon be, 12 or
 * 13, with supports that were set 14 or 15, with parameters of materials that were set 16 or 17,
 * with tools of which some are harder than others 18 or 19, with bodies that have touched 20 or 21,
 * each with all of the others; others are written as they always were. */
enum { BEFORE_SETTINGS = 3, BEFORE_THIRDS = 5, VERSION = 6, FORCES = 8, ACTIVE = 10 };
enum { HEAVIER = 12, SUPPORTED = 14, PARAMETERS = 16, HARDNESS = 18, TOUCHED = 20, NEWEST = 21 };
enum { BYTE_ORDER_MARK = 0x01020304 };

typedef struct file_head {
    char magic[8];
    uint32_t version, byte_order;
    uint64_t bytes; /* of the file */
    lar_model_identity identity;
    uint64_t step;
    double external, damped, contact;
    uint64_t hash; /* of the state, as lar_simulation_hash */
    int32_t tools, grasps;
} file_head;

/* Whoever changes these changes the file: raise VERSION, and tell docs/formats.md. */
_Static_assert(sizeof(lar_model_identity) == 72, "part of the format");
_Static_assert(sizeof(file_head) == 144, "the format");
_Static_assert(sizeof(lar_step_division) == 56, "the format");
_Static_assert(offsetof(lar_step_division, base) == 48, "of version 3: until there");
_Static_assert(sizeof(lar_settings) == 1064 && offsetof(lar_settings, activation) == 552,
               "the format");
_Static_assert(sizeof(lar_tool_motion) == 152 && sizeof(lar_grasp) == 72, "the format");
_Static_assert(sizeof(lar_tool_follower) == 240, "the format");
_Static_assert(LAR_NODE_VALUES == 7, "the format");
_Static_assert(sizeof(lar_force_entry) == 32 && offsetof(lar_forces, entry) == 8, "the format");
_Static_assert(sizeof(lar_support_entry) == 8 && offsetof(lar_supports, entry) == 8, "the format");
_Static_assert(sizeof(lar_parameter_entry) == 104 && offsetof(lar_parameters, entry) == 8,
               "the format");
_Static_assert(sizeof(lar_heavy) == 40 && offsetof(lar_heavy_list, of) == 24, "the format");
_Static_assert(sizeof(lar_spare_tool) == 104 && LAR_SPARES_MAX == 4, "the format");

/* What its size follows from, besides the nodes. */
typedef struct file_shape {
    uint32_t version;
    int32_t tools, grasps;
    size_t history;  /* values that viscous elements remember: as many as the model says */
    int32_t forces;  /* that were set; of versions that have them */
    int32_t heavier; /* strained elements that stand in it, likewise */
    int32_t supports, parameters; /* that were set, likewise */
} file_shape;

static bool has_added(uint32_t version) {
    return version >= BEFORE_THIRDS && version % 2 == 1;
}

/* What was set, without spares and forces. */
static size_t set_bytes(uint32_t version) {
    if (version == BEFORE_SETTINGS) return 0;
    return version < ACTIVE ? offsetof(lar_settings, activation) : sizeof(lar_settings);
}

static size_t settings_bytes(uint32_t version) {
    size_t spares = has_added(version) ? LAR_SPARES_MAX * sizeof(lar_spare_tool) : 0;
    return version == BEFORE_SETTINGS ? offsetof(lar_step_division, base)
                                      : sizeof(lar_step_division) + set_bytes(version) + spares;
}

/* Their number, and they. */
static size_t forces_bytes(const file_shape *shape) {
    if (shape->version < FORCES) return 0;
    return offsetof(lar_forces, entry) + (size_t)shape->forces * sizeof(lar_force_entry);
}

/* The same of strained elements. */
static size_t heavier_bytes(const file_shape *shape) {
    if (shape->version < HEAVIER) return 0;
    return offsetof(lar_heavy_list, of) + (size_t)shape->heavier * sizeof(lar_heavy);
}

/* The same of supports. */
static size_t supports_bytes(const file_shape *shape) {
    if (shape->version < SUPPORTED) return 0;
    return offsetof(lar_supports, entry) + (size_t)shape->supports * sizeof(lar_support_entry);
}

/* The same of materials with parameters that were set. */
static size_t parameters_bytes(const file_shape *shape) {
    if (shape->version < PARAMETERS) return 0;
    return offsetof(lar_parameters, entry) +
           (size_t)shape->parameters * sizeof(lar_parameter_entry);
}

/* How hard each tool is, and how deep tissue is close to its middle. */
static size_t hardness_bytes(const file_shape *shape) {
    return shape->version < HARDNESS ? 0 : 2 * (size_t)shape->tools * sizeof(double);
}

/* What contact has exchanged. */
static size_t exchanged_bytes(const file_shape *shape) {
    return shape->version < TOUCHED ? 0 : sizeof(double);
}

static size_t file_bytes(const file_shape *shape, size_t nodes) {
    size_t tools = (size_t)shape->tools, grasps = (size_t)shape->grasps;
    return sizeof(file_head) + settings_bytes(shape->version) + forces_bytes(shape) +
           heavier_bytes(shape) + supports_bytes(shape) + parameters_bytes(shape) +
           hardness_bytes(shape) + tools * (sizeof(lar_tool_motion) + sizeof(lar_tool_follower)) +
           grasps * sizeof(lar_grasp) + exchanged_bytes(shape) +
           nodes * LAR_NODE_VALUES * sizeof(double) + shape->history * sizeof(double) +
           sizeof(uint64_t);
}

uint64_t lar_checkpoint_sum(const void *data, size_t words) {
    const unsigned char *at = data;
    uint64_t sum = 0;
    for (size_t i = 0; i < words; i++) {
        uint64_t word;
        memcpy(&word, at + 8 * i, sizeof word);
        sum = lar_hash_word(sum, word);
    }
    return sum;
}

/* ---- writing -------------------------------------------------------------------------------- */

static bool all_finite(const double *value, size_t count) {
    bool finite = true;
    for (size_t i = 0; i < count; i++) finite = finite && isfinite(value[i]);
    return finite;
}

static lar_status check_finite(const char *path, const lar_domain *whole, const lar_state *state,
                               lar_error *error) {
    const lar_mesh *mesh = &whole->model->mesh;
    bool finite = isfinite(state->external) && isfinite(state->damped) &&
                  isfinite(state->contact) && isfinite(state->exchanged);
    for (lar_gid g = 0; g < mesh->node_count; g++) {
        double value[LAR_NODE_VALUES];
        lar_state_read(state, whole->layout.local[g], value);
        finite = finite && all_finite(value, LAR_NODE_VALUES);
    }
    finite = finite && all_finite(state->history, state->history_count);
    if (finite) return LAR_OK;
    return lar_fail(error, LAR_ERROR_UNSTABLE,
                    "%s: the state has left the range of numbers and is not saved; go back to an "
                    "earlier checkpoint or to the start",
                    path);
}

static unsigned char *append(unsigned char *at, const void *from, size_t bytes) {
    memcpy(at, from, bytes);
    return at + bytes;
}

/* Whether strained elements are heavier, or may soon be. */
static bool some_strained(const lar_heavy_list *list) {
    return list->count > 0 || list->beyond > 0 || list->beyond_need > 0;
}

/* What a file has of the tools: spares up to the last one that is there. */
static file_shape shape_of(const lar_domain *whole, const lar_state *state,
                           const lar_tools *tools) {
    const lar_tool_list *list = whole->surroundings.list;
    int32_t spares = lar_spares_needed(tools->spare);
    int32_t count = (list ? lar_spares_first(list) : 0) + spares;
    const lar_heavy_list *heavier = &tools->strained;
    uint32_t version = state->exchanged > 0                      ? TOUCHED
                       : lar_tools_differ(tools, count)          ? HARDNESS
                       : tools->parameters.count > 0             ? PARAMETERS
                       : tools->supports.count > 0               ? SUPPORTED
                       : some_strained(heavier)                  ? HEAVIER
                       : lar_settings_activate(&tools->settings) ? ACTIVE
                       : tools->forces.count > 0                 ? FORCES
                                                                 : VERSION;
    return (file_shape){.version = version + (spares > 0),
                        .forces = tools->forces.count,
                        .heavier = heavier->count,
                        .supports = tools->supports.count,
                        .parameters = tools->parameters.count,
                        .tools = count,
                        .grasps = tools->grasp_count,
                        .history = lar_viscous_total(whole)};
}

/* Returns where the nodes begin. */
static unsigned char *fill_tools(unsigned char *at, const file_shape *shape,
                                 const lar_tools *tools) {
    size_t count = (size_t)shape->tools, grasps = (size_t)shape->grasps;
    at = append(at, &tools->division, sizeof tools->division);
    at = append(at, &tools->settings, set_bytes(shape->version));
    if (has_added(shape->version)) at = append(at, tools->spare, sizeof tools->spare);
    at = append(at, &tools->forces, forces_bytes(shape));
    at = append(at, &tools->strained, heavier_bytes(shape));
    at = append(at, &tools->supports, supports_bytes(shape));
    at = append(at, &tools->parameters, parameters_bytes(shape));
    at = append(at, tools->hardness, hardness_bytes(shape) / 2);
    at = append(at, tools->deep, hardness_bytes(shape) / 2);
    at = append(at, tools->motion, count * sizeof tools->motion[0]);
    at = append(at, tools->follower, count * sizeof tools->follower[0]);
    return append(at, tools->grasps, grasps * sizeof tools->grasps[0]);
}

/* Whether something was set on sets of nodes. */
static bool has_sets(const lar_tools *tools) {
    bool has = false;
    for (int32_t i = 0; i < tools->forces.count; i++)
        has = has || tools->forces.entry[i].on_set != 0;
    for (int32_t i = 0; i < tools->supports.count; i++)
        has = has || tools->supports.entry[i].on_set != 0;
    return has;
}

static unsigned char *fill(const lar_domain *whole, const lar_state *state, const lar_tools *tools,
                           const file_shape *shape, size_t bytes) {
    unsigned char *data = lar_calloc(bytes, 1);
    if (!data) return NULL;
    lar_gid nodes = whole->model->mesh.node_count;
    unsigned char *at = fill_tools(data + sizeof(file_head), shape, tools);
    double *rows = (double *)(void *)append(at, &state->exchanged, exchanged_bytes(shape));
    for (lar_gid g = 0; g < nodes; g++) {
        double value[LAR_NODE_VALUES];
        lar_state_read(state, whole->layout.local[g], value);
        lar_checkpoint_put(rows, (size_t)nodes, (size_t)g, value);
    }
    double *history = rows + LAR_NODE_VALUES * (size_t)nodes;
    lar_viscous_gather(whole, state, history);
    uint64_t hash = lar_checkpoint_hash(state->step, rows, (size_t)nodes);
    file_head head = {.version = shape->version,
                      .byte_order = BYTE_ORDER_MARK,
                      .bytes = bytes,
                      .step = state->step,
                      .external = state->external,
                      .damped = state->damped,
                      .contact = state->contact,
                      .hash = lar_viscous_hash_values(hash, history, shape->history),
                      .tools = shape->tools,
                      .grasps = shape->grasps};
    memcpy(head.magic, LAR_CHECKPOINT_MAGIC, LAR_CHECKPOINT_MAGIC_BYTES);
    lar_model_identify(whole, &head.identity);
    if (has_sets(tools))
        head.identity.conditions = lar_conditions_with_sets(&head.identity, whole->model);
    memcpy(data, &head, sizeof head);
    uint64_t sum = lar_checkpoint_sum(data, bytes / 8 - 1);
    memcpy(data + bytes - 8, &sum, sizeof sum);
    return data;
}

lar_status lar_checkpoint_pack(const char *path, const lar_domain *whole, const lar_state *state,
                               const lar_tools *tools, lar_bytes *bytes, lar_error *error) {
    lar_status status = check_finite(path, whole, state, error);
    if (status) return status;
    const file_shape shape = shape_of(whole, state, tools);
    lar_bytes made = {.size = file_bytes(&shape, (size_t)whole->model->mesh.node_count)};
    made.data = fill(whole, state, tools, &shape, made.size);
    if (!made.data) return lar_fail_memory(error, made.size, path);
    *bytes = made;
    return LAR_OK;
}

/* ---- reading -------------------------------------------------------------------------------- */

static lar_status refuse(lar_error *error, const char *path, const char *why) {
    return lar_fail(error, LAR_ERROR_FORMAT, "%s: %s", path, why);
}

/* Whether it is a whole file of ours. */
static lar_status check_file(const char *path, const lar_bytes *bytes, file_head *head,
                             lar_error *error) {
    *head = (file_head){0};
    memcpy(head, bytes->data, bytes->size < sizeof *head ? bytes->size : sizeof *head);
    if (bytes->size < LAR_CHECKPOINT_MAGIC_BYTES ||
        memcmp(head->magic, LAR_CHECKPOINT_MAGIC, LAR_CHECKPOINT_MAGIC_BYTES) != 0)
        return refuse(error, path, "is not a checkpoint of Lariat; name a file that it has saved");
    if (bytes->size >= 16 && head->byte_order == 0x04030201)
        return refuse(error, path,
                      "was saved on a machine with another order of bytes; load it on one like "
                      "that");
    if (bytes->size >= 16 && (head->version < BEFORE_SETTINGS || head->version > NEWEST))
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: is a checkpoint of version %lu, this Lariat reads versions %d to %d; "
                        "save it anew with this one",
                        path, (unsigned long)head->version, BEFORE_SETTINGS, NEWEST);
    if (bytes->size < sizeof *head || bytes->size < head->bytes)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: is cut off after %zu bytes; take another checkpoint", path,
                        bytes->size);
    if (bytes->size > head->bytes || bytes->size % 8 != 0)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: has %zu bytes and says %llu; it has been altered, take another "
                        "checkpoint",
                        path, bytes->size, (unsigned long long)head->bytes);
    uint64_t sum;
    memcpy(&sum, bytes->data + bytes->size - 8, sizeof sum);
    if (sum != lar_checkpoint_sum(bytes->data, bytes->size / 8 - 1) ||
        head->byte_order != BYTE_ORDER_MARK)
        return refuse(error, path,
                      "is damaged: its checksum does not fit; take another checkpoint");
    return LAR_OK;
}

lar_status lar_checkpoint_read(const char *path, lar_bytes *bytes, lar_error *error) {
    /* The head first: what is much longer than a checkpoint is not worth reading. */
    file_head head, again;
    struct stat about;
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool whole = file >= 0 && fstat(file, &about) == 0 && S_ISREG(about.st_mode) &&
                 read(file, &head, sizeof head) == (ssize_t)sizeof head;
    if (file >= 0) close(file);
    lar_bytes begin = {(unsigned char *)&head, whole ? (size_t)about.st_size : 0};
    if (whole && begin.size != head.bytes) return check_file(path, &begin, &again, error);
    return lar_bytes_read(path, bytes, error);
}

/* They stand behind the settings. */
static void look_at_spares(const file_head *head, const lar_bytes *bytes,
                           lar_spare_tool spare[LAR_SPARES_MAX]) {
    size_t at = sizeof *head + settings_bytes(head->version - 1),
           size = LAR_SPARES_MAX * sizeof *spare;
    if (has_added(head->version) && bytes->size >= at + size) memcpy(spare, bytes->data + at, size);
}

lar_status lar_checkpoint_inspect(const char *path, lar_checkpoint_info *info, lar_error *error) {
    lar_bytes bytes = {0};
    file_head head;
    if (!path || !info)
        return lar_fail(
            error, LAR_ERROR_ARGUMENT,
            "lar_checkpoint_inspect needs the path of a saved state and a place for the "
            "answer");
    lar_spare_tool spare[LAR_SPARES_MAX] = {{0}};
    lar_status status = lar_checkpoint_read(path, &bytes, error);
    if (!status) status = check_file(path, &bytes, &head, error);
    if (!status) look_at_spares(&head, &bytes, spare);
    lar_bytes_free(&bytes);
    if (status) return status;
    int32_t spares = lar_spares_needed(spare);
    if (head.identity.element_kind > 2 || head.tools < spares)
        return refuse(error, path, "has elements or tools that cannot be; take another checkpoint");
    *info = (lar_checkpoint_info){.element = (lar_element_kind)head.identity.element_kind,
                                  .nodes = (int32_t)head.identity.nodes,
                                  .elements = (int32_t)head.identity.elements,
                                  .tools = head.tools - spares,
                                  .time_step = head.identity.time_step,
                                  .step = head.step,
                                  .spares = spares};
    return LAR_OK;
}

static lar_status refuse_model(lar_error *error, const char *path, const char *what) {
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: was saved from another model: %s; load it into the model that it was "
                    "saved from",
                    path, what);
}

/* The coarsest difference first. */
static lar_status check_model(const char *path, const file_head *head, const lar_domain *whole,
                              lar_error *error) {
    static const char *const kinds[] = {"hex8", "hex8-full", "hex8-matrix"};
    const lar_model_identity *there = &head->identity;
    lar_model_identity here;
    char what[200];
    lar_model_identify(whole, &here);
    if (there->nodes != here.nodes || there->elements != here.elements) {
        snprintf(what, sizeof what,
                 "%llu nodes and %llu elements instead of %llu nodes and %llu elements",
                 (unsigned long long)there->nodes, (unsigned long long)there->elements,
                 (unsigned long long)here.nodes, (unsigned long long)here.elements);
        return refuse_model(error, path, what);
    }
    if (there->mesh != here.mesh)
        return refuse_model(error, path, "its nodes or elements are at other places");
    if (there->materials != here.materials)
        return refuse_model(error, path, "its materials are others");
    /* Files of before November 2026 do not tell sets. */
    if (there->conditions != here.conditions &&
        there->conditions != lar_conditions_with_sets(&here, whole->model))
        return refuse_model(error, path,
                            "its supports, loads, damping or gravity are others, or sets of nodes "
                            "on which something was set");
    if (there->contact != here.contact)
        return refuse_model(error, path, "what may touch what is different");
    if (there->tools != here.tools)
        return refuse_model(error, path, "its tools are others (hands count, too)");
    if (there->element_kind != here.element_kind) {
        const char *name = there->element_kind < 3 ? kinds[there->element_kind] : "of another kind";
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: was saved with elements %s, this simulation has %s; choose the same",
                        path, name, kinds[here.element_kind]);
    }
    if (there->time_step != here.time_step)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: was saved with a time step of %.17g s, this simulation has %.17g s; "
                        "choose the same",
                        path, there->time_step, here.time_step);
    return LAR_OK;
}

/* Files of version 5 or before count a step 32 times. */
static void count_in_shares(lar_tool_follower *follower) {
    lar_tool_felt *felt = &follower->felt;
    int64_t *sum[7] = {&felt->force[0],  &felt->force[1],  &felt->force[2], &felt->torque[0],
                       &felt->torque[1], &felt->torque[2], &felt->squeeze};
    for (int i = 0; i < 7; i++)
        if (llabs(*sum[i]) < INT64_MAX / 4) *sum[i] *= LAR_STEP_SHARES / 32;
}

/* Those that a file does not have rest, and are nothing. */
static void fill_up(const lar_tool_list *list, lar_tools *tools) {
    static const lar_tool_pose nowhere = {.orientation = {1, 0, 0, 0}, .opening = 1};
    while (list && tools->count < list->count) {
        lar_tool_motion *motion = &tools->motion[tools->count];
        *motion = (lar_tool_motion){.from = nowhere, .to = nowhere};
        tools->follower[tools->count++].hand = *motion;
    }
}

static const unsigned char *extract(const unsigned char *at, void *to, size_t bytes) {
    memcpy(to, at, bytes);
    return at + bytes;
}

/* A number of entries, which stands before them: 0 up to `max`. -1: the file ends before. */
static int32_t count_at(const lar_bytes *bytes, size_t at, int32_t max) {
    int32_t count;
    if (bytes->size < at + sizeof count) return -1;
    memcpy(&count, bytes->data + at, sizeof count);
    return count <= max ? count : -1;
}

/* Forces stand behind the settings, then strained elements, supports and parameters. */
static void count_entries(const file_head *head, const lar_bytes *bytes, file_shape *shape) {
    size_t at = sizeof *head + settings_bytes(head->version);
    if (head->version >= FORCES) shape->forces = count_at(bytes, at, LAR_FORCES_MAX);
    if (shape->forces < 0) return;
    at += forces_bytes(shape);
    if (head->version >= HEAVIER) shape->heavier = count_at(bytes, at, LAR_HEAVY_LIST);
    if (shape->heavier < 0) return;
    at += heavier_bytes(shape);
    if (head->version >= SUPPORTED) shape->supports = count_at(bytes, at, LAR_SUPPORTS_MAX);
    if (shape->supports < 0) return;
    at += supports_bytes(shape);
    if (head->version >= PARAMETERS) shape->parameters = count_at(bytes, at, LAR_MATERIALS_SET_MAX);
}

/* What fill_tools writes; *at moves behind it. */
static bool take_tools(const file_head *head, const file_shape *shape, const lar_domain *whole,
                       const unsigned char **at, lar_tools *tools) {
    const lar_tool_list *list = whole->surroundings.list;
    *tools =
        (lar_tools){.count = head->tools, .grasp_count = head->grasps, .division = {.base = 1}};
    size_t count = (size_t)tools->count, grasps = (size_t)tools->grasp_count;
    bool settings = head->version != BEFORE_SETTINGS;
    lar_settings_reset(&tools->settings);
    *at = extract(*at, &tools->division,
                  settings ? sizeof tools->division : offsetof(lar_step_division, base));
    *at = extract(*at, &tools->settings, set_bytes(head->version));
    if (has_added(head->version)) *at = extract(*at, tools->spare, sizeof tools->spare);
    *at = extract(*at, &tools->forces, forces_bytes(shape));
    *at = extract(*at, &tools->strained, heavier_bytes(shape));
    *at = extract(*at, &tools->supports, supports_bytes(shape));
    *at = extract(*at, &tools->parameters, parameters_bytes(shape));
    for (size_t i = 0; i < LAR_TOOLS_MAX; i++)
        tools->hardness[i] = i < count ? tools->division.hardness : 1;
    *at = extract(*at, tools->hardness, hardness_bytes(shape) / 2);
    *at = extract(*at, tools->deep, hardness_bytes(shape) / 2);
    *at = extract(*at, tools->motion, count * sizeof tools->motion[0]);
    *at = extract(*at, tools->follower, count * sizeof tools->follower[0]);
    for (size_t i = 0; i < count && head->version <= BEFORE_THIRDS; i++)
        count_in_shares(&tools->follower[i]);
    *at = extract(*at, tools->grasps, grasps * sizeof tools->grasps[0]);
    bool good = lar_division_good(&tools->division, head->step) &&
                lar_settings_good(&tools->settings, whole->time_step) &&
                lar_forces_good(&tools->forces, whole->model, lar_domain_force_max(whole)) &&
                lar_spares_good(tools->spare, list ? list->spares : 0) &&
                lar_heavier_good(whole, &tools->strained) &&
                lar_supports_good(&tools->supports, whole->model) &&
                lar_parameters_good(&tools->parameters, &tools->settings, whole->model) &&
                (head->version >= TOUCHED ||
                 lar_tools_differ(tools, tools->count) == (head->version >= HARDNESS)) &&
                (head->version >= HARDNESS ||
                 (tools->parameters.count > 0) == (head->version >= PARAMETERS)) &&
                (head->version >= PARAMETERS ||
                 (tools->supports.count > 0) == (head->version >= SUPPORTED)) &&
                (head->version >= SUPPORTED ||
                 some_strained(&tools->strained) == (head->version >= HEAVIER));
    for (int32_t i = 0; good && i < tools->count; i++) {
        const lar_tool tool = lar_spare_tool_of(list, tools->spare, i);
        good = lar_hardness_good(tools, i, tool.radius) &&
               lar_tool_motion_good(&tool, &tools->motion[i]) &&
               lar_tool_follower_good(&tool, &tools->follower[i]);
    }
    for (int32_t i = 0; good && i < tools->grasp_count; i++)
        good = lar_grasp_good(&tools->grasps[i], head->tools, whole->model) &&
               lar_spare_tool_of(list, tools->spare, tools->grasps[i].tool).shape != LAR_TOOL_NONE;
    if (good) lar_heavier_name(&tools->strained, &tools->heavier);
    fill_up(list, tools);
    return good;
}

lar_status lar_checkpoint_parse(const char *path, const lar_bytes *bytes, const lar_domain *whole,
                                lar_checkpoint *checkpoint, lar_error *error) {
    const lar_model *model = whole->model;
    const lar_tool_list *list = whole->surroundings.list;
    size_t nodes = (size_t)model->mesh.node_count;
    file_head head;
    lar_status status = check_file(path, bytes, &head, error);
    if (!status) status = check_model(path, &head, whole, error);
    if (status) return status;
    file_shape shape = {.version = head.version,
                        .tools = head.tools,
                        .grasps = head.grasps,
                        .history = lar_viscous_total(whole)};
    count_entries(&head, bytes, &shape);
    int32_t constant = list ? lar_spares_first(list) : 0;
    int32_t spares = head.tools < constant ? -1 : head.tools - constant;
    if (spares < 0 || spares > (has_added(head.version) ? LAR_SPARES_MAX : 0) || head.grasps < 0 ||
        head.grasps > LAR_GRASPS_MAX || shape.forces < 0 || shape.heavier < 0 ||
        shape.supports < 0 || shape.parameters < 0 || bytes->size != file_bytes(&shape, nodes))
        return refuse(error, path, "its parts have sizes that do not fit; take another checkpoint");
    if (spares > 0 && spares > list->spares)
        return lar_fail(error, LAR_ERROR_MODEL,
                        "%s: tools were added to what it was saved from, and this simulation has "
                        "%s places for them; create it with options.spares = %ld",
                        path, list->spares ? "too few" : "no", (long)spares);
    checkpoint->step = head.step;
    checkpoint->external = head.external;
    checkpoint->damped = head.damped;
    checkpoint->contact = head.contact;
    if (head.version == BEFORE_SETTINGS) checkpoint->damped *= model->damping;
    const unsigned char *at = bytes->data + sizeof head;
    if (!take_tools(&head, &shape, whole, &at, &checkpoint->tools))
        return refuse(error, path,
                      "has a tool or a setting that cannot be so; take another checkpoint");
    checkpoint->exchanged = 0;
    at = extract(at, &checkpoint->exchanged, exchanged_bytes(&shape));
    checkpoint->rows = (const double *)(const void *)at;
    bool finite = isfinite(head.external) && isfinite(head.damped) && isfinite(head.contact) &&
                  isfinite(checkpoint->exchanged) &&
                  (checkpoint->exchanged > 0) == (head.version >= TOUCHED);
    checkpoint->history = checkpoint->rows + LAR_NODE_VALUES * nodes;
    if (!finite || !all_finite(checkpoint->rows, LAR_NODE_VALUES * nodes + shape.history) ||
        head.step > LAR_STEPS_MAX)
        return refuse(error, path, "has numbers beyond all range; take another checkpoint");
    uint64_t hash = lar_checkpoint_hash(head.step, checkpoint->rows, nodes);
    if (head.hash != lar_viscous_hash_values(hash, checkpoint->history, shape.history))
        return refuse(error, path, "has a state with another hash; take another checkpoint");
    return LAR_OK;
}

void lar_checkpoint_take(const lar_checkpoint *checkpoint, const lar_domain *whole,
                         lar_state *state, lar_tools *tools) {
    memset(state->u, 0, 3 * state->stride * sizeof *state->u);
    memset(state->v, 0, 3 * state->stride * sizeof *state->v);
    memset(state->level, 0, state->stride * sizeof *state->level);
    memset(state->force, 0, 3 * state->stride * sizeof *state->force);
    for (lar_gid g = 0; g < whole->model->mesh.node_count; g++) {
        double value[LAR_NODE_VALUES];
        lar_checkpoint_get(checkpoint->rows, (size_t)whole->model->mesh.node_count, (size_t)g,
                           value);
        lar_state_write(state, whole->layout.local[g], value);
    }
    lar_viscous_scatter(whole, state, checkpoint->history);
    state->step = checkpoint->step;
    state->part = 0;
    state->parts = 1;
    state->listed = false;
    state->external = checkpoint->external;
    state->damped = checkpoint->damped;
    state->contact = checkpoint->contact;
    state->exchanged = checkpoint->exchanged;
    *tools = checkpoint->tools;
}
