#include "step/domain_share.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

struct lar_domain_shared {
    int32_t users;       /* atomic */
    lar_domain constant; /* what belongs to all of them; NULL where each has its own */
};

/* The arrays that lar_domain_stiffen and lar_burden_take write, and what points into them. */
static void forget_own(lar_domain *domain) {
    if (domain->burden) domain->mass = domain->weight = domain->push = domain->added = NULL;
    domain->burden = NULL;
    domain->run = NULL;
    domain->blocks = NULL;
    domain->lean_parameters = NULL;
    domain->more = NULL;
    domain->relaxing = NULL;
    domain->fibres = NULL;
    domain->second = NULL;
    domain->folds = NULL;
    domain->corner_limit = NULL;
    domain->material = NULL;
}

static lar_status begin_sharing(lar_domain *domain, lar_error *error) {
    if (domain->shared) return LAR_OK;
    struct lar_domain_shared *shared = lar_calloc(1, sizeof *shared);
    if (!shared) return lar_fail_memory(error, sizeof *shared, "a clone");
    shared->users = 1;
    shared->constant = *domain;
    forget_own(&shared->constant);
    domain->shared = shared;
    return LAR_OK;
}

/* A copy of `bytes` bytes; NULL of NULL. */
static void *copy_of(const void *from, size_t bytes, bool *failed) {
    void *made = from ? lar_calloc_aligned(bytes, 1) : NULL;
    if (made) memcpy(made, from, bytes);
    *failed = *failed || (from && !made);
    return made;
}

/* Where `place`, in the memory that begins at `from`, is in that at `to`. */
static void *moved(const void *place, const void *from, void *to) {
    return place ? (char *)to + ((const char *)place - (const char *)from) : NULL;
}

lar_status lar_domain_share(lar_domain *from, lar_domain *copy, lar_error *error) {
    lar_status status = begin_sharing(from, error);
    if (status) return status;
    size_t lanes = LAR_BLOCK * (size_t)from->layout.block_count;
    bool failed = false;
    *copy = *from;
    __atomic_add_fetch(&from->shared->users, 1, __ATOMIC_RELAXED);
    copy->run = copy_of(from->run, (size_t)from->run_count * sizeof *from->run, &failed);
    copy->blocks = copy_of(from->blocks, from->block_bytes, &failed);
    copy->more = copy_of(from->more, from->more_bytes, &failed);
    copy->relaxing = copy_of(from->relaxing, from->relaxing_bytes, &failed);
    copy->fibres = copy_of(from->fibres, from->fibre_bytes, &failed);
    copy->second = copy_of(from->second, from->fibre_bytes, &failed);
    copy->folds = copy_of(from->folds, from->fold_bytes, &failed);
    copy->corner_limit = copy_of(from->corner_limit, lanes * sizeof *from->corner_limit, &failed);
    copy->material = copy_of(from->material,
                             (size_t)from->model->material_count * sizeof *from->material, &failed);
    copy->surroundings.list = NULL;
    if (from->rubbing) copy->rubbing = &copy->surroundings.bodies.surface;
    copy->burden = NULL;
    if (from->burden) {
        size_t bytes = (size_t)from->layout.node_padded * sizeof(double);
        copy->weight = copy->mass = copy_of(from->mass, bytes, &failed);
        copy->push = copy_of(from->push, bytes, &failed);
        copy->added = copy_of(from->added, bytes, &failed);
        copy->burden = lar_burden_copy(from->burden, bytes / sizeof(double));
        failed = failed || !copy->burden;
    }
    if (failed) {
        lar_domain_leave(copy);
        return lar_fail_memory(error, from->block_bytes, "a clone");
    }
    copy->lean_parameters = moved(from->lean_parameters, from->blocks, copy->blocks);
    for (int32_t r = 0; r < copy->run_count; r++) {
        lar_block_run *run = &copy->run[r];
        if (run->rest) run->parameters = copy->lean_parameters;
        run->blocks = moved(run->blocks, from->blocks, copy->blocks);
        run->more = moved(run->more, from->more, copy->more);
        run->relaxing = moved(run->relaxing, from->relaxing, copy->relaxing);
        run->fibres = moved(run->fibres, from->fibres, copy->fibres);
        run->second = moved(run->second, from->second, copy->second);
        run->folds = moved(run->folds, from->folds, copy->folds);
    }
    return LAR_OK;
}

void lar_domain_leave(lar_domain *domain) {
    struct lar_domain_shared *shared = domain->shared;
    if (!shared) {
        lar_domain_destroy(domain);
        return;
    }
    free(domain->run);
    free(domain->blocks);
    free(domain->more);
    free(domain->relaxing);
    free(domain->fibres);
    free(domain->second);
    free(domain->folds);
    free(domain->corner_limit);
    free(domain->material);
    lar_burden_destroy(domain->burden);
    if (!shared->constant.mass) {
        free(domain->mass);
        free(domain->push);
        free(domain->added);
    }
    *domain = (lar_domain){0};
    if (__atomic_sub_fetch(&shared->users, 1, __ATOMIC_ACQ_REL) > 0) return;
    lar_domain_destroy(&shared->constant);
    free(shared);
}
