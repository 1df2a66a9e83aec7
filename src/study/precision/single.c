#include "study/precision/single.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "study/precision/single_domain.h"

extern const lar_single_kernels lar_single_c0, lar_single_c1;
#ifdef LAR_HAVE_AVX512
extern const lar_single_kernels lar_single_avx5120, lar_single_avx5121;
#endif

const lar_single_kernels *lar_single_kernels_find(const char *isa, bool single_state) {
    if (strcmp(isa, "c") == 0) return single_state ? &lar_single_c1 : &lar_single_c0;
#ifdef LAR_HAVE_AVX512
    if (strcmp(isa, "avx512") == 0) return single_state ? &lar_single_avx5121 : &lar_single_avx5120;
#endif
    return NULL;
}

/* ---- blocks of floats -------------------------------------------------------------------- */

/* `count` groups of eight numbers into one half of groups of sixteen. */
static void narrow(const double *from, int count, int half, float *to) {
    for (int k = 0; k < count; k++)
        for (int i = 0; i < LAR_BLOCK; i++)
            to[k * LAR_SINGLE_BLOCK + half * LAR_BLOCK + i] = (float)from[k * LAR_BLOCK + i];
}

/* Where an odd block has no neighbour, its nodes stand again beside zeros: no force. */
static void fill_half(const void *block, lar_block_shape shape, bool empty, int half, void *to) {
    const lar_block_head *from = block;
    lar_single_head *head = to;
    for (int a = 0; a < 8; a++)
        memcpy(head->node[a] + half * LAR_BLOCK, from->node[a], sizeof from->node[a]);
    if (empty) return;
    narrow(&from->modulus[0][0], LAR_BLOCK_PARAMETERS, half, &head->modulus[0][0]);
    narrow(&from->stiffness[0][0], LAR_HEX8_HOURGLASS, half, &head->stiffness[0][0]);
    if (shape == LAR_SHAPE_BOX) {
        narrow(((const lar_box_block *)block)->gradient[0], 3, half,
               ((lar_single_box *)to)->gradient[0]);
        return;
    }
    const lar_hex8_block *general = block;
    narrow(general->gradient[0][0], 18, half, ((lar_single_general *)to)->gradient[0][0]);
    narrow(general->shape[0][0], 12, half, ((lar_single_general *)to)->shape[0][0]);
}

static size_t single_size(lar_block_shape shape) {
    return shape == LAR_SHAPE_BOX ? sizeof(lar_single_box) : sizeof(lar_single_general);
}

/* Blocks, and behind them what a law has more. */
static size_t run_bytes(const lar_block_run *run) {
    size_t pairs = (size_t)((run->count + 1) / 2);
    return pairs * (single_size(run->shape) + (run->more ? sizeof(lar_single_more) : 0));
}

_Static_assert(sizeof(lar_single_more) == LAR_MORE_PARAMETERS * LAR_SINGLE_BLOCK * sizeof(float),
               "single.h knows as many parameters as hex8_block.h");

/* The run's pointer keeps its type, as that of its blocks does. */
static void fill_more(lar_block_run *run, lar_single_more *to) {
    for (int32_t b = 0; b < run->count; b++)
        narrow(&run->more[b].modulus[0][0], LAR_MORE_PARAMETERS, b % 2, &to[b / 2].modulus[0][0]);
    run->more = (const lar_block_more *)(const void *)to;
}

/* Block b, or where there is none the last one; made whole in `made` where it is lean. */
static const void *block_of(const lar_kernels *kernels, const lar_block_run *run, int32_t b,
                            lar_hex8_block *made) {
    if (b == run->count) b--;
    if (!run->rest) return lar_run_block(run, b);
    kernels->expand(run, b, made);
    return made;
}

static void fill_run(const lar_kernels *kernels, lar_block_run *run, char *to) {
    lar_hex8_block made[2];
    for (int32_t b = 0; b < run->count; b += 2) {
        const void *block = block_of(kernels, run, b, &made[0]);
        const void *next = block_of(kernels, run, b + 1, &made[1]);
        const bool alone = b + 1 == run->count;
        char *pair = to + (size_t)(b / 2) * single_size(run->shape);
        fill_half(block, run->shape, false, 0, pair);
        fill_half(next, run->shape, alone, 1, pair);
    }
    run->blocks = to;
    run->rest = NULL;
    run->folds = NULL; /* as in double precision for comparison (precision.c) */
    if (run->more)
        fill_more(run, (void *)(to + (size_t)((run->count + 1) / 2) * single_size(run->shape)));
}

/* ---- in the place of production's kernels ------------------------------------------------- */

static void recover_single(const lar_single_kernels *kernels, const lar_block_run *run,
                           const double *u, int64_t *force) {
    const lar_single_run made = {.law = (int)run->law,
                                 .shape = (int)run->shape,
                                 .rows = (int)run->rows,
                                 .turn = run->turn,
                                 .count = (run->count + 1) / 2,
                                 .axis_stride = run->axis_stride,
                                 .blocks = run->blocks,
                                 .more = (const lar_single_more *)(const void *)run->more};
    kernels->recover(&made, u, force);
}

#define DEFINE_RECOVER(kernels)                                                                    \
    static int64_t recover_##kernels(const lar_block_run *run, const double *u, int64_t *force,    \
                                     const lar_hex8_limits *limits, lar_hex8_monitor *monitor) {   \
        (void)limits, (void)monitor;                                                               \
        recover_single(&lar_single_##kernels, run, u, force);                                      \
        return -1;                                                                                 \
    }
DEFINE_RECOVER(c0)
DEFINE_RECOVER(c1)
#ifdef LAR_HAVE_AVX512
DEFINE_RECOVER(avx5120)
DEFINE_RECOVER(avx5121)
#endif

/* lar_node_update where the state is float: every number is rounded to one, and the doubles of the
 * arrays only carry them. */
static bool update_single(const lar_leapfrog *leapfrog, int32_t first, int32_t end, size_t stride,
                          double *u, double *v, int64_t *force, const double *push,
                          const double *mass, double *damped, double *fastest) {
    const float keep = (float)leapfrog->keep, dt = (float)leapfrog->dt;
    float max = 0;
    bool fits = true;
    for (int64_t value = 3 * (int64_t)first; value < 3 * (int64_t)end; value++) {
        const size_t n = (size_t)(value / 3), k = n + (size_t)(value % 3) * stride;
        const float before = (float)v[k], drift = (float)leapfrog->drift[value % 3];
        const float after = fmaf(-(float)force[k], (float)push[n], fmaf(keep, before, drift));
        v[k] = after;
        u[k] = fmaf(dt, after, (float)u[k]);
        force[k] = 0;
        fits = fits && fabsf(after) < leapfrog->speed;
        max = fmaxf(max, fabsf(after));
        const double twice = (double)before + after;
        if (mass) *damped += mass[n] * twice * twice;
    }
    if (max > *fastest) *fastest = max;
    return fits;
}

static bool always(void) {
    return true;
}

static const lar_kernels *kernels_of(const char *isa, bool single_state) {
    static const lar_kernels c[2] = {
        {.name = "c", .available = always, .recover = recover_c0},
        {.name = "c", .available = always, .recover = recover_c1, .update = update_single}};
    if (strcmp(isa, "c") == 0) return &c[single_state];
#ifdef LAR_HAVE_AVX512
    static const lar_kernels avx512[2] = {
        {.name = "avx512", .available = always, .recover = recover_avx5120},
        {.name = "avx512",
         .available = always,
         .recover = recover_avx5121,
         .update = update_single}};
    if (strcmp(isa, "avx512") == 0) return &avx512[single_state];
#endif
    return NULL;
}

lar_status lar_single_adopt(lar_domain *domain, bool single_state, lar_single_domain *adopted,
                            lar_error *error) {
    *adopted = (lar_single_domain){0};
    const lar_kernels *found = kernels_of(domain->kernels->name, single_state);
    if (!found || domain->kind != LAR_ELEMENT_HEX8)
        return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                        "single precision is studied for element hex8 and the instruction sets c "
                        "and avx512, not for %s; choose with --isa",
                        domain->kernels->name);
    size_t bytes = 0;
    for (int32_t r = 0; r < domain->run_count; r++) bytes += run_bytes(&domain->run[r]);
    adopted->blocks = lar_calloc_aligned(bytes, 1);
    if (!adopted->blocks) return lar_fail_memory(error, bytes, "blocks in single precision");
    adopted->bytes = bytes;
    char *to = adopted->blocks;
    for (int32_t r = 0; r < domain->run_count; r++) {
        size_t size = run_bytes(&domain->run[r]);
        fill_run(domain->kernels, &domain->run[r], to);
        to += size;
    }
    adopted->kernels = *found;
    if (!single_state) adopted->kernels.update = domain->kernels->update;
    domain->kernels = &adopted->kernels;
    return LAR_OK;
}

void lar_single_release(lar_single_domain *adopted) {
    free(adopted->blocks);
    *adopted = (lar_single_domain){0};
}
