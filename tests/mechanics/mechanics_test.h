/* What the tests of the mechanics share: random input that is the same on every machine, shapes
 * of elements, small dense algebra, and the reference solutions of other programs.
 *
 * Bounds are always relative to what the quantity is made of (a modulus times an area for a
 * force), never to the quantity itself, which may be zero.
 */
#ifndef LAR_TESTS_MECHANICS_TEST_H
#define LAR_TESTS_MECHANICS_TEST_H

#include "law/every_term.h"
#include "law/lane_math.h"
#include "mechanics/stress.h"
#include "model/mesh/mesh.h"
#include "testing.h"

typedef const double (*rows)[3]; /* what functions that take const double [][3] get */

/* ---- random numbers (xorshift64*) --------------------------------------------------------- */

TEST_UNUSED static uint64_t random_bits(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * 0x2545f4914f6cdd1dULL;
}

/* Uniform in [-1, 1). */
TEST_UNUSED static double random_value(uint64_t *state) {
    return (double)(int64_t)random_bits(state) * 0x1p-63;
}

TEST_UNUSED static void random_fill(uint64_t *state, double size, double *values, int count) {
    for (int i = 0; i < count; i++) values[i] = size * random_value(state);
}

/* ---- 3x3 matrices ------------------------------------------------------------------------- */

TEST_UNUSED static void multiply(const double A[3][3], const double B[3][3], double C[3][3]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            C[i][j] = A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j];
}

/* Rotation by `angle` about any axis (Rodrigues). */
TEST_UNUSED static void rotation(const double axis[3], double angle, double R[3][3]) {
    double n = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    double x = axis[0] / n, y = axis[1] / n, z = axis[2] / n, s = sin(angle), c = 1 - cos(angle);
    const double W[3][3] = {{0, -z, y}, {z, 0, -x}, {-y, x, 0}};
    double W2[3][3];
    multiply(W, W, W2);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) R[i][j] = (i == j) + s * W[i][j] + c * W2[i][j];
}

TEST_UNUSED static void random_rotation(uint64_t *state, double R[3][3]) {
    double axis[3];
    random_fill(state, 1, axis, 3);
    rotation(axis, 3.14159 * random_value(state), R);
}

TEST_UNUSED static double determinant(const double F[3][3]) {
    double cof[9];
    return lar_lane_cofactor(&F[0][0], cof);
}

/* F = I + size * random with det F > 0.2. */
TEST_UNUSED static void random_deformation(uint64_t *state, double size, double F[3][3]) {
    do {
        random_fill(state, size, &F[0][0], 9);
        for (int i = 0; i < 3; i++) F[i][i] += 1;
    } while (!(determinant((rows)F) > 0.2));
}

TEST_UNUSED static double largest(const double *values, int count) {
    double max = 0;
    for (int i = 0; i < count; i++)
        if (!(fabs(values[i]) <= max)) max = fabs(values[i]);
    return max;
}

TEST_UNUSED static double largest_difference(const double *a, const double *b, int count) {
    double max = 0;
    for (int i = 0; i < count; i++)
        if (!(fabs(a[i] - b[i]) <= max)) max = fabs(a[i] - b[i]);
    return max;
}

/* ---- materials and shapes ------------------------------------------------------------------ */

/* Each law once, soft and nearly incompressible, with every constant at work. */
TEST_UNUSED static lar_material test_material(int law, double shear, double bulk) {
    lar_material material = {.law = (lar_law)law, .density = 1050};
    lar_material_from_shear_bulk(&material, shear, bulk);
    every_term(&material, 0.3);
    return material;
}

/* K + 4 G / 3, the modulus of a compressed layer. */
TEST_UNUSED static double layer_modulus(const lar_material *material) {
    return lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
}

TEST_UNUSED static void box_corners(double lx, double ly, double lz, double corner[8][3]) {
    const double half[3] = {lx / 2, ly / 2, lz / 2};
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) corner[a][i] = lar_node_sign[a][i] * half[i];
}

/* A cube of that size, every corner moved by up to `distortion` sizes along each axis, then
 * turned; 0.2 is strong, and such hexahedra stay valid. */
TEST_UNUSED static void random_corners(uint64_t *state, double size, double distortion,
                                       double corner[8][3]) {
    double R[3][3], shape[8][3];
    box_corners(size, size, size, shape);
    random_rotation(state, R);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++) shape[a][i] += size * distortion * random_value(state);
    for (int a = 0; a < 8; a++)
        for (int i = 0; i < 3; i++)
            corner[a][i] = R[i][0] * shape[a][0] + R[i][1] * shape[a][1] + R[i][2] * shape[a][2];
}

/* Displacements u = (F - I) x + shift of n points. */
TEST_UNUSED static void affine(const double F[3][3], const double shift[3], int n, rows x,
                               double (*u)[3]) {
    for (int a = 0; a < n; a++)
        for (int i = 0; i < 3; i++) {
            u[a][i] = shift[i] - x[a][i];
            for (int j = 0; j < 3; j++) u[a][i] += F[i][j] * x[a][j];
        }
}

/* ---- dense symmetric eigenvalues (Jacobi) --------------------------------------------------- */

/* Largest eigenvalue of the symmetric n x n matrix A, which is destroyed. */
TEST_UNUSED static double jacobi_largest(double *A, int n) {
    for (int sweep = 0; sweep < 30; sweep++) {
        double off = 0, diagonal = 0;
        for (int p = 0; p < n; p++)
            for (int q = 0; q < n; q++) *(p == q ? &diagonal : &off) += A[p * n + q] * A[p * n + q];
        if (off <= 1e-26 * diagonal) break;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) {
                if (A[p * n + q] == 0) continue;
                double theta = (A[q * n + q] - A[p * n + p]) / (2 * A[p * n + q]);
                double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
                double c = 1 / sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < n; k++) {
                    double kp = A[k * n + p], kq = A[k * n + q];
                    A[k * n + p] = c * kp - s * kq;
                    A[k * n + q] = s * kp + c * kq;
                }
                for (int k = 0; k < n; k++) {
                    double pk = A[p * n + k], qk = A[q * n + k];
                    A[p * n + k] = c * pk - s * qk;
                    A[q * n + k] = s * pk + c * qk;
                }
            }
    }
    double max = A[0];
    for (int p = 1; p < n; p++) max = fmax(max, A[p * n + p]);
    return max;
}

/* ---- two elements that share a face ---------------------------------------------------------- */

enum { PAIR_NODES = 12, PAIR_FREEDOMS = 36 };
static const int pair_node[2][8] = {{0, 1, 2, 3, 4, 5, 6, 7}, {1, 8, 9, 2, 5, 10, 11, 6}};

/* A distorted pair of cubes of that size: position [12][3]. */
TEST_UNUSED static void random_pair(uint64_t *state, double size, double distortion,
                                    double position[PAIR_NODES][3]) {
    double cube[8][3];
    box_corners(size, size, size, cube);
    for (int e = 0; e < 2; e++)
        for (int a = 0; a < 8; a++) {
            double *x = position[pair_node[e][a]];
            memcpy(x, cube[a], sizeof cube[a]);
            x[0] += e * size;
        }
    for (int n = 0; n < PAIR_NODES; n++)
        for (int i = 0; i < 3; i++) position[n][i] += size * distortion * random_value(state);
}

TEST_UNUSED static void pair_corners(rows position, int e, double corner[8][3]) {
    for (int a = 0; a < 8; a++) memcpy(corner[a], position[pair_node[e][a]], sizeof corner[a]);
}

/* ---- reference solutions -----------------------------------------------------------------------
 */

TEST_UNUSED static FILE *open_reference(const char *name) {
    char path[512];
    snprintf(path, sizeof path, "%s/reference/%s", LAR_TEST_SHARED, name);
    FILE *file = fopen(path, "r");
    if (!file) print_message("skipped: no shared data\n");
    return file;
}

/* A mesh of n <= 1200 nodes with the displacements and reactions that another program found. */
typedef struct reference {
    int nodes, elements;
    double x[1200][3], u[1200][3], reaction[1200][3];
    int element[1200][8];
} reference;

/* Fills *r; false (after a message) where the shared data is missing. */
TEST_UNUSED static bool read_reference(const char *mesh, const char *field, reference *r) {
    char line[512], path[256];
    int id;
    memset(r, 0, sizeof *r);
    snprintf(path, sizeof path, "meshes/%s.txt", mesh);
    FILE *file = open_reference(path);
    if (!file) return false;
    while (fgets(line, sizeof line, file)) {
        double x[3];
        int n[8];
        if (sscanf(line, "n %d %lf %lf %lf", &id, &x[0], &x[1], &x[2]) == 4) {
            assert_in_range(id, 1, 1200);
            memcpy(r->x[id - 1], x, sizeof x);
            r->nodes = id > r->nodes ? id : r->nodes;
        } else if (sscanf(line, "e %d %d %d %d %d %d %d %d %d", &id, n, n + 1, n + 2, n + 3, n + 4,
                          n + 5, n + 6, n + 7) == 9) {
            assert_in_range(id, 1, 1200);
            for (int a = 0; a < 8; a++) {
                assert_in_range(n[a], 1, 1200);
                r->element[id - 1][a] = n[a] - 1;
            }
            r->elements = id > r->elements ? id : r->elements;
        }
    }
    fclose(file);
    snprintf(path, sizeof path, "fields/%s.txt", field);
    if (!(file = open_reference(path))) return false;
    while (fgets(line, sizeof line, file)) {
        double v[6];
        if (sscanf(line, "%d %lf %lf %lf %lf %lf %lf", &id, v, v + 1, v + 2, v + 3, v + 4, v + 5) !=
            7)
            continue;
        assert_in_range(id, 1, 1200);
        memcpy(r->u[id - 1], v, 3 * sizeof *v);
        memcpy(r->reaction[id - 1], v + 3, 3 * sizeof *v);
    }
    fclose(file);
    return true;
}

#endif
