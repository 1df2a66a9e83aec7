#include "parallel/division.h"

#include <stdlib.h>
#include <string.h>

#include "divide/genetic.h"
#include "divide/schedule/file.h"
#include "divide/proof/schedule_proof.h"
#include "model/model.h"

/* ---- the distribution --------------------------------------------------------------------- */

/* The search that a run itself makes: the same in every process, so it counts generations instead
 * of seconds. `lariat partition` searches longer. */
enum { GENERATIONS = 200, SEED = 1 };

static lar_status search(const lar_mesh *mesh, const lar_incidence *incidence, const lar_grid *grid,
                         lar_distribution *out, lar_error *error) {
    lar_distribution made = {0};
    lar_status status = lar_distribution_create(mesh, grid, &made, error);
    if (status) return status;
    lar_genetic_options options = lar_genetic_options_default();
    lar_genetic_result result;
    options.seed = SEED;
    options.seconds = 0;
    options.generations = GENERATIONS;
    status = lar_genetic_search(mesh, incidence, grid, &options, made.processor, &result, error);
    if (status)
        lar_distribution_clear(&made);
    else
        *out = made;
    return status;
}

enum { CUT, GENETIC, METIS, RANDOM, WAYS };
static const char *const ways[WAYS] = {"cut", "genetic", "metis", "random"};

static int find_name(const char *const *names, int count, const char *wanted) {
    for (int i = 0; i < count; i++)
        if (strcmp(names[i], wanted) == 0) return i;
    return -1;
}

bool lar_distribution_is_file(const char *distribution) {
    return distribution && find_name(ways, WAYS, distribution) < 0;
}

static lar_status distribute(const lar_mesh *mesh, const lar_incidence *incidence,
                             const lar_grid *grid, const char *how, lar_distribution *out,
                             lar_error *error) {
    switch (find_name(ways, WAYS, how)) {
    case CUT:
        return lar_distribution_cut(mesh, grid, out, error);
    case GENETIC:
        return search(mesh, incidence, grid, out, error);
    case METIS:
        return lar_distribution_metis(mesh, incidence, grid, SEED, out, error);
    case RANDOM:
        return lar_distribution_random(mesh, grid, SEED, out, error);
    default:
        return lar_distribution_read(how, mesh, out, error);
    }
}

/* ---- options ------------------------------------------------------------------------------ */

lar_status lar_division_options(const lar_options *options, lar_schedule_options *out,
                                lar_error *error) {
    *out = lar_schedule_options_default();
    if (options->threads) out->threads = options->threads;
    int scheme = options->scheme ? find_name(lar_scheme_name, LAR_SCHEMES, options->scheme) : 0;
    int use = options->channels
                  ? find_name(lar_channel_use_name, LAR_CHANNEL_USES, options->channels)
                  : 0;
    if (scheme < 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there is no communication scheme %s; there are all, local, one and two",
                        options->scheme);
    if (use < 0)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "there are no channels %s; give sequential or concurrent",
                        options->channels);
    out->scheme = (lar_scheme)scheme;
    out->channels = (lar_channel_use)use;
    return LAR_OK;
}

/* A distribution from a file may come without a grid: the file has it. */
static lar_status check_grid(const lar_options *options, const lar_grid *asked,
                             const lar_distribution *distribution, lar_error *error) {
    if (!options->grid || memcmp(asked->edge, distribution->grid.edge, sizeof asked->edge) == 0)
        return LAR_OK;
    char has[LAR_GRID_TEXT];
    lar_grid_format(&distribution->grid, has);
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "%s: the distribution is for the grid %s, not for %s; leave the grid out or "
                    "give another file",
                    options->distribution, has, options->grid);
}

static lar_status build_schedules(const lar_mesh *mesh, const lar_incidence *incidence,
                                  const lar_options *options, lar_schedule_set *out,
                                  lar_error *error) {
    lar_schedule_options wanted;
    lar_grid grid;
    lar_distribution distribution = {0};
    lar_status status = lar_division_options(options, &wanted, error);
    if (!status) status = lar_grid_parse(options->grid ? options->grid : "1x1x1", &grid, error);
    if (!status)
        status =
            distribute(mesh, incidence, &grid,
                       options->distribution ? options->distribution : "cut", &distribution, error);
    if (!status) status = check_grid(options, &grid, &distribution, error);
    if (!status) status = lar_schedule_build(mesh, incidence, &distribution, &wanted, out, error);
    lar_distribution_clear(&distribution);
    return status;
}

static lar_status read_schedules(const lar_mesh *mesh, const lar_incidence *incidence,
                                 const char *folder, lar_schedule_set *out, lar_error *error) {
    lar_schedule_set made = {0};
    lar_schedule_proof proof;
    lar_error why;
    lar_status status = lar_schedule_read_all(folder, mesh, &made, error);
    if (!status && lar_schedule_prove(mesh, incidence, &made, &proof, &why))
        status = lar_fail(error, why.status, "%s: %s", folder, why.message);
    if (status)
        lar_schedule_set_clear(&made);
    else
        *out = made;
    return status;
}

/* ---- the division ------------------------------------------------------------------------- */

static lar_status find_reporters(lar_division *division, int32_t node_count, lar_error *error) {
    division->reporter = lar_calloc((size_t)node_count, sizeof *division->reporter);
    if (!division->reporter) return lar_fail_memory(error, 4 * (size_t)node_count, "nodes");
    for (int32_t p = division->schedules.count - 1; p >= 0; p--) {
        const lar_schedule *schedule = &division->schedules.of[p];
        for (int32_t i = 0; i < schedule->node_count; i++)
            division->reporter[schedule->node[i]] = p;
    }
    return LAR_OK;
}

static lar_status find_recoverers(lar_division *division, int32_t element_count, lar_error *error) {
    division->recoverer = lar_calloc((size_t)element_count, sizeof *division->recoverer);
    if (!division->recoverer) return lar_fail_memory(error, 4 * (size_t)element_count, "elements");
    for (int32_t p = 0; p < division->schedules.count; p++) {
        const lar_schedule *schedule = &division->schedules.of[p];
        for (int32_t i = 0; i < schedule->element_count; i++)
            division->recoverer[schedule->element[i]] = p;
    }
    return LAR_OK;
}

static lar_status find_spread(lar_division *division, lar_error *error) {
    size_t pairs = (size_t)division->grid.count * (size_t)division->grid.count;
    division->distance = lar_schedule_distances(&division->schedules);
    if (!division->distance) return lar_fail_memory(error, 4 * pairs, "distances");
    for (size_t i = 0; i < pairs; i++) {
        if (division->distance[i] < 0)
            return lar_fail(error, LAR_ERROR_FORMAT,
                            "processors %zu and %zu never hear of each other, directly or through "
                            "others; make the schedules anew with lariat partition",
                            i / (size_t)division->grid.count, i % (size_t)division->grid.count);
        if (division->distance[i] > division->spread) division->spread = division->distance[i];
    }
    return LAR_OK;
}

/* What follows from the schedules. `made` is cleared after a failure, or becomes the division. */
static lar_status complete(const lar_model *model, lar_status status, lar_division *made,
                           lar_division *division, lar_error *error) {
    if (!status) {
        made->grid = made->schedules.of[0].grid;
        status = find_reporters(made, model->mesh.node_count, error);
    }
    if (!status) status = find_recoverers(made, model->mesh.element_count, error);
    if (!status) status = find_spread(made, error);
    if (status)
        lar_division_destroy(made);
    else
        *division = *made;
    return status;
}

lar_status lar_division_create(const lar_model *model, const lar_options *options,
                               lar_division *division, lar_error *error) {
    lar_division made = {0};
    lar_incidence incidence = {0};
    lar_status status = lar_incidence_build(&model->mesh, &incidence, error);
    if (!status && options->schedules)
        status =
            read_schedules(&model->mesh, &incidence, options->schedules, &made.schedules, error);
    else if (!status)
        status = build_schedules(&model->mesh, &incidence, options, &made.schedules, error);
    lar_incidence_clear(&incidence);
    return complete(model, status, &made, division, error);
}

lar_status lar_division_from(const lar_model *model, const lar_distribution *distribution,
                             const lar_schedule_options *wanted, lar_division *division,
                             lar_error *error) {
    lar_division made = {0};
    lar_incidence incidence = {0};
    lar_status status = lar_incidence_build(&model->mesh, &incidence, error);
    if (!status)
        status = lar_schedule_build(&model->mesh, &incidence, distribution, wanted, &made.schedules,
                                    error);
    lar_incidence_clear(&incidence);
    return complete(model, status, &made, division, error);
}

void lar_division_destroy(lar_division *division) {
    lar_schedule_set_clear(&division->schedules);
    free(division->reporter);
    free(division->recoverer);
    free(division->distance);
    *division = (lar_division){0};
}
