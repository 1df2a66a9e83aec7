#include "step/beside.h"

#include "mechanics/hex8_guard.h"

void lar_fill_viscosity(const lar_domain *domain, const lar_lane_base *base,
                        lar_viscous_block *block, int lane, const lar_material *material,
                        double factor) {
    const lar_viscosity *v = &material->viscosity;
    block->rest[lane] = v->rest;
    for (int i = 0; i < v->terms; i++) {
        block->term[i].share[lane] = v->share[i];
        block->term[i].rate[lane] = 1 / v->time[i];
    }
    block->unit[lane] = base->volume * domain->scale * factor;
    block->inverse[lane] = 1 / block->unit[lane];
}

/* One family of element e. */
static void fill_family(lar_fibre_block *block, int lane, const lar_material *material,
                        const double direction[3], double unit) {
    const lar_fibre *fibre = &material->fibre;
    for (int i = 0; i < 3; i++) block->direction[i][lane] = direction[i];
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        block->parameter[k][lane] =
            lar_fibre_scales(fibre->law, k) ? fibre->parameter[k] * unit : fibre->parameter[k];
    block->along[lane] = fibre->along * unit;
    block->across[lane] = fibre->across * unit;
    block->limit[lane] = lar_fibre_limit(material) * unit;
}

void lar_fill_fibres(const lar_domain *domain, const lar_lane_base *base, lar_beside beside,
                     int lane, const lar_material *material, lar_gid e) {
    double direction[6], unit = base->volume * domain->scale;
    lar_model_fibres(domain->model, e, direction);
    fill_family(beside.fibres, lane, material, direction, unit);
    if (beside.second) fill_family(beside.second, lane, material, direction + 3, unit);
}

bool lar_fibres_plan(lar_domain *domain) {
    size_t blocks = (size_t)domain->layout.block_count;
    bool pairs = false;
    for (int32_t r = 0; r < domain->run_count; r++) {
        pairs = pairs || domain->run[r].fibrous > LAR_FIBRE_SINGLE;
        if (domain->run[r].fibrous) domain->fibre_bytes = blocks * sizeof *domain->fibres;
    }
    if (domain->fibre_bytes) domain->fibres = lar_calloc_aligned(domain->fibre_bytes, 1);
    if (pairs) domain->second = lar_calloc_aligned(domain->fibre_bytes, 1);
    if ((domain->fibre_bytes && !domain->fibres) || (pairs && !domain->second)) return false;
    for (int32_t r = 0; r < domain->run_count; r++) {
        lar_block_run *run = &domain->run[r];
        if (run->fibrous) run->fibres = domain->fibres + domain->run_first[r];
        if (run->fibrous > LAR_FIBRE_SINGLE) run->second = domain->second + domain->run_first[r];
    }
    return true;
}

lar_status lar_fibres_check(const lar_domain *domain, lar_error *error) {
    const lar_material *fibrous = lar_model_fibrous(domain->model);
    if (!fibrous || domain->kind == LAR_ELEMENT_HEX8) return LAR_OK;
    const char *quote = fibrous->name && *fibrous->name ? "'" : "";
    return lar_fail(error, LAR_ERROR_UNSUPPORTED,
                    "%s:%d: the material %s%.60s%s has fibres, which only elements hex8 can have; "
                    "take these, or leave its fibres out",
                    lar_model_source(domain->model), fibrous->fibre.line, quote,
                    *quote ? fibrous->name : "without a name", quote);
}
