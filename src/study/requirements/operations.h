/* What our kernels do for one element and one node: operations counted from the code (counted.h),
 * and the bytes of which an element and a node consist.
 *
 * Counted on one element of the asked law; the counts depend on nothing else. Bytes per step are
 * those that have to move when nothing stays in a cache: every element's constants once, every
 * node's displacement, velocity and force read and written once.
 */
#ifndef LAR_STUDY_REQUIREMENTS_OPERATIONS_H
#define LAR_STUDY_REQUIREMENTS_OPERATIONS_H

#include "study/requirements/counted.h"

typedef enum lar_kernel_kind {
    LAR_KERNEL_HEX8 = 0, /* any shape */
    LAR_KERNEL_HEX8_BOX, /* edges along the axes */
    LAR_KERNEL_FULL,     /* hex8-full: eight points, no matrices (T 4.2.2) */
    LAR_KERNEL_MATRIX,   /* hex8-matrix: matrices anew in every step (T 4.2.1) */
    LAR_KERNEL_KINDS
} lar_kernel_kind;

/* "hex8", "hex8 box", "hex8-full", "hex8-matrix". */
extern const char *const lar_kernel_kind_name[LAR_KERNEL_KINDS];

/* Per element, for the law (lar_law) of its material. */
lar_operations lar_operations_of_element(lar_kernel_kind kind, int law);
/* Per node that is moved, without what conditions and contact do. */
lar_operations lar_operations_of_node(void);

/* Bytes that a step reads and writes at least, when they come from memory. */
typedef struct lar_step_bytes {
    int64_t read, written;
} lar_step_bytes;
lar_step_bytes lar_bytes_of_element(lar_kernel_kind kind, int law);
lar_step_bytes lar_bytes_of_node(void);

#endif
