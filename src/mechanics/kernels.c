#include "mechanics/hex8_block.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __x86_64__
#include <cpuid.h>
#endif

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

/* Measured on Zen 5; on an Intel server many lines cost a sixth more, on others nobody has looked
 * (docs/performance.md, "Large models"). AMD gave family 26 to Zen 6 as well, other models. */
bool lar_kernels_ask_many(void) {
#ifdef __x86_64__
    enum { AMD = 0x444d4163, ZEN_5 = 26, MODELS = 0xd7 }; /* "cAMD"; 0 to 2f, 40 to 4f, 60 to 7f */
    unsigned a, b, c, d;
    if (!__get_cpuid(0, &a, &b, &c, &d) || c != AMD || !__get_cpuid(1, &a, &b, &c, &d))
        return false;
    unsigned family = (a >> 8 & 15) + (a >> 20 & 255), model = a >> 16 & 15;
    return family == ZEN_5 && MODELS >> model & 1;
#else
    return false;
#endif
}
