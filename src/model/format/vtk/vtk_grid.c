#include "model/format/vtk/vtk_grid.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

const char *const lar_vtk_set_prefix[3] = {
    [LAR_SET_NODES] = "set:nodes:",
    [LAR_SET_ELEMENTS] = "set:elements:",
    [LAR_SET_FACES] = "set:faces:",
};

static const char mask_prefix[] = "set_";

/* In order of preference. */
static const char *const tag_names[] = {"tag",           "material",      "region",        "label",
                                        "CellEntityIds", "gmsh:physical", "PhysicalGroup", "part"};
enum { TAG_NAME_COUNT = sizeof tag_names / sizeof *tag_names };

enum { VOXEL = 11, LAGRANGE_TETRAHEDRON = 71, FACES = 6 };

/* What a cell type is called, its dimension, and of solids how many corners they have, which come
 * first, and how many points at least. Types not listed are solids for our purpose: refused, with
 * their number, as those without corners are. */
typedef struct cell_kind {
    int type, dimension;
    const char *name;
    int corners, points;
} cell_kind;

static const cell_kind cell_kinds[] = {
    {0, 0, "empty cell", 0, 0},
    {1, 0, "vertex", 0, 0},
    {2, 0, "poly-vertex", 0, 0},
    {3, 1, "line", 0, 0},
    {4, 1, "poly-line", 0, 0},
    {5, 2, "triangle", 0, 0},
    {6, 2, "triangle strip", 0, 0},
    {7, 2, "polygon", 0, 0},
    {8, 2, "pixel", 0, 0},
    {9, 2, "quad", 0, 0},
    {21, 1, "quadratic edge", 0, 0},
    {22, 2, "quadratic triangle", 0, 0},
    {23, 2, "quadratic quad", 0, 0},
    {28, 2, "biquadratic quad", 0, 0},
    {30, 2, "quadratic linear quad", 0, 0},
    {34, 2, "biquadratic triangle", 0, 0},
    {35, 1, "cubic line", 0, 0},
    {36, 2, "quadratic polygon", 0, 0},
    {12, 3, "hexahedron", 8, 8},
    {11, 3, "voxel", 8, 8},
    {10, 3, "tetrahedron", 4, 4},
    {13, 3, "wedge", 6, 6},
    {14, 3, "pyramid", 5, 5},
    {15, 3, "pentagonal prism", 0, 0},
    {16, 3, "hexagonal prism", 0, 0},
    {24, 3, "quadratic tetrahedron", 4, 10},
    {25, 3, "20-node hexahedron", 0, 0},
    {26, 3, "quadratic wedge", 6, 15},
    {27, 3, "quadratic pyramid", 5, 13},
    {29, 3, "27-node hexahedron", 0, 0},
    {33, 3, "24-node hexahedron", 0, 0},
    {42, 3, "polyhedron", 0, 0},
    {68, 1, "Lagrange curve", 0, 0},
    {69, 2, "Lagrange triangle", 0, 0},
    {70, 2, "Lagrange quad", 0, 0},
    {71, 3, "Lagrange tetrahedron", 4, 4},
    {72, 3, "Lagrange hexahedron", 0, 0},
};

static const cell_kind *kind_of(int64_t type) {
    static const cell_kind UNKNOWN = {-1, 3, "cell of an unknown kind", 0, 0};
    for (size_t i = 0; i < sizeof cell_kinds / sizeof *cell_kinds; i++)
        if (cell_kinds[i].type == type) return &cell_kinds[i];
    return &UNKNOWN;
}

void lar_vtk_cells_clear(lar_vtk_cells *cells) {
    free(cells->end);
    free(cells->corner);
    *cells = (lar_vtk_cells){0};
}

void lar_vtk_grid_set_cells(lar_vtk_grid *grid, lar_vtk_cells *cells) {
    grid->cell_count = cells->count;
    grid->cell_end = cells->end;
    grid->corner_count = cells->corner_count;
    grid->corner = cells->corner;
    *cells = (lar_vtk_cells){0};
}

void lar_vtk_grid_clear(lar_vtk_grid *grid) {
    free(grid->point);
    free(grid->cell_end);
    free(grid->cell_type);
    free(grid->corner);
    for (int family = 0; family < 2; family++) free(grid->fibre[family]);
    for (size_t i = 0; i < grid->array_count; i++) {
        free(grid->array[i].name);
        free(grid->array[i].value);
    }
    free(grid->array);
    *grid = (lar_vtk_grid){0};
}

static bool begins_with(const char *text, const char *prefix) {
    return strncmp(text, prefix, strlen(prefix)) == 0;
}

bool lar_vtk_wants(lar_vtk_place place, const char *name) {
    if (place == LAR_VTK_FIELD_DATA) {
        for (int kind = 0; kind < 3; kind++)
            if (begins_with(name, lar_vtk_set_prefix[kind])) return true;
        return false;
    }
    if (place == LAR_VTK_CELL_DATA)
        for (int i = 0; i < TAG_NAME_COUNT; i++)
            if (strcmp(name, tag_names[i]) == 0) return true;
    return begins_with(name, mask_prefix) && name[strlen(mask_prefix)] != '\0';
}

int lar_vtk_family(lar_vtk_place place, const char *name) {
    static const char *const names[] = {"fibre", "fiber", "fibre2", "fiber2"};
    for (int i = 0; i < 4 && place == LAR_VTK_CELL_DATA; i++)
        if (strcmp(name, names[i]) == 0) return i / 2;
    return -1;
}

lar_status lar_vtk_grid_add(lar_vtk_grid *grid, lar_vtk_place place, const char *name,
                            int64_t *value, int64_t count, lar_error *error) {
    char *copy = lar_strdup(name);
    if (!copy || !LAR_GROW(grid->array, grid->array_capacity, grid->array_count)) {
        free(copy);
        free(value);
        return lar_fail_memory(error, strlen(name), "a name");
    }
    grid->array[grid->array_count++] = (lar_vtk_integers){copy, place, count, value};
    return LAR_OK;
}

static bool is_plain(unsigned char c) {
    return c > ' ' && c != '%' && c != '"' && c != '<' && c != '>' && c != '&' && c < 0x7f;
}

char *lar_vtk_encode_name(const char *prefix, const char *name) {
    static const char digit[] = "0123456789ABCDEF";
    size_t start = strlen(prefix);
    char *out = malloc(start + 3 * strlen(name) + 1);
    if (!out) return NULL;
    memcpy(out, prefix, start);
    char *to = out + start;
    for (const char *from = name; *from; from++) {
        unsigned char c = (unsigned char)*from;
        if (is_plain(c)) {
            *to++ = *from;
        } else {
            *to++ = '%';
            *to++ = digit[c >> 4];
            *to++ = digit[c & 15];
        }
    }
    *to = '\0';
    return out;
}

static int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
}

char *lar_vtk_decode_name(const char *name, size_t length) {
    char *out = lar_strndup(name, length);
    if (!out) return NULL;
    char *to = out;
    for (size_t i = 0; i < length; i++) {
        int high = i + 2 < length && name[i] == '%' ? hex_digit(name[i + 1]) : -1;
        int low = high >= 0 ? hex_digit(name[i + 2]) : -1;
        if (low >= 0 && high * 16 + low != 0) {
            *to++ = (char)(high * 16 + low);
            i += 2;
        } else {
            *to++ = name[i];
        }
    }
    *to = '\0';
    return out;
}

static lar_status refuse_cell(const char *path, int64_t cell, int64_t type, lar_error *error) {
    const char *remedy = type == 25 || type == 29 || type == 33 || type == 72
                             ? "save the mesh with first-order (eight-node) elements"
                             : "mesh the body with hexahedra, or remove these cells";
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "%s: cell %" PRId64 " is a %s (VTK cell type %" PRId64
                    "); Lariat computes with eight-node hexahedra; %s",
                    path, cell, kind_of(type)->name, type, remedy);
}

/* Checks the cells one by one and counts the solids. */
static lar_status count_solids(const char *path, const lar_vtk_grid *grid, int32_t *count,
                               lar_error *error) {
    int64_t start = 0;
    *count = 0;
    for (int64_t cell = 0; cell < grid->cell_count; cell++) {
        int64_t end = grid->cell_end[cell], type = grid->cell_type[cell];
        if (end < start || end > grid->corner_count)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the offset of cell %" PRId64 " is %" PRId64
                            ", but offsets must ascend from %" PRId64 " to at most %" PRId64
                            ", the length of the connectivity; write the file again",
                            path, cell, end, start, grid->corner_count);
        const cell_kind *kind = kind_of(type);
        if (kind->corners > 0) {
            bool exact = kind->points == kind->corners && type != LAGRANGE_TETRAHEDRON;
            if (end - start < kind->points || (exact && end - start > kind->points))
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "%s: %s %" PRId64 " has %" PRId64
                                " corners instead of %d; write the file again",
                                path, kind->name, cell, end - start, kind->points);
            ++*count;
        } else if (kind->dimension == 3) {
            return refuse_cell(path, cell, type, error);
        }
        start = end;
    }
    if (*count > 0) return LAR_OK;
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s: there are no hexahedra among its %" PRId64
                    " cells; Lariat computes with eight-node hexahedra; save the volume mesh, not "
                    "its surface",
                    path, grid->cell_count);
}

/* Elements with the file's point indices; element_of[cell] is the element or -1. */
static lar_status fill_elements(const char *path, const lar_vtk_grid *grid, lar_mesh *mesh,
                                int32_t *element_of, lar_error *error) {
    static const uint8_t voxel_order[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    static const uint8_t own_order[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    int32_t e = 0;
    int64_t start = 0;
    for (int64_t cell = 0; cell < grid->cell_count; start = grid->cell_end[cell++]) {
        const cell_kind *kind = kind_of(grid->cell_type[cell]);
        element_of[cell] = -1;
        if (kind->corners == 0) continue;
        const uint8_t *order = kind->type == VOXEL  ? voxel_order
                               : kind->corners == 8 ? own_order
                                                    : lar_solid_corners(kind->corners);
        if (kind->corners < 8 && mesh->collapsed_count++ == 0) {
            mesh->collapsed_name = kind->name;
            mesh->collapsed_id = cell;
        }
        for (int a = 0; a < 8; a++) {
            int64_t point = grid->corner[start + order[a]];
            if (point < 0 || point >= grid->point_count)
                return lar_fail(error, LAR_ERROR_FORMAT,
                                "%s: cell %" PRId64 " names point %" PRId64
                                ", but there are %" PRId64
                                " points, counted from 0; write the file again",
                                path, cell, point, grid->point_count);
            mesh->element[e][a] = (int32_t)point;
        }
        mesh->element_id[e] = cell;
        element_of[cell] = e++;
    }
    return LAR_OK;
}

/* Drops points that no element uses; node_of[point] is the node or -1. */
static void compact_nodes(lar_vtk_grid *grid, lar_mesh *mesh, int32_t *node_of) {
    for (int64_t point = 0; point < grid->point_count; point++) node_of[point] = -1;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) node_of[mesh->element[e][a]] = 0;
    mesh->position = grid->point;
    grid->point = NULL;
    int32_t node = 0;
    for (int64_t point = 0; point < grid->point_count; point++) {
        if (node_of[point] < 0) continue;
        if (node != point)
            memcpy(mesh->position[node], mesh->position[point], sizeof *mesh->position);
        mesh->node_id[node] = point;
        node_of[point] = node++;
    }
    mesh->node_count = node;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int a = 0; a < 8; a++) mesh->element[e][a] = node_of[mesh->element[e][a]];
}

const lar_vtk_integers *lar_vtk_grid_tags(const lar_vtk_grid *grid) {
    for (int i = 0; i < TAG_NAME_COUNT; i++)
        for (size_t k = 0; k < grid->array_count; k++)
            if (grid->array[k].place == LAR_VTK_CELL_DATA &&
                strcmp(grid->array[k].name, tag_names[i]) == 0)
                return &grid->array[k];
    return NULL;
}

static lar_status fill_tags(const char *path, const lar_vtk_grid *grid, lar_mesh *mesh,
                            lar_error *error) {
    const lar_vtk_integers *tag = lar_vtk_grid_tags(grid);
    if (!tag) return LAR_OK;
    for (int32_t e = 0; e < mesh->element_count; e++) {
        int64_t value = tag->value[mesh->element_id[e]];
        if (value < INT32_MIN || value > INT32_MAX)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the tag of cell %" PRId64 " in \"%s\" is %" PRId64
                            ", which does not fit 32 bits; number the regions with small integers",
                            path, mesh->element_id[e], tag->name, value);
        mesh->element_tag[e] = (int32_t)value;
    }
    return LAR_OK;
}

static lar_status fill_fibres(const char *path, const double *value, const lar_mesh *mesh,
                              double (**fibre)[3], lar_error *error) {
    if (!value) return LAR_OK;
    *fibre = lar_calloc((size_t)mesh->element_count, sizeof **fibre);
    if (!*fibre) return lar_fail_memory(error, (size_t)mesh->element_count * sizeof **fibre, path);
    for (int32_t e = 0; e < mesh->element_count; e++)
        memcpy((*fibre)[e], value + 3 * mesh->element_id[e], sizeof **fibre);
    return LAR_OK;
}

typedef struct index_maps {
    int64_t point_count, cell_count;
    const int32_t *node_of;    /* by point */
    const int32_t *element_of; /* by cell */
} index_maps;

/* "set_NAME" arrays of zeros and ones. Other values: some other quantity, left alone. */
static lar_status add_mask(const lar_vtk_integers *array, const index_maps *maps, lar_mesh *mesh,
                           lar_error *error) {
    const int32_t *map = array->place == LAR_VTK_POINT_DATA ? maps->node_of : maps->element_of;
    int64_t members = 0;
    for (int64_t i = 0; i < array->count; i++) {
        if (array->value[i] != 0 && array->value[i] != 1) return LAR_OK;
        if (array->value[i] == 1 && map[i] >= 0) members++;
    }
    int32_t *index = lar_calloc((size_t)members, sizeof *index);
    if (!index) return lar_fail_memory(error, (size_t)members * sizeof *index, array->name);
    int32_t filled = 0;
    for (int64_t i = 0; i < array->count; i++)
        if (array->value[i] == 1 && map[i] >= 0) index[filled++] = map[i];
    lar_set_kind kind = array->place == LAR_VTK_POINT_DATA ? LAR_SET_NODES : LAR_SET_ELEMENTS;
    return lar_mesh_add_set(mesh, array->name + strlen(mask_prefix), kind, index, filled, error);
}

/* The index in the mesh of one entry of a set array, -1 for a point that was dropped, -2 for
 * what is not there. */
static int32_t map_entry(lar_set_kind kind, int64_t value, const index_maps *maps) {
    enum { DROPPED = -1, ABSENT = -2 };
    if (value < 0) return ABSENT;
    if (kind == LAR_SET_NODES) return value < maps->point_count ? maps->node_of[value] : ABSENT;
    int64_t cell = kind == LAR_SET_FACES ? value / FACES : value;
    if (cell >= maps->cell_count) return ABSENT;
    int32_t e = maps->element_of[cell];
    if (e < 0) return kind == LAR_SET_ELEMENTS ? DROPPED : ABSENT;
    return kind == LAR_SET_FACES ? e * FACES + (int32_t)(value % FACES) : e;
}

static lar_status add_field_set(const char *path, const lar_vtk_integers *array,
                                const index_maps *maps, lar_mesh *mesh, lar_error *error) {
    lar_set_kind kind = LAR_SET_NODES;
    while (!begins_with(array->name, lar_vtk_set_prefix[kind])) kind++;
    const char *rest = array->name + strlen(lar_vtk_set_prefix[kind]);
    int32_t *index = lar_calloc((size_t)array->count, sizeof *index);
    if (!index) return lar_fail_memory(error, (size_t)array->count * sizeof *index, array->name);
    int32_t filled = 0;
    for (int64_t i = 0; i < array->count; i++) {
        int32_t mapped = map_entry(kind, array->value[i], maps);
        if (mapped < -1) {
            free(index);
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: entry %" PRId64 " of the field array \"%s\" is %" PRId64
                            ", which the file does not have; correct or remove the array",
                            path, i, array->name, array->value[i]);
        }
        if (mapped >= 0) index[filled++] = mapped;
    }
    char *name = lar_vtk_decode_name(rest, strlen(rest));
    if (!name) {
        free(index);
        return lar_fail_memory(error, strlen(rest), "a set name");
    }
    lar_status status = lar_mesh_add_set(mesh, name, kind, index, filled, error);
    free(name);
    return status;
}

static lar_status fill_sets(const char *path, const lar_vtk_grid *grid, const index_maps *maps,
                            lar_mesh *mesh, lar_error *error) {
    for (size_t k = 0; k < grid->array_count; k++) {
        const lar_vtk_integers *array = &grid->array[k];
        lar_status status = LAR_OK;
        if (array->place == LAR_VTK_FIELD_DATA)
            status = add_field_set(path, array, maps, mesh, error);
        else if (begins_with(array->name, mask_prefix))
            status = add_mask(array, maps, mesh, error);
        if (status) return status;
    }
    return LAR_OK;
}

static lar_status check_counts(const char *path, const lar_vtk_grid *grid, lar_error *error) {
    if (grid->point_count > INT32_MAX || grid->cell_count > INT32_MAX / FACES)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "%s: %" PRId64 " points and %" PRId64
                        " cells are more than the 32-bit indices of Lariat can name; divide the "
                        "model",
                        path, grid->point_count, grid->cell_count);
    for (size_t k = 0; k < grid->array_count; k++) {
        const lar_vtk_integers *array = &grid->array[k];
        int64_t wanted = array->place == LAR_VTK_POINT_DATA  ? grid->point_count
                         : array->place == LAR_VTK_CELL_DATA ? grid->cell_count
                                                             : array->count;
        if (array->count != wanted || array->count > INT32_MAX)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "%s: the array \"%s\" has %" PRId64 " values where %" PRId64
                            " belong; write the file again",
                            path, array->name, array->count, wanted);
    }
    return LAR_OK;
}

lar_status lar_vtk_grid_to_mesh(const char *path, lar_vtk_grid *grid, lar_mesh *mesh,
                                lar_error *error) {
    int32_t solids = 0;
    lar_status status = check_counts(path, grid, error);
    if (!status) status = count_solids(path, grid, &solids, error);
    if (status) return status;

    size_t elements = (size_t)solids, points = (size_t)grid->point_count;
    int32_t *node_of = lar_calloc(points, sizeof *node_of);
    int32_t *element_of = lar_calloc((size_t)grid->cell_count, sizeof *element_of);
    mesh->source = lar_strdup(path);
    mesh->node_id = lar_calloc(points, sizeof *mesh->node_id);
    mesh->element = lar_calloc(elements, sizeof *mesh->element);
    mesh->element_id = lar_calloc(elements, sizeof *mesh->element_id);
    mesh->element_tag = lar_calloc(elements, sizeof *mesh->element_tag);
    mesh->element_count = solids;
    if (!node_of || !element_of || !mesh->source || !mesh->node_id || !mesh->element ||
        !mesh->element_id || !mesh->element_tag)
        status = lar_fail_memory(error, elements * sizeof *mesh->element, path);

    if (!status) status = fill_elements(path, grid, mesh, element_of, error);
    if (!status) {
        compact_nodes(grid, mesh, node_of);
        status = fill_tags(path, grid, mesh, error);
    }
    if (!status) status = fill_fibres(path, grid->fibre[0], mesh, &mesh->fibre, error);
    if (!status) status = fill_fibres(path, grid->fibre[1], mesh, &mesh->second, error);
    const index_maps maps = {grid->point_count, grid->cell_count, node_of, element_of};
    if (!status) status = fill_sets(path, grid, &maps, mesh, error);
    free(node_of);
    free(element_of);
    return status;
}
