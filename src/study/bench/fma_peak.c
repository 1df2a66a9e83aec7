#include "study/bench/fma_peak.h"

#include <stddef.h>
#include <string.h>

extern const lar_fma_peak lar_fma_peak_avx512, lar_fma_peak_avx2, lar_fma_peak_neon,
    lar_fma_peak_c_fma, lar_fma_peak_c;

static const lar_fma_peak *const table[] = {
#ifdef LAR_HAVE_AVX512
    &lar_fma_peak_avx512,
#endif
#ifdef LAR_HAVE_AVX2
    &lar_fma_peak_avx2,
#endif
#ifdef LAR_HAVE_NEON
    &lar_fma_peak_neon,
#endif
    &lar_fma_peak_c,
};

const lar_fma_peak *lar_fma_peak_find(const char *name) {
#ifdef LAR_HAVE_C_FMA
    if (strcmp(name, "c") == 0 && __builtin_cpu_supports("fma")) return &lar_fma_peak_c_fma;
#endif
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (strcmp(table[i]->name, name) == 0) return table[i];
    return NULL;
}
