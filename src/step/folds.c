#include "step/folds.h"

#include <string.h>

#include "base/memory.h"

/* As the layout turns it. */
static void corners_of(const lar_domain *domain, lar_gid e, double corner[8][3]) {
    const lar_mesh *mesh = &domain->model->mesh;
    for (int a = 0; a < 8; a++)
        memcpy(corner[a], mesh->position[domain->layout.corner[e][a]], sizeof corner[a]);
}

static bool element_may_fold(const lar_domain *domain, lar_gid e) {
    double corner[8][3];
    if (e < 0 || !lar_hex8_may_fold(lar_model_material_of(domain->model, e))) return false;
    corners_of(domain, e, corner);
    return lar_hex8_is_flat((const double(*)[3])corner);
}

static bool run_may_fold(const lar_domain *domain, int32_t r) {
    for (int32_t b = 0; b < domain->run[r].count; b++) {
        const lar_lanes *lanes = &domain->layout.block[domain->run_first[r] + b];
        for (int lane = 0; lane < LAR_BLOCK; lane++)
            if (element_may_fold(domain, lanes->element[lane])) return true;
    }
    return false;
}

bool lar_folds_plan(lar_domain *domain) {
    for (int32_t r = 0; r < domain->run_count; r++) {
        if (!run_may_fold(domain, r)) continue;
        if (!domain->folds) {
            domain->fold_bytes = (size_t)domain->layout.block_count * sizeof *domain->folds;
            domain->folds = lar_calloc_aligned(domain->fold_bytes, 1);
        }
        if (!domain->folds) return false;
        domain->run[r].folds = domain->folds + domain->run_first[r];
    }
    return true;
}

void lar_folds_fill(const lar_domain *domain, int32_t r, int32_t b, int lane,
                    const double stiffness[LAR_HEX8_HOURGLASS]) {
    const int32_t at = domain->run_first[r] + b;
    const lar_gid e = domain->layout.block[at].element[lane];
    const lar_lane_base *base = &domain->base[LAR_BLOCK * at + lane];
    const lar_material *material = lar_domain_material(domain, e);
    lar_fold_block *block = domain->folds + at;
    double corner[8][3];
    corners_of(domain, e, corner);
    bool folds = lar_hex8_may_fold(material) && lar_hex8_is_flat((const double(*)[3])corner);
    if (!folds) {
        block->from[lane] = block->bulk[lane] = 0;
        for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) block->softness[m][lane] = 0;
        return;
    }
    lar_hex8 element;
    lar_hex8_fold fold;
    lar_hex8_prepare((const double(*)[3])corner, material, &element);
    lar_hex8_fold_prepare((const double(*)[3])corner, (const double(*)[3])element.gradient,
                          material, &fold);
    block->bulk[lane] = fold.bulk * base->volume * domain->scale;
    block->from[lane] = fold.from;
    for (int i = 0; i < 3; i++) block->axis[i][lane] = fold.axis[i];
    for (int m = 0; m < LAR_HEX8_HOURGLASS; m++) {
        block->weight[m][lane] = fold.weight[m];
        block->softness[m][lane] = stiffness[m] > 0 ? fold.weight[m] / stiffness[m] : 0;
    }
}

double lar_folds_energy(const lar_domain *domain, const lar_state *state, lar_gid e) {
    double corner[8][3], u[8][3];
    if (!domain->folds) return 0;
    lar_mesh_corners(&domain->model->mesh, e, corner);
    lar_domain_corners(domain, state->u, e, u);
    return lar_hex8_fold_force((const double(*)[3])corner, lar_domain_material(domain, e),
                               (const double(*)[3])u, NULL);
}
