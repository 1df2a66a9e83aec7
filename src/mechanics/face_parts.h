/* The four triangles of a face (face_contact.h) seen from a point or a segment, all of them, and
 * the points of a face's grid.
 *
 * One after the other, or beside each other in four lanes where the processor has them (AVX2): the
 * same operations in the same order, and so the same bits.
 */
#ifndef LAR_MECHANICS_FACE_PARTS_H
#define LAR_MECHANICS_FACE_PARTS_H

#include <stdbool.h>

#include "mechanics/face_contact.h"

/* Of triangle t, with corners t, t + 1 and the middle: */
typedef struct lar_face_parts {
    double weight[4][4]; /* [t]: of the face's corners in its closest point */
    double distance[4];  /* of that point [m] */
    double height[4];    /* over its plane there [m]; 0 where it has no area */
} lar_face_parts;

/* Where there are lanes hardly any processor does without: small rather than fast. */
#if defined(LAR_HAVE_FACE_LANES)
#define LAR_ONE_BY_ONE __attribute__((cold))
#else
#define LAR_ONE_BY_ONE
#endif

/* `x`: the point [m]; `middle`: the mean of the corners. */
LAR_ONE_BY_ONE void lar_face_parts_one_by_one(const double x[3], const double corner[4][3],
                                              const double middle[3], lar_face_parts *parts);

/* How much x and the corners may move against each other: lar_face_before. */
LAR_ONE_BY_ONE double lar_face_before_one_by_one(const double x[3], const double corner[4][3],
                                                 const double middle[3]);

/* Where a segment comes closest to each: lar_face_segment_closest. */
LAR_ONE_BY_ONE double lar_face_segment_one_by_one(const lar_segment *segment,
                                                  const double corner[4][3], const double middle[3],
                                                  double reach, lar_face_segment closest[4]);

/* The points of a grid: lar_face_grid_near. */
LAR_ONE_BY_ONE void lar_face_grid_one_by_one(const lar_segment *segment, const double corner[4][3],
                                             const lar_face_grid *grid, double within,
                                             lar_face_near *near);

/* All in lanes, of builds that have them. */
void lar_face_parts_in_lanes(const double x[3], const double corner[4][3], const double middle[3],
                             lar_face_parts *parts);
double lar_face_before_in_lanes(const double x[3], const double corner[4][3],
                                const double middle[3]);
double lar_face_segment_in_lanes(const lar_segment *segment, const double corner[4][3],
                                 const double middle[3], double reach, lar_face_segment closest[4]);
void lar_face_grid_in_lanes(const lar_segment *segment, const double corner[4][3],
                            const lar_face_grid *grid, double within, lar_face_near *near);

/* What this processor takes. */
typedef struct lar_face_finders {
    void (*parts)(const double x[3], const double corner[4][3], const double middle[3],
                  lar_face_parts *parts);
    double (*before)(const double x[3], const double corner[4][3], const double middle[3]);
    double (*segment)(const lar_segment *segment, const double corner[4][3], const double middle[3],
                      double reach, lar_face_segment closest[4]);
    void (*grid)(const lar_segment *segment, const double corner[4][3], const lar_face_grid *grid,
                 double within, lar_face_near *near);
} lar_face_finders;
lar_face_finders lar_face_finders_here(void);

#if defined(LAR_HAVE_FACE_LANES)
/* Whether this processor has them. */
static inline bool lar_face_lanes(void) {
    return __builtin_cpu_supports("avx2");
}
#endif

#endif
