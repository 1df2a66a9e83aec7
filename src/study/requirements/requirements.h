/* What machine a model needs: chapter 4 of the thesis for any model, and beside it what our own
 * kernels and schedules do.
 *
 *     quantities   counted from the model: elements, nodes, neighbours; n_pav from a real
 *                  distribution; the step from the elements' stability
 *          |
 *     thesis_formulas.h   operations and values per step and second, eqs. 4.1 to 4.12
 *
 *     kernels      operations of an element and a node counted from the code (operations.h), times
 *                  the elements of each kind that the layout really makes
 *     sent         bytes of the packets of real schedules, with their signal words and tails
 *     measured     time of a step on one core of this machine, now
 */
#ifndef LAR_STUDY_REQUIREMENTS_REQUIREMENTS_H
#define LAR_STUDY_REQUIREMENTS_REQUIREMENTS_H

#include <stdbool.h>

#include "lariat.h"
#include "study/requirements/operations.h"
#include "study/requirements/thesis_formulas.h"

typedef struct lar_requirements_options {
    const char *grid;         /* processors, "3x2x2"; NULL: that, the thesis's, or 1x1x1 for less
                                 elements than it has processors */
    const char *distribution; /* file; NULL: cut */
    double iterations;        /* n_it; 0: the thesis's 100 */
    double implicit_step;     /* dt_im [s]; 0: the thesis's 20 ms */
    bool measure;             /* step times on this machine, some tenths of a second */
    void (*progress)(void *context, const char *what); /* called before each part; or NULL */
    void *context;
} lar_requirements_options;

enum { LAR_REQUIREMENTS_SCHEMES = 4, LAR_REQUIREMENTS_SHAPES = 2 };

typedef struct lar_requirements_packet {
    int32_t from, to; /* processors */
    int64_t bytes;    /* with its signal word and tail */
} lar_requirements_packet;

/* Per step, of all processors together unless it says otherwise. */
typedef struct lar_requirements_sent {
    const char *scheme;
    int64_t vectors, packets, empty; /* empty packets among them: the signal word alone */
    int64_t bytes;                   /* of packets with signal words and tails */
    int64_t bytes_max;               /* of the processor that sends most */
    lar_requirements_packet *packet; /* [packets] owned; by sender, in the order of sending */
} lar_requirements_sent;

/* Elements that our kernel recovers as such, and how full its blocks are. */
typedef struct lar_requirements_shape {
    lar_kernel_kind kind;
    int64_t elements, lanes; /* lanes: those without an element too */
} lar_requirements_shape;

typedef enum lar_requirements_kernel_kind {
    LAR_NEEDS_HEX8 = 0,
    LAR_NEEDS_FULL,
    LAR_NEEDS_MATRIX,
    LAR_NEEDS
} lar_requirements_kernel_kind;

/* What one step of the model with an element kind is for one core. */
typedef struct lar_requirements_kernel {
    const char *name;
    double floating;   /* floating point operations of elements and nodes */
    double operations; /* with the integer additions of forces */
    double bytes;      /* read and written at least */
    double seconds;    /* measured on one core; 0: not measured */
} lar_requirements_kernel;

typedef struct lar_requirements {
    bool demonstration; /* the model is the demonstration organ */
    lar_quantities quantities;
    int32_t grid[3];
    int32_t elements_max; /* of one processor */
    int32_t shape_count;
    lar_requirements_shape shape[LAR_REQUIREMENTS_SHAPES];
    lar_requirements_kernel kernel[LAR_NEEDS];
    lar_requirements_sent sent[LAR_REQUIREMENTS_SCHEMES];
    bool measured;
    lar_error why_not;  /* when it was asked for and could not be done; else LAR_OK */
    const char *isa;    /* of the measurements */
    double peak_gflops; /* of one core */
    double nanoseconds; /* per element and step of a free block of as many elements */
} lar_requirements;

/* Everything about a model. Fails when the model cannot be divided or stepped in principle, or for
 * want of memory; a measurement that cannot be made is no failure. Clear it after success. */
lar_status lar_requirements_of(const lar_model *model, const lar_requirements_options *options,
                               lar_requirements *out, lar_error *error);
void lar_requirements_clear(lar_requirements *requirements); /* idempotent */

#endif
