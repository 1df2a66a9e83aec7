#include "mechanics/hex8_block.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const lar_kernels lar_kernels_avx512, lar_kernels_avx2, lar_kernels_neon, lar_kernels_c_fma,
    lar_kernels_c;

/* Widest first; the build says which there are. Of two with one name the first that the processor
 * has. */
static const lar_kernels *const table[] = {
#ifdef LAR_HAVE_AVX512
    &lar_kernels_avx512,
#endif
#ifdef LAR_HAVE_AVX2
    &lar_kernels_avx2,
#endif
#ifdef LAR_HAVE_NEON
    &lar_kernels_neon,
#endif
#ifdef LAR_HAVE_C_FMA
    &lar_kernels_c_fma,
#endif
    &lar_kernels_c,
};
enum { COUNT = sizeof table / sizeof table[0] };

static void list_available(char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < COUNT; i++)
        if (table[i]->available() && used < size &&
            (i == 0 || strcmp(table[i]->name, table[i - 1]->name) != 0))
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? ", " : "",
                                     table[i]->name);
}

static lar_status refuse(const char *wanted, lar_error *error) {
    char names[64];
    list_available(names, sizeof names);
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "instruction set '%s' is unknown, or this processor or build does not have "
                    "it; there are: %s",
                    wanted, names);
}

static lar_status find_by_name(const char *name, const lar_kernels **kernels, lar_error *error) {
    for (int i = 0; i < COUNT; i++)
        if (strcmp(table[i]->name, name) == 0 && table[i]->available()) {
            *kernels = table[i];
            return LAR_OK;
        }
    return refuse(name, error);
}

lar_status lar_kernels_find(lar_isa isa, const lar_kernels **kernels, lar_error *error) {
    static const char *const names[] = {"auto", "c", "neon", "avx2", "avx512"};
    if (isa == LAR_ISA_AUTO) {
        const char *wanted = getenv("LARIAT_ISA");
        if (wanted && *wanted && strcmp(wanted, "auto") != 0)
            return find_by_name(wanted, kernels, error);
        for (int i = 0; i < COUNT; i++)
            if (table[i]->available()) {
                *kernels = table[i];
                return LAR_OK;
            }
    }
    if ((unsigned)isa >= sizeof names / sizeof names[0])
        return lar_fail(error, LAR_ERROR_ARGUMENT, "lar_isa %d does not exist; use LAR_ISA_AUTO",
                        (int)isa);
    return find_by_name(names[isa], kernels, error);
}
