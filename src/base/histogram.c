#include "base/histogram.h"

#include <math.h>

enum { SPLIT = LAR_HISTOGRAM_SPLIT, BINS = LAR_HISTOGRAM_SPLIT * LAR_HISTOGRAM_OCTAVES };

/* Values below SPLIT have a bin each; above, the octave's leading bit and the next six choose. */
static int bin_of(uint64_t value) {
    if (value < SPLIT) return (int)value;
    int octave = 63 - __builtin_clzll(value) - 6;
    int bin = (octave + 1) * SPLIT + (int)((value >> octave) - SPLIT);
    return bin < BINS ? bin : BINS - 1;
}

/* The value at a part (0..1) of the bin's width. */
static double value_in(int bin, double part) {
    if (bin < SPLIT) return bin;
    int octave = bin / SPLIT - 1;
    return ldexp(SPLIT + bin % SPLIT + part, octave);
}

void lar_histogram_add(lar_histogram *histogram, uint64_t nanoseconds) {
    if (histogram->count == 0 || nanoseconds < histogram->min) histogram->min = nanoseconds;
    if (nanoseconds > histogram->max) histogram->max = nanoseconds;
    histogram->count++;
    histogram->sum += nanoseconds;
    histogram->bin[bin_of(nanoseconds)]++;
}

void lar_histogram_merge(lar_histogram *histogram, const lar_histogram *other) {
    if (other->count == 0) return;
    if (histogram->count == 0 || other->min < histogram->min) histogram->min = other->min;
    if (other->max > histogram->max) histogram->max = other->max;
    histogram->count += other->count;
    histogram->sum += other->sum;
    for (int i = 0; i < BINS; i++) histogram->bin[i] += other->bin[i];
}

void lar_histogram_halves(const lar_histogram *histogram, int octave, int count, uint32_t *out) {
    for (int i = 0; i < count; i++) out[i] = 0;
    for (int bin = 0; bin < BINS; bin++) {
        if (histogram->bin[bin] == 0) continue;
        int power = bin < SPLIT ? 0 : bin / SPLIT + 5, upper = bin % SPLIT >= SPLIT / 2;
        int at = bin < SPLIT ? -1 : 2 * (power - octave) + upper;
        at = at < 0 ? 0 : at < count ? at : count - 1;
        out[at] += (uint32_t)histogram->bin[bin];
    }
}

double lar_histogram_quantile(const lar_histogram *histogram, double share) {
    if (histogram->count == 0) return 0;
    double wanted = share * (double)histogram->count;
    uint64_t below = 0;
    int bin = 0;
    for (; bin < BINS - 1; bin++) {
        below += histogram->bin[bin];
        if (below > 0 && (double)below >= wanted) break;
    }
    double inside = (double)histogram->bin[bin];
    double part = inside > 0 ? 1 - ((double)below - wanted) / inside : 1;
    return fmin(fmax(value_in(bin, part), (double)histogram->min), (double)histogram->max);
}
