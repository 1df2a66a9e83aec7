/* A distribution: which processor recovers which element (the assignment function of T 3.5).
 *
 * Every element has exactly one processor (eq. 3.14), that is the array. Load balance (eq. 6.7): no
 * processor has more than ceil(elements / processors). Ways to get one: cutting (cut.h), genetic
 * adaptation (genetic.h), METIS, at random (a bad one, for tests), or from a file (below). Those
 * made here have numbers of elements that differ by one at most; one written by hand may be
 * unbalanced, but no processor may be without elements.
 *
 * The file is text, docs/formats.md:
 *
 *     lariat-distribution 1
 *     grid 2x2x3
 *     elements 1840
 *     mesh 8c3fe2a1b07d5564       optional: the mesh it was made for
 *     0 7                         element, processor; every element once, in any order
 *     ...
 *     end
 */
#ifndef LAR_DIVIDE_DISTRIBUTION_H
#define LAR_DIVIDE_DISTRIBUTION_H

#include "divide/grid.h"
#include "divide/incidence.h"

typedef struct lar_distribution {
    lar_grid grid;
    int32_t element_count;
    int32_t *processor; /* [element_count], owned */
} lar_distribution;

/* All elements on processor 0, for filling. LAR_ERROR_ARGUMENT when the grid has more processors
 * than the mesh has elements. Clear with lar_distribution_clear; a zeroed one is fine. */
lar_status lar_distribution_create(const lar_mesh *mesh, const lar_grid *grid,
                                   lar_distribution *out, lar_error *error);
void lar_distribution_clear(lar_distribution *distribution);

/* Algorithm 3 on the elements' centres. */
lar_status lar_distribution_cut(const lar_mesh *mesh, const lar_grid *grid, lar_distribution *out,
                                lar_error *error);
/* The same by weight[elements], positive; NULL: by their number. */
lar_status lar_distribution_cut_by_weight(const lar_mesh *mesh, const lar_grid *grid,
                                          const float *weight, lar_distribution *out,
                                          lar_error *error);

/* Any element anywhere, balanced; the same for a seed everywhere. */
lar_status lar_distribution_random(const lar_mesh *mesh, const lar_grid *grid, uint64_t seed,
                                   lar_distribution *out, lar_error *error);

/* METIS k-way on the elements that share nodes, brought to balance within one element, its parts
 * then given places in the grid so that parts with many common nodes are near.
 * LAR_ERROR_UNSUPPORTED, with what to install, where Lariat was built without METIS. */
lar_status lar_distribution_metis(const lar_mesh *mesh, const lar_incidence *incidence,
                                  const lar_grid *grid, uint64_t seed, lar_distribution *out,
                                  lar_error *error);
bool lar_distribution_has_metis(void);

/* Elements per processor, into count[grid.count]. Returns whether eq. 6.7 holds. */
bool lar_distribution_load(const lar_distribution *distribution, int32_t *count);

/* 64 bits over the connectivity of a mesh: which nodes make which element. */
uint64_t lar_mesh_fingerprint(const lar_mesh *mesh);

/* Writes the file, whole or not at all (PATH.part first). */
lar_status lar_distribution_write(const char *path, const lar_mesh *mesh,
                                  const lar_distribution *distribution, lar_error *error);

/* Reads a file that must fit the mesh; refuses anything else with file and line. lar_distribution_
 * parse reads from memory, for fuzzing; `path` is for messages. */
lar_status lar_distribution_read(const char *path, const lar_mesh *mesh, lar_distribution *out,
                                 lar_error *error);
lar_status lar_distribution_parse(const char *path, const lar_bytes *bytes, const lar_mesh *mesh,
                                  lar_distribution *out, lar_error *error);

#endif
