/* A file of measured numbers: names of columns in the first line, then one row a line.
 *
 *     # comments begin so
 *     time, force
 *     0.0,  0.0
 *     0.5,  0.12
 *
 * Semicolons or tabs part columns as well, one of the three in a table, and quotes may stand around
 * a name or a number. Columns are found by name; those that nobody asks for may hold anything.
 */
#ifndef LAR_STUDY_INVERSE_TABLE_H
#define LAR_STUDY_INVERSE_TABLE_H

#include "base/error.h"

typedef struct lar_inverse_table {
    char *path;
    int columns, header_line;
    char **name; /* [columns] */
    int32_t rows;
    int *line;     /* [rows] where each stands in the file */
    double *value; /* [rows][columns]; NAN where there is no number */
} lar_inverse_table;

/* Into a zeroed one; fewer than two rows are refused. The caller clears in any case. */
lar_status lar_inverse_table_read(const char *path, lar_inverse_table *table, lar_error *error);
void lar_inverse_table_clear(lar_inverse_table *table); /* idempotent */

/* Index of a column, -1: there is none. */
int lar_inverse_table_find(const lar_inverse_table *table, const char *name);
/* The numbers of a column times `scale` into value[rows]; what is no finite number is refused with
 * its line. */
lar_status lar_inverse_table_take(const lar_inverse_table *table, int column, double scale,
                                  double *value, lar_error *error);

#endif
