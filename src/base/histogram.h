/* How long things took: a histogram with fixed logarithmic bins, for step times.
 *
 *     1 ns          2 ns          4 ns                           2^40 ns = 18 minutes
 *      |--64 bins----|--64 bins----|-- ... ------------------------|
 *
 * Every octave has 64 equal bins, so a percentile is known to 1.6 % whatever its size, and
 * better where many values lie. Adding is a
 * few instructions; nothing is allocated. Minimum, maximum and sum are exact.
 */
#ifndef LAR_BASE_HISTOGRAM_H
#define LAR_BASE_HISTOGRAM_H

#include <stdint.h>

enum { LAR_HISTOGRAM_SPLIT = 64, LAR_HISTOGRAM_OCTAVES = 40 };

/* A zeroed histogram is empty. */
typedef struct lar_histogram {
    uint64_t count, sum, min, max; /* of the values [ns] */
    uint64_t bin[LAR_HISTOGRAM_SPLIT * LAR_HISTOGRAM_OCTAVES];
} lar_histogram;

/* Adds a value [ns]. Values beyond the last bin are counted there. */
void lar_histogram_add(lar_histogram *histogram, uint64_t nanoseconds);

/* Adds all values of another one. */
void lar_histogram_merge(lar_histogram *histogram, const lar_histogram *other);

/* Counts in two bins per octave, `count` of them from 2^octave ns on: [1, 1.5) and [1.5, 2) times
 * its beginning. What lies below or above is in the first or the last one. */
void lar_histogram_halves(const lar_histogram *histogram, int octave, int count, uint32_t *out);

/* The value below or at which `share` (0..1) of all values lie [ns]: as if those of its bin were
 * spread over the bin evenly, never outside min..max. 0 when empty. */
double lar_histogram_quantile(const lar_histogram *histogram, double share);

#endif
