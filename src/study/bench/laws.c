#include "study/bench/laws.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "simulation/simulation.h"

/* ---- words ------------------------------------------------------------------------------ */

static const char *const viscous[] = {"viscous", "viscous-2", "viscous-3"};
_Static_assert(sizeof viscous / sizeof *viscous == LAR_BENCH_TERMS, "a word for each");

const char *lar_bench_law_words(int index) {
    if (index < LAR_LAW_COUNT) return lar_law_name[index];
    index -= LAR_LAW_COUNT;
    if (index < LAR_FIBRE_LAWS - 1) return lar_fibre_law_name[index + 1];
    index -= LAR_FIBRE_LAWS - 1;
    if (index == 0) return "hgo-pair";
    if (index <= LAR_BENCH_TERMS) return viscous[index - 1];
    return index == LAR_BENCH_TERMS + 1 ? "active" : NULL;
}

/* Gives the constants that moduli leave zero a quarter of the first one, and takes from that what
 * they add to the shear modulus. Powers that are zero become -2 and 5. */
static void set_every_term(lar_material *material) {
    const lar_law_row *law = &lar_law_table[material->law];
    double *p = material->parameter;
    for (int k = 0; k < law->count; k++) {
        if (p[k] != 0) continue;
        if (law->parameter[k].value == LAR_VALUE_POWER) {
            p[k] = k == 3 ? -2 : 5;
            continue;
        }
        double shear = lar_material_shear(material);
        p[k] = 0.25 * p[0];
        if (lar_material_shear(material) != shear) p[0] -= p[k];
    }
}

/* Beginning to pull with a modulus like the body's own. */
static void set_fibres(lar_material *material, lar_fibre_law law, bool paired) {
    static const double number[LAR_FIBRE_LAWS][LAR_FIBRE_PARAMETERS] = {
        [LAR_FIBRE_EXP_POW] = {1e3, 1, 2},
        [LAR_FIBRE_EXP_LINEAR] = {400, 10, 1e4, 1.2},
        [LAR_FIBRE_POW_LINEAR] = {5e3, 1.1, 2},
        [LAR_FIBRE_HGO] = {1e3, 0.8, 0.1}};
    material->fibre.law = law;
    material->fibre.isochoric = true;
    material->fibre.paired = paired;
    memcpy(material->fibre.parameter, number[law], sizeof number[law]);
}

/* Twice as stiff at once as in the end, in terms of 10 ms, 0.1 s and 1 s. */
static void set_viscosity(lar_material *material, int terms) {
    lar_viscosity *viscosity = &material->viscosity;
    *viscosity = (lar_viscosity){.terms = terms, .rest = 1};
    for (int i = 0; i < terms; i++) {
        viscosity->share[i] = 1.0 / terms;
        viscosity->time[i] = 0.01 * pow(10, i);
    }
}

enum { ACTIVE = LAR_LAW_COUNT + LAR_FIBRE_LAWS + LAR_BENCH_TERMS };

/* One of the words by its place in "all". */
static void set_word(lar_material *material, int word) {
    if (word == ACTIVE)
        material->fibre.along = 100; /* [Pa]: little, so that the block stays as it is */
    else if (word < LAR_LAW_COUNT)
        material->law = (lar_law)word;
    else if (word < LAR_LAW_COUNT + LAR_FIBRE_LAWS - 1)
        set_fibres(material, (lar_fibre_law)(word - LAR_LAW_COUNT + 1), false);
    else if (word == LAR_LAW_COUNT + LAR_FIBRE_LAWS - 1)
        set_fibres(material, LAR_FIBRE_HGO, true);
    else
        set_viscosity(material, word - LAR_LAW_COUNT - LAR_FIBRE_LAWS + 1);
}

enum { KINDS = 4 };
static int word_kind(int word) {
    if (word == ACTIVE) return 3;
    return word < LAR_LAW_COUNT ? 0 : word < LAR_LAW_COUNT + LAR_FIBRE_LAWS ? 1 : 2;
}

static lar_status refuse_word(lar_span word, bool again, lar_error *error) {
    char list[512] = "";
    size_t length = 0;
    const char *known;
    if (again)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "'%.*s' is one too many; join at most one law, one of fibres, one of "
                        "viscosity and active",
                        (int)word.length, word.at);
    for (int i = 0; (known = lar_bench_law_words(i)); i++)
        length +=
            (size_t)snprintf(list + length, sizeof list - length, "%s%s", i ? ", " : "", known);
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no '%.*s'; there are all, %s, or several of them joined by +",
                    (int)(word.length < 60 ? word.length : 60), word.at, list);
}

lar_status lar_bench_law_material(const char *words, lar_material *material, lar_error *error) {
    lar_span rest = {words, strlen(words)}, one;
    bool taken[KINDS] = {false}, more = true;
    *material = lar_bench_material();
    while (more) {
        const char *known;
        int word = 0;
        more = lar_span_split(rest, '+', &one, &rest);
        while ((known = lar_bench_law_words(word)) && !lar_span_equal(one, known)) word++;
        if (!known || taken[word_kind(word)]) return refuse_word(one, known != NULL, error);
        taken[word_kind(word)] = true;
        set_word(material, word);
    }
    /* A law of shear and volume in one softens where it is nearly incompressible: Holmes and Mow's
     * is unstable at a strain of some per cent then. */
    const lar_material own = lar_bench_material();
    const bool uncoupled = lar_law_table[material->law].uncoupled;
    const double shear = lar_material_shear(&own);
    lar_material_from_shear_bulk(material, shear, uncoupled ? lar_material_bulk(&own) : 2 * shear);
    set_every_term(material);
    material->viscosity.isochoric = material->viscosity.terms > 0 && uncoupled;
    return LAR_OK;
}

/* ---- in turn ---------------------------------------------------------------------------- */

enum { BESIDE, LAW, BLOCKS, SECTIONS = 20 };

typedef struct pair {
    lar_simulation *of[BLOCKS];
    uint64_t steps; /* of a section */
} pair;

/* Steps that take about a millisecond, of the slower block. The fastest of some tries counts. */
static lar_status calibrate(pair *p, lar_error *error) {
    static const double SECTION = 1e-3;
    lar_status status = LAR_OK;
    double took = 0;
    for (p->steps = 1; !status; p->steps *= 2) {
        took = INFINITY;
        for (int i = 0; i < 5 && !status; i++)
            took = fmin(took, lar_bench_time(p->of[LAW], p->steps, &status, error));
        if (took > 0.5 * SECTION) break;
    }
    p->steps = (uint64_t)fmax(1, (double)p->steps * SECTION / took);
    return status;
}

static lar_status take_sample(const pair *p, double elements, double *ratio, double time[BLOCKS],
                              lar_error *error) {
    double section[BLOCKS][SECTIONS], ratios[SECTIONS];
    lar_status status = LAR_OK;
    for (int i = 0; i < SECTIONS && !status; i++) {
        for (int k = 0; k < BLOCKS && !status; k++) {
            int block = i % 2 ? !k : k; /* each of them begins as often */
            section[block][i] = lar_bench_time(p->of[block], p->steps, &status, error);
        }
        ratios[i] = section[LAW][i] / section[BESIDE][i];
    }
    if (status) return status;
    *ratio = lar_spread_of(ratios, SECTIONS).median;
    for (int k = 0; k < BLOCKS; k++)
        time[k] = 1e9 * lar_spread_of(section[k], SECTIONS).median / (double)p->steps / elements;
    return LAR_OK;
}

static lar_status measure(pair *p, int repeat, lar_bench_law_row *row, lar_error *error) {
    double ratio[LAR_BENCH_REPEAT_MAX], time[BLOCKS][LAR_BENCH_REPEAT_MAX];
    lar_status status = calibrate(p, error);
    for (int i = 0; i < repeat && !status; i++) {
        double both[BLOCKS];
        status = take_sample(p, row->elements, &ratio[i], both, error);
        for (int k = 0; k < BLOCKS && !status; k++) time[k][i] = both[k];
    }
    if (status) return status;
    row->ratio = lar_spread_of(ratio, repeat);
    row->beside = lar_spread_of(time[BESIDE], repeat);
    row->nanoseconds = lar_spread_of(time[LAW], repeat);
    return LAR_OK;
}

lar_status lar_bench_law(const lar_bench_kernel_options *options, const char *words,
                         lar_bench_law_row *row, lar_error *error) {
    lar_material material[BLOCKS] = {lar_bench_material()};
    lar_model *model[BLOCKS] = {NULL};
    pair p = {.steps = 1};
    lar_bench_law_row made = {.isa = ""};
    lar_status status = lar_bench_check(options, error);
    if (!status) status = lar_bench_law_material(words, &material[LAW], error);
    if (status) return status;
    lar_bench_edges(options->elements, made.edge);
    made.elements = made.edge[0] * made.edge[1] * made.edge[2];
    snprintf(made.words, sizeof made.words, "%s", words);
    for (int k = 0; k < BLOCKS && !status; k++) {
        status = lar_bench_block_of(made.edge, options->general, &material[k], &model[k], error);
        if (!status) status = lar_bench_start(model[k], options, &p.of[k], error);
    }
    if (!status) {
        made.isa = lar_simulation_isa(p.of[LAW]);
        made.bytes_per_element = (double)lar_simulation_bytes(p.of[LAW]) / made.elements;
        status = measure(&p, options->repeat, &made, error);
    }
    for (int k = 0; k < BLOCKS; k++) {
        lar_simulation_destroy(p.of[k]);
        lar_model_destroy(model[k]);
    }
    if (!status) *row = made;
    return status;
}
