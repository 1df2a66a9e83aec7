/* Tissue files that somebody gives instead of the table of tissues. Their text goes into the scene
 * as it is, with the comments that say where it is from, so that the scene stands alone. */
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "meshing/meshing.h"
#include "model/scene/scene.h"

lar_status lar_starter_no_region(const lar_meshing *m, const char *what, const char *name,
                                 lar_error *error) {
    enum { SHOWN = 20 };
    const char *of[SHOWN];
    char list[300] = "";
    int count = 0;
    for (int32_t r = 0; r < m->boundary.region_count && count < SHOWN; r++)
        of[count++] = m->boundary.region[r + 1].name ? m->boundary.region[r + 1].name : "";
    lar_text_list(of, count, list, sizeof list);
    return lar_fail(error, LAR_ERROR_MODEL,
                    "%s \"%.80s\", but the regions are %s%s; name one of them", what, name, list,
                    m->boundary.region_count > count ? ", ..." : "");
}

/* Keys of one line each can be moved into the scene as they are, a mapping in braces cannot. */
static bool is_braced(const lar_bytes *bytes) {
    lar_text text = lar_text_from(bytes);
    lar_span line = {0};
    while (lar_text_line(&text, &line) && (line.length == 0 || *line.at == '#')) line.length = 0;
    return line.length > 0 && *line.at == '{';
}

static lar_status read_file(const char *path, lar_given_tissue *tissue, lar_error *error) {
    lar_material material = {0};
    lar_bytes_free(&tissue->text);
    free(tissue->path);
    tissue->path = lar_strdup(path);
    if (!tissue->path) return lar_fail_memory(error, strlen(path), "a path");
    lar_status status = lar_bytes_read(path, &tissue->text, error);
    if (!status) status = lar_tissue_read(path, &tissue->text, &material, error);
    if (!status) status = lar_material_check(&material, path, error);
    if (!status && is_braced(&tissue->text))
        status =
            lar_fail(error, LAR_ERROR_UNSUPPORTED,
                     "%s: write each key on a line of its own, without braces around them", path);
    tissue->shear = lar_material_instant_shear(&material);
    tissue->bulk = lar_material_instant_bulk(&material);
    tissue->density = material.density;
    tissue->fibres = lar_fibre_directed(&material.fibre);
    return status;
}

/* Of one region, or with a NULL of all but bones. */
static lar_status take(lar_meshing *m, const char *region, size_t length, const char *path,
                       lar_error *error) {
    lar_status status = LAR_OK;
    bool any = !region;
    for (int32_t r = 0; r < m->boundary.region_count && !status; r++) {
        const char *name = m->boundary.region[r + 1].name ? m->boundary.region[r + 1].name : "";
        if (region ? strlen(name) != length || memcmp(name, region, length) != 0
                   : lar_tissue_find(name)->rigid)
            continue;
        any = true;
        status = read_file(path, &m->given[r], error);
    }
    if (any) return status;
    char wanted[81] = "";
    memcpy(wanted, region, length < sizeof wanted ? length : sizeof wanted - 1);
    return lar_starter_no_region(m, "a tissue file is given for", wanted, error);
}

lar_status lar_starter_take_tissues(lar_meshing *m, const lar_meshing_options *options,
                                    lar_error *error) {
    lar_status status = LAR_OK;
    m->given = lar_calloc((size_t)m->boundary.region_count, sizeof *m->given);
    if (!m->given) return lar_fail_memory(error, sizeof *m->given, "tissues");
    for (int32_t i = 0; i < options->tissue_count && !status; i++) {
        const char *entry = options->tissues[i], *equals = strchr(entry, '=');
        status = take(m, equals && equals > entry ? entry : NULL,
                      equals ? (size_t)(equals - entry) : 0, equals ? equals + 1 : entry, error);
    }
    return status;
}

lar_status lar_starter_check_tissues(const lar_meshing *m, lar_error *error) {
    for (int32_t r = 0; r < m->info.regions; r++)
        if (m->given[r].fibres && m->region[r].elements > 0 &&
            !lar_starter_fibrous(m, &m->region[r]))
            return lar_fail(error, LAR_ERROR_MODEL,
                            "%s: it has fibres; say along what they run in %s (fibres, or "
                            "--fibres RULE)",
                            m->given[r].path, m->region[r].name);
    return LAR_OK;
}

void lar_starter_clear_tissues(lar_meshing *m) {
    for (int32_t r = 0; m->given && r < m->boundary.region_count; r++) {
        lar_bytes_free(&m->given[r].text);
        free(m->given[r].path);
    }
    free(m->given);
}
