/* Small displacements of a meshed body under a few loads at once: what it will do to a pull or to
 * its weight, before anything is simulated.
 *
 *     K u_l = f_l        conjugate gradients, preconditioned by the diagonal and
 *                        by rigid groups of nodes (elastic_coarse.h)
 *
 * The element is the production element (mechanics/hex8.h) at rest: the mean strain, and springs
 * of the hourglass modes, here with the stiffness that they have in a cube of the same volume. Two
 * loads stand side by side in the inner loops, as numbers do in registers of all processors; a
 * second core takes the other two. What a load gives depends on no other one, but for when to stop.
 *
 * The work f . u that a load does grows from step to step of conjugate gradients by alpha r . z
 * (Hestenes and Stiefel 1952): when the last steps have added next to nothing, it is known
 * (Strakos and Tichy, Electronic Transactions on Numerical Analysis 13, 2002). */
#ifndef LAR_MESHING_STARTER_ELASTIC_H
#define LAR_MESHING_STARTER_ELASTIC_H

#include "model/mesh/mesh.h"

enum { LAR_LOADS = 4, LAR_PAIRS = LAR_LOADS / 2 };
#define LAR_EACH_LOAD for (int l = 0; l < LAR_LOADS; l++)

/* A number for each of the loads; [l] is one of them. */
typedef double lar_loads __attribute__((vector_size(8 * LAR_LOADS), aligned(8)));

/* A vector of a node for each of the loads. */
typedef lar_loads lar_load_vectors[3];

/* The same for two of them. */
typedef double lar_pair __attribute__((vector_size(16), aligned(8)));
typedef lar_pair lar_pair_vectors[3];

/* What an element is made of; shear 0: rigid, or left out. */
typedef struct lar_elastic_material {
    double shear, bulk; /* [Pa] */
    bool own_springs;   /* hourglass springs are the element's own, not a cube's */
} lar_elastic_material;

typedef struct lar_elastic_element {
    double gradient[6][3]; /* B_m [1/m] */
    double shape[4][3];    /* X_m [m] */
    double spring[4];      /* c_m [N/m] */
    double volume, shear, pressure;
    int32_t node[8];
} lar_elastic_element;

typedef struct lar_elastic {
    const lar_mesh *mesh;
    int32_t node_count, element_count;
    lar_elastic_element *element;
    const uint8_t *still;         /* [nodes] LAR_AXIS bits */
    const double *spring;         /* [nodes] to where each is, along every axis [N/m]; NULL: none */
    bool (*goes_on)(void *asker); /* asked in every step of solving; NULL: it does */
    void *asker;
} lar_elastic;

/* material: [elements]; still: [nodes] LAR_AXIS bits of what is held; spring: as in lar_elastic;
 * both stay the caller's, as long as this. Of what hangs together with no node that is held along
 * all axes, or by a spring, all is still then: it is left out. The caller frees the elements. */
lar_status lar_elastic_create(const lar_mesh *mesh, const lar_elastic_material *material,
                              uint8_t *still, const double *spring, lar_elastic *elastic,
                              lar_error *error);

/* Forces at the nodes, row 3 a + i for axis i of node a, by their displacements [N/m]. */
void lar_elastic_element_matrix(const lar_elastic_element *element, double K[24][24]);

/* [nodes] the diagonal of K, added to what is there; 0 where still. */
void lar_elastic_diagonal(const lar_elastic *elastic, double (*diagonal)[3]);

/* Forces [N] of the body at displacements u [m], and of what holds it. */
void lar_elastic_forces(const lar_elastic *elastic, const lar_pair_vectors *u, lar_pair_vectors *f);

/* What solving needs besides the loads; NULL is none. `elastic` must stay. */
typedef struct lar_elastic_solver lar_elastic_solver;
lar_status lar_elastic_solver_create(const lar_elastic *elastic, lar_elastic_solver **solver,
                                     lar_error *error);
void lar_elastic_solver_destroy(lar_elastic_solver *solver);

/* Displacements under the forces f, and the work f . u of each load [J], within a hundredth. */
lar_status lar_elastic_solve(lar_elastic_solver *solver, const lar_load_vectors *f,
                             lar_load_vectors *u, double work[LAR_LOADS], lar_error *error);

#endif
