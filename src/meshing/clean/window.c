#include "meshing/clean/clean.h"

/* What the sum of clean.h adds up; a cell's volume is 255. Where squashed cells cost nothing the
 * thinnest fitted element is thinner (0.30 cells instead of 0.33, mean of 12 bodies of 1,000 to
 * 2,000 elements), and the stable time step as much shorter; more than this gains nothing. */
static const int32_t UNCLEAN_BODY = 100000, UNCLEAN_REGION = 1200, BUMP = 160, DENT = 100,
                     FACE = 10;

enum { MIDDLE = 2, SIDE = 5 };

/* The window as one row of cells: steps along i, j, k. */
static const int STEP[3] = {1, SIDE, SIDE *SIDE};

static const uint8_t *cells_of(const lar_clean_window *window) {
    return &window->label[0][0][0];
}

void lar_clean_look(const lar_voxel_grid *voxel_grid, const int at[3], lar_clean_window *window) {
    for (int k = 0; k < SIDE; k++)
        for (int j = 0; j < SIDE; j++)
            for (int i = 0; i < SIDE; i++) {
                const int x = at[0] + i - MIDDLE, y = at[1] + j - MIDDLE, z = at[2] + k - MIDDLE;
                const bool there = x >= 0 && x < voxel_grid->cells[0] && y >= 0 &&
                                   y < voxel_grid->cells[1] && z >= 0 && z < voxel_grid->cells[2];
                window->label[k][j][i] =
                    there ? voxel_grid->region[lar_voxel_grid_cell(voxel_grid, x, y, z)] : 0;
            }
}

/* Whether the cells of a block that are in `set` hang together by faces. */
static bool hangs_together(unsigned set) {
    unsigned reached = set & (0u - set), before = 0;
    while (reached != before) {
        unsigned grown = reached | (reached & 0x55) << 1 | (reached & 0xaa) >> 1;
        grown |= (reached & 0x33) << 2 | (reached & 0xcc) >> 2;
        grown |= (reached & 0x0f) << 4 | (reached & 0xf0) >> 4;
        before = reached;
        reached = grown & set;
    }
    return reached == set;
}

bool lar_clean_block(unsigned inside) {
    return hangs_together(inside & 0xff) && hangs_together(~inside & 0xff);
}

/* A point of the grid: the block of cells whose lowest one is `low`. */
static int32_t point_cost(const uint8_t *low, int *unclean) {
    uint8_t label[8];
    unsigned inside = 0;
    bool one = true;
    for (int c = 0; c < 8; c++) {
        label[c] = low[(c & 1) * STEP[0] + (c >> 1 & 1) * STEP[1] + (c >> 2) * STEP[2]];
        if (label[c] != 0) inside |= 1u << c;
        one = one && label[c] == label[0];
    }
    if (one) return 0;
    int32_t cost = 0;
    if (!lar_clean_block(inside)) {
        (*unclean)++;
        cost += UNCLEAN_BODY;
    }
    unsigned seen = ~inside & 0xff;
    for (int c = 0; c < 8; c++) {
        if (seen >> c & 1) continue;
        unsigned region = 0;
        for (int o = c; o < 8; o++) region |= (unsigned)(label[o] == label[c]) << o;
        seen |= region;
        if (region != inside && !lar_clean_block(region)) cost += UNCLEAN_REGION;
    }
    return cost;
}

static bool is_thin(const uint8_t *cell, int axis) {
    return cell[STEP[axis]] != *cell && cell[-STEP[axis]] != *cell;
}

/* Two by two cells across `axis` that are all thin along it. */
static bool is_in_sheet(const uint8_t *cell, int axis) {
    const int u = STEP[(axis + 1) % 3], v = STEP[(axis + 2) % 3];
    for (int corner = 0; corner < 4; corner++) {
        const int a = corner & 1 ? u : -u, b = corner & 2 ? v : -v;
        const uint8_t *const other[3] = {cell + a, cell + b, cell + a + b};
        bool sheet = true;
        for (int o = 0; o < 3; o++) sheet = sheet && *other[o] == *cell && is_thin(other[o], axis);
        if (sheet) return true;
    }
    return false;
}

/* A neighbour along `axis` that is thin in both other directions. */
static bool is_in_bar(const uint8_t *cell, int axis) {
    for (int sign = -1; sign < 2; sign += 2) {
        const uint8_t *other = cell + sign * STEP[axis];
        if (*other == *cell && is_thin(other, (axis + 1) % 3) && is_thin(other, (axis + 2) % 3))
            return true;
    }
    return false;
}

static bool is_squashed(const uint8_t *cell) {
    bool thin[3];
    for (int axis = 0; axis < 3; axis++) thin[axis] = is_thin(cell, axis);
    const int count = thin[0] + thin[1] + thin[2];
    if (count == 0) return false;
    if (count == 3) return true;
    if (count == 2) return !is_in_bar(cell, !thin[0] ? 0 : !thin[1] ? 1 : 2);
    return !is_in_sheet(cell, thin[0] ? 0 : thin[1] ? 1 : 2);
}

static int32_t squash_cost(const uint8_t *cell) {
    if (!is_squashed(cell)) return 0;
    return *cell != 0 ? BUMP : DENT;
}

int32_t lar_clean_cost(const lar_clean_window *window, int *unclean) {
    const uint8_t *middle = cells_of(window) + MIDDLE * (STEP[0] + STEP[1] + STEP[2]);
    int32_t cost = 0;
    *unclean = 0;
    for (int p = 0; p < 8; p++)
        cost += point_cost(middle - (p & 1) * STEP[0] - (p >> 1 & 1) * STEP[1] - (p >> 2) * STEP[2],
                           unclean);
    for (int k = -1; k <= 1; k++)
        for (int j = -1; j <= 1; j++)
            for (int i = -1; i <= 1; i++)
                cost += squash_cost(middle + i * STEP[0] + j * STEP[1] + k * STEP[2]);
    for (int axis = 0; axis < 3; axis++)
        cost += FACE * ((middle[STEP[axis]] != *middle) + (middle[-STEP[axis]] != *middle));
    return cost;
}

/* Cells of the 3 x 3 x 3 block around the middle, as bits; whether they touch the middle by a face
 * or lie within its 18 neighbours. */
enum { BLOCK = 27, CENTRE = 13 };

static int coordinate(int cell, int axis) {
    return (axis == 0 ? cell : axis == 1 ? cell / 3 : cell / 9) % 3 - 1;
}

static int distance(int a, int b, bool largest) {
    int sum = 0, max = 0;
    for (int axis = 0; axis < 3; axis++) {
        const int d = coordinate(a, axis) - coordinate(b, axis), size = d < 0 ? -d : d;
        sum += size;
        max = size > max ? size : max;
    }
    return largest ? max : sum;
}

/* Pieces of a set of cells that have a cell next to the middle one, where cells are next to each
 * other by faces, or by faces, edges and corners. */
static int pieces_at_middle(uint32_t set, bool corners) {
    int pieces = 0;
    while (set != 0) {
        uint32_t piece = set & (0u - set), before = 0;
        while (piece != before) {
            before = piece;
            for (int a = 0; a < BLOCK; a++) {
                if (!(piece >> a & 1)) continue;
                for (int b = 0; b < BLOCK; b++)
                    if ((set >> b & 1) && distance(a, b, corners) == 1) piece |= 1u << b;
            }
        }
        bool touches = false;
        for (int a = 0; a < BLOCK; a++)
            touches = touches || ((piece >> a & 1) && distance(a, CENTRE, corners) == 1);
        pieces += touches;
        set &= ~piece;
    }
    return pieces;
}

/* Bertrand and Malandain (1994): a cell is simple when its 26 neighbours inside form one piece, and
 * its 18 neighbours outside form one piece by faces that touches it. */
static bool is_simple(uint32_t inside) {
    uint32_t outside = 0;
    for (int a = 0; a < BLOCK; a++)
        if (a != CENTRE && !(inside >> a & 1) && distance(a, CENTRE, false) <= 2)
            outside |= 1u << a;
    return pieces_at_middle(inside & ~(1u << CENTRE), true) == 1 &&
           pieces_at_middle(outside, false) == 1;
}

bool lar_clean_is_simple(const lar_clean_window *window, uint8_t label) {
    const uint8_t old = window->label[MIDDLE][MIDDLE][MIDDLE];
    uint32_t body = 0, left = 0, entered = 0;
    for (int a = 0; a < BLOCK; a++) {
        const uint8_t at = window->label[MIDDLE + coordinate(a, 2)][MIDDLE + coordinate(a, 1)]
                                        [MIDDLE + coordinate(a, 0)];
        if (at != 0) body |= 1u << a;
        if (at == old) left |= 1u << a;
        if (at == label) entered |= 1u << a;
    }
    if ((old == 0 || label == 0) && !is_simple(body)) return false;
    if (old != 0 && left != body && !is_simple(left)) return false;
    return label == 0 || entered == body || is_simple(entered);
}
