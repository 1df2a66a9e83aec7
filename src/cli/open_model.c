#include <math.h>
#include <string.h>
#include <strings.h>

#include "cli/commands.h"
#include "cli/stop.h"
#include "study/processes.h"

const char *const cli_element_names[] = {"hex8", "hex8-full", "hex8-matrix", NULL};
const char *const cli_isa_names[] = {"auto", "c", "neon", "avx2", "avx512", NULL};

int cli_refuse(const cli_command *command, const lar_error *error) {
    if (cli_stop_asked && lar_processes_interrupted(error))
        return cli_complain(command, CLI_INTERRUPTED, "interrupted");
    int status = error->status == LAR_ERROR_ARGUMENT   ? CLI_USAGE
                 : error->status == LAR_ERROR_UNSTABLE ? CLI_UNSTABLE
                                                       : CLI_FAILED;
    return cli_complain(command, status, "%s", error->message);
}

int cli_resume_options(const cli_command *command, const char *path, const lar_model *model,
                       lar_options *options) {
    lar_checkpoint_info info;
    lar_error error;
    if (!path) return CLI_DONE;
    if (lar_checkpoint_inspect(path, &info, &error))
        return cli_complain(command, CLI_FAILED, "%s", error.message);
    lar_model_info here;
    if (lar_model_inspect(model, &here, &error) == LAR_OK &&
        (here.nodes != info.nodes || here.elements != info.elements))
        return cli_complain(command, CLI_FAILED,
                            "%s: was saved from another model: it has %d elements and %d nodes, "
                            "this one %lld and %lld; load it into the model that it was saved from",
                            path, (int)info.elements, (int)info.nodes, (long long)here.elements,
                            (long long)here.nodes);
    if (options->time_step == 0) options->time_step = info.time_step;
    if (options->element == LAR_ELEMENT_HEX8) options->element = info.element;
    int32_t hands = info.tools - lar_model_tool_count(model);
    options->hands = hands > 0 ? hands : 0;
    if (options->spares < info.spares) options->spares = info.spares;
    return CLI_DONE;
}

int cli_open_model(const cli_command *command, const char *path, lar_model **model) {
    lar_error error;
    if (lar_model_open(path, model, &error))
        return cli_complain(command, CLI_FAILED, "%s", error.message);
    for (int32_t i = 0; cli_speaker() == 0 && i < lar_model_notice_count(*model); i++)
        cli_complain(command, CLI_DONE, "note: %s", lar_model_notice_text(*model, i));
    return CLI_DONE;
}

static const double LARGE = 10, SMALL = 1e-3; /* [m] */

static double longest_side(const lar_model_info *info) {
    double size = 0;
    for (int i = 0; i < 3; i++) size = fmax(size, info->upper[i] - info->lower[i]);
    return size;
}

/* A mesh in millimetres is the commonest slip, and one that is scaled twice the next. */
static void doubt_length(const cli_command *command, const lar_model_info *info) {
    double size = longest_side(info);
    if (size > LARGE)
        cli_complain(command, CLI_DONE,
                     "note: the model is %.4g m long; if the mesh is in millimetres, read it "
                     "through a scene with scale: 0.001",
                     size);
    if (size < SMALL)
        cli_complain(command, CLI_DONE,
                     "note: the model is %.4g mm long; lengths are metres: was it scaled twice?",
                     1e3 * size);
}

/* Grams and millimetres, kilopascals and megapascals: outside of what there is in bodies, and of
 * what they are tested with (foams, steel). */
static bool doubt_material(const cli_command *command, const lar_material_info *material) {
    static const double LIGHT = 10, HEAVY = 3e4; /* [kg/m^3] */
    static const double SOFT = 10, HARD = 1e12;  /* [Pa] */
    bool dense = material->density < LIGHT || material->density > HEAVY;
    const char *name = material->name[0] ? material->name : "without a name";
    bool stiff = material->shear_modulus < SOFT || material->shear_modulus > HARD;
    if (dense)
        cli_complain(command, CLI_DONE,
                     "note: material %s has a density of %.4g; densities are in kg/m^3, water "
                     "has 1000",
                     name, material->density);
    if (stiff)
        cli_complain(command, CLI_DONE,
                     "note: material %s has a shear modulus of %.4g; moduli are in pascals, soft "
                     "organs have some thousand",
                     name, material->shear_modulus);
    return dense || stiff;
}

/* A deck is in units of its own, often none at all, and its answer is right in these; a mesh alone
 * in an .inp, whose tissue has no name, is in metres as any other. */
static bool is_deck(const char *path, const lar_model *model) {
    const char *ending = strrchr(path, '.');
    lar_material_info material;
    if (!ending) return false;
    if (strcasecmp(ending, ".feb") == 0) return true;
    return strcasecmp(ending, ".inp") == 0 &&
           lar_model_material(model, 0, &material, NULL) == LAR_OK && material.name[0];
}

static void doubt_deck(const cli_command *command, const lar_model_info *info) {
    double size = longest_side(info);
    if (size > LARGE || size < SMALL)
        cli_complain(command, CLI_DONE,
                     "note: the deck has no units, and the model is %.4g long: Lariat computes in "
                     "the deck's own, and what it calls m, kg, s and Pa are these",
                     size);
}

void cli_doubt_units(const cli_command *command, const char *path, const lar_model *model,
                     const lar_model_info *info) {
    if (is_deck(path, model)) {
        doubt_deck(command, info);
        return;
    }
    doubt_length(command, info);
    bool doubted = false;
    for (int32_t i = 0; i < info->materials && !doubted; i++) {
        lar_material_info material;
        doubted = lar_model_material(model, i, &material, NULL) == LAR_OK &&
                  doubt_material(command, &material);
    }
}
