/* The slowest natural motion of a body, from its stiffness at rest.
 *
 * Under a load f = M a a body takes a shape u, K u = f, and Rayleigh's quotient of it,
 *     w^2 = u K u / u M u,
 * is never below the slowest motion's; under its weight it is mostly a tenth or two above it
 * (Rayleigh 1877; Temple and Bickley 1933). With f = M u a second time, what is faster has faded
 * from the shape by the squares of the frequencies (inverse iteration: Bathe, Finite Element
 * Procedures, 1996). Dynamic relaxation is damped by that quotient, which it finds on its way
 * (Underwood 1983); here it is known before the first step. */
#ifndef LAR_MESHING_STARTER_SLOWEST_H
#define LAR_MESHING_STARTER_SLOWEST_H

#include "meshing/starter/elastic.h"
#include "model/model.h"

/* A body's loads and ways. */
typedef struct lar_ways {
    const lar_mesh *mesh;
    lar_elastic elastic;
    lar_elastic_material *material; /* [elements] to be filled by lar_ways_weigh */
    uint8_t *still;                 /* [nodes] of `elastic`, to be filled */
    double *mass;                   /* [nodes] */
    double *spring;                 /* [nodes] as in lar_elastic, or NULL */
    lar_load_vectors *load, *way;   /* [nodes] */
    lar_elastic_solver *solver;     /* of `elastic`, made by the first lar_ways_solve */
    double work[LAR_LOADS];
} lar_ways;

/* All zero; cleared in any case. */
lar_status lar_ways_create(const lar_mesh *mesh, lar_ways *ways, lar_error *error);
void lar_ways_clear(lar_ways *ways);

/* Of element e. */
void lar_ways_weigh(lar_ways *ways, lar_gid e, double density, lar_elastic_material material);

/* Way and work under the load. `elastic` is as it was the last time. */
lar_status lar_ways_solve(lar_ways *ways, lar_error *error);

/* [1/s] the least of Rayleigh's quotients, 0: nothing moves. */
double lar_ways_slowest(const lar_ways *ways);

/* [1/s] of what hangs together with a node that the model holds along all axes or by a spring,
 * never less than it is, and a few per cent more at most; next to nothing where that can still turn
 * freely; 0 where there is no such body or no memory. Fibres are left out. */
double lar_slowest_motion(const lar_model *model);

#endif
