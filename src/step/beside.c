#include "step/beside.h"

/* An element is listed when its fibres are stiffer than at rest by this part of its modulus. */
static const double STRAINED_FIBRE = 0.1;

void lar_fill_viscosity(const lar_domain *domain, const lar_lane_base *base,
                        lar_viscous_block *block, int lane, const lar_material *material,
                        double factor) {
    const lar_viscosity *v = &material->viscosity;
    block->rest[lane] = v->rest;
    for (int i = 0; i < v->terms; i++) {
        block->share[i][lane] = v->share[i];
        block->rate[i][lane] = 1 / v->time[i];
    }
    block->unit[lane] = base->volume * domain->scale * factor;
    block->inverse[lane] = 1 / block->unit[lane];
}

void lar_fill_fibres(const lar_domain *domain, const lar_lane_base *base, lar_fibre_block *block,
                     int lane, const lar_material *material, lar_gid e) {
    const lar_fibre *fibre = &material->fibre;
    const double *direction = lar_model_fibre(domain->model, e);
    double unit = base->volume * domain->scale;
    for (int i = 0; i < 3; i++) block->direction[i][lane] = direction[i];
    for (int k = 0; k < LAR_FIBRE_PARAMETERS; k++)
        block->parameter[k][lane] =
            lar_fibre_scales(fibre->law, k) ? fibre->parameter[k] * unit : fibre->parameter[k];
    block->along[lane] = fibre->along * unit;
    block->across[lane] = fibre->across * unit;
    double modulus = lar_material_bulk(material) + 4 * lar_material_shear(material) / 3;
    block->limit[lane] = (lar_fibre_stiffest(fibre) + STRAINED_FIBRE * modulus) * unit;
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
