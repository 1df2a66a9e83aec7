/* FEBio decks: sections, control, entry points. See feb.h. */
#include "model/format/feb/feb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/format/mesh_io.h"
#include "model/rest.h"

/* ---- control --------------------------------------------------------------------------------- */

static lar_status read_duration(lar_feb *feb, const xmlNode *control) {
    const xmlNode *steps = lar_feb_child(control, "time_steps");
    const xmlNode *size = lar_feb_child(control, "step_size");
    double count, seconds;
    if (!steps || !size)
        return lar_feb_notice(feb, control,
                              "<time_steps> or <step_size> is missing: the run has no set end");
    lar_status status = lar_feb_doubles(feb, steps, &count, 1);
    if (!status) status = lar_feb_doubles(feb, size, &seconds, 1);
    if (status) return status;
    double duration = count * seconds;
    if (!(duration > 0.0) || !isfinite(duration))
        return lar_feb_fail(feb, control, LAR_ERROR_MODEL,
                            "time_steps %g times step_size %g is no duration; make both positive",
                            count, seconds);
    feb->model->duration = duration;
    feb->first_step = seconds;
    return LAR_OK;
}

/* What FEBio has there in its versions; what says how a solver goes about it is not read. */
static lar_status check_control(lar_feb *feb, const xmlNode *control) {
    static const char known[] =
        "analysis time_steps step_size time_stepper solver plot_zero_state plot_range plot_level "
        "plot_stride output_level output_stride print_level adaptor_re_solve "
        "alpha arc_length arc_length_scale beta check_zero_diagonal cmax cycle_buffer "
        "diverge_reform dtol equation_order equation_scheme etol force_partition gamma "
        "linear_solver logSolve lsiter lsmin lstol max_buffer_size max_refs max_residual max_ups "
        "min_residual optimize_bw pressure_stiffness qn_method qnmethod reform_augment "
        "reform_each_time_step restart rhoi rtol symmetric_stiffness title zero_diagonal_tol";
    return lar_feb_notice_others(feb, control, known);
}

/* FEBio's explicit solver has inertia whatever <analysis> says. */
static bool is_explicit(lar_feb *feb, const xmlNode *control) {
    const xmlNode *by[] = {lar_feb_child(feb->root, "Module"),
                           control ? lar_feb_child(control, "solver") : NULL};
    for (int i = 0; i < 2; i++) {
        const char *type = by[i] ? lar_feb_attribute(feb, by[i], "type") : NULL;
        if (type && strcmp(type, "explicit-solid") == 0) return true;
    }
    return false;
}

/* The word in <analysis>, or in its attribute type. */
static lar_status read_analysis(lar_feb *feb, const xmlNode *control) {
    const xmlNode *analysis = control ? lar_feb_child(control, "analysis") : NULL;
    feb->is_static = !is_explicit(feb, control); /* FEBio's default */
    if (!analysis) return LAR_OK;
    const char *type = lar_feb_attribute(feb, analysis, "type");
    lar_span word = type ? (lar_span){type, strlen(type)} : lar_feb_text(feb, analysis);
    if (lar_span_equal_nocase(word, "STATIC") || lar_span_equal(word, "0"))
        return feb->is_static
                   ? LAR_OK
                   : lar_feb_notice(feb, analysis,
                                    "the explicit solver has inertia: the deck is dynamic");
    feb->is_static = false;
    if (lar_span_equal_nocase(word, "DYNAMIC") || lar_span_equal(word, "1")) return LAR_OK;
    return lar_feb_fail(feb, analysis, LAR_ERROR_UNSUPPORTED,
                        "the analysis '%.*s' is not read; Lariat does DYNAMIC and STATIC",
                        (int)(word.length < 40 ? word.length : 40), word.at);
}

/* What an analysis without time becomes: see model/rest.h. */
static lar_status finish_static(lar_feb *feb, const xmlNode *control) {
    if (!feb->is_static) return LAR_OK;
    lar_rest_words words = lar_model_follow_static(feb->model, "analysis");
    return lar_feb_notice(feb, control ? control : feb->root, "%s", words.text);
}

/* Of the solver's settings one is physics: the explicit solver can damp by a factor per step. */
static lar_status notice_solver_damping(lar_feb *feb, const xmlNode *control) {
    const xmlNode *solver = control ? lar_feb_child(control, "solver") : NULL;
    const xmlNode *damping = solver ? lar_feb_child(solver, "dyn_damping") : NULL;
    double factor = 1.0;
    lar_status status = damping ? lar_feb_doubles(feb, damping, &factor, 1) : LAR_OK;
    if (status || factor == 1.0) return status;
    return lar_feb_notice(feb, damping, "<dyn_damping> %g was left out", factor);
}

/* ---- sections -------------------------------------------------------------------------------- */

/* Sections that are read elsewhere, or whose content does not change the answer; within a step only
 * its own <Control> is. */
static bool is_harmless(const lar_feb *feb, const xmlNode *section) {
    if (section->parent != feb->root) return lar_feb_is_any(section, "Control Output");
    return lar_feb_is_any(section, "Module Control Globals Material Mesh LoadData Output "
                                   "MeshDomains Step");
}

/* Sections that change the answer as soon as something stands in them. */
static const char *refusal(const xmlNode *section) {
    static const struct {
        const char *name, *what;
    } refused[] = {
        {"Constraints", "constraints, which Lariat does not read; remove the section"},
        {"Discrete", "springs and other discrete elements, which Lariat does not do; remove the "
                     "section"},
        {"MeshAdaptor", "mesh adaption, which Lariat does not do; remove the section"},
        {"Include", "a part of the deck in another file, which Lariat does not open; put it into "
                    "this one"},
    };
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
        if (lar_feb_is(section, refused[i].name)) return refused[i].what;
    return NULL;
}

static lar_status check_section(lar_feb *feb, const xmlNode *section) {
    const xmlNode *content = lar_feb_first(section);
    const char *what = refusal(section);
    if (what && (content || lar_feb_is(section, "Include"))) {
        const char *type = content ? lar_feb_attribute(feb, content, "type") : NULL;
        return lar_feb_fail(feb, content ? content : section, LAR_ERROR_UNSUPPORTED,
                            "<%s>%s%.60s%s asks for %s",
                            (const char *)(content ? content : section)->name,
                            type ? " of type '" : "", type ? type : "", type ? "'" : "", what);
    }
    const bool known = lar_feb_is_any(section, "Boundary Loads Initial Contact Rigid MeshData");
    if (what || is_harmless(feb, section) || (known && !content)) return LAR_OK;
    if (lar_feb_is(section, "Boundary")) return lar_feb_read_boundary(feb, section);
    if (lar_feb_is(section, "Loads")) return lar_feb_read_loads(feb, section);
    if (lar_feb_is(section, "Initial")) return lar_feb_read_initial(feb, section);
    if (lar_feb_is(section, "Contact")) return lar_feb_read_contact(feb, section);
    if (lar_feb_is(section, "Rigid")) return lar_feb_read_rigid(feb, section);
    if (lar_feb_is(section, "MeshData")) {
        while (content && lar_feb_is_direction(feb, content)) content = lar_feb_next(content);
        if (!content) return LAR_OK; /* read with the materials */
        return lar_feb_notice(feb, section,
                              "<MeshData> was left out but for directions of fibres; a value that "
                              "refers to it is refused where it stands");
    }
    return lar_feb_notice(feb, section, "the section <%s> is not known and was left out",
                          (const char *)section->name);
}

static lar_status read_sections(lar_feb *feb, const xmlNode *parent) {
    lar_status status = LAR_OK;
    for (xmlNode *section = lar_feb_first(parent); section && !status;
         section = lar_feb_next(section))
        status = check_section(feb, section);
    return status;
}

static lar_status check_module(lar_feb *feb) {
    const xmlNode *module = lar_feb_child(feb->root, "Module");
    const char *type = module ? lar_feb_attribute(feb, module, "type") : NULL;
    if (!type || strcmp(type, "solid") == 0 || strcmp(type, "explicit-solid") == 0) return LAR_OK;
    return lar_feb_fail(feb, module, LAR_ERROR_UNSUPPORTED,
                        "the module '%.60s' is not read; Lariat does solid mechanics, module "
                        "solid",
                        type);
}

/* Sections are read once by name; a second one would be lost. */
static lar_status check_single(lar_feb *feb) {
    static const char *const names[] = {"Module", "Control",  "Material",   "Mesh",
                                        "Step",   "LoadData", "MeshDomains"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const xmlNode *section = lar_feb_child(feb->root, names[i]);
        const xmlNode *more = section ? lar_feb_next(section) : NULL;
        while (more && !lar_feb_is(more, names[i])) more = lar_feb_next(more);
        if (more)
            return lar_feb_fail(feb, more, LAR_ERROR_UNSUPPORTED,
                                "a second <%s> section; Lariat reads one, join the two", names[i]);
    }
    return LAR_OK;
}

/* The only <step> of the deck, NULL without any. A single step is read as if what it holds stood
 * in the deck itself; several are another analysis each. */
static lar_status find_step(lar_feb *feb, const xmlNode **step) {
    const xmlNode *section = lar_feb_child(feb->root, "Step");
    *step = section ? lar_feb_first(section) : NULL;
    const xmlNode *second = *step ? lar_feb_next(*step) : NULL;
    if (!*step) return LAR_OK;
    if (second)
        return lar_feb_fail(feb, second, LAR_ERROR_UNSUPPORTED,
                            "the deck has several steps, of which Lariat does not know how to "
                            "change conditions in between; keep one");
    if (!lar_feb_is(*step, "step"))
        return lar_feb_fail(feb, *step, LAR_ERROR_FORMAT,
                            "<%s> stands in <Step>; only <step> belongs there",
                            (const char *)(*step)->name);
    const xmlNode *control = lar_feb_child(*step, "Control");
    if (control && lar_feb_child(feb->root, "Control"))
        return lar_feb_fail(feb, control, LAR_ERROR_UNSUPPORTED,
                            "a second <Control>, of a step, besides that of the deck, which is a "
                            "step of its own; keep one");
    return LAR_OK;
}

/* Domains that are no solids have elements of other types. What a domain says of its elements is
 * left out but for <laugon>, which belongs to the material. */
static lar_status check_domains(lar_feb *feb) {
    const xmlNode *section = lar_feb_child(feb->root, "MeshDomains");
    xmlNode *domain = section ? lar_feb_first(section) : NULL;
    lar_status status = LAR_OK;
    for (; domain && !status; domain = lar_feb_next(domain)) {
        const char *type = lar_feb_attribute(feb, domain, "type");
        if (!lar_feb_is(domain, "SolidDomain"))
            return lar_feb_fail(feb, domain, LAR_ERROR_UNSUPPORTED,
                                "<%s> is not read; Lariat computes solids",
                                (const char *)domain->name);
        if (type && strcmp(type, "elastic-solid") != 0 && strcmp(type, "three-field-solid") != 0)
            status =
                lar_feb_notice(feb, domain,
                               "the domain type '%.60s' was left out; Lariat computes with its "
                               "own elements",
                               type);
        if (!status) status = lar_feb_notice_others(feb, domain, "");
    }
    return status;
}

/* ---- the whole ------------------------------------------------------------------------------- */

static bool has_weight(const xmlNode *parent) {
    const xmlNode *loads = lar_feb_child(parent, "Loads");
    return loads && lar_feb_child(loads, "body_load");
}

static lar_status read_model(lar_feb *feb) {
    const xmlNode *step = NULL;
    lar_status status = lar_feb_refuse_files(feb, feb->root);
    if (!status) status = check_module(feb);
    if (!status) status = check_single(feb);
    if (!status) status = check_domains(feb);
    if (!status) status = find_step(feb, &step);
    const xmlNode *control = step ? lar_feb_child(step, "Control") : NULL;
    if (!control) control = lar_feb_child(feb->root, "Control");
    if (!status) status = read_analysis(feb, control);
    feb->weightless = feb->is_static && !has_weight(feb->root) && !(step && has_weight(step));
    if (!status) status = lar_feb_list_materials(feb);
    if (!status) status = lar_feb_read_mesh(feb);
    if (!status) lar_mesh_turn(feb->mesh);
    if (!status) status = lar_mesh_check(feb->mesh, feb->error);
    if (!status) status = lar_feb_read_materials(feb);
    if (status) return status;
    if (control) status = check_control(feb, control);
    if (!status && control) status = read_duration(feb, control);
    if (!status) status = notice_solver_damping(feb, control);
    if (!status) status = lar_feb_read_curves(feb);
    if (!status) status = lar_feb_read_activation(feb);
    if (!status) status = read_sections(feb, feb->root);
    if (!status && step) status = read_sections(feb, step);
    if (!status) status = lar_feb_hold_rigid(feb);
    if (!status) status = lar_feb_notice_attributes(feb, feb->root);
    if (!status) status = finish_static(feb, control);
    if (!status) status = lar_feb_weigh_rigid(feb);
    return status ? status : lar_model_check(feb->model, feb->error);
}

lar_status lar_feb_parse(const char *path, const lar_bytes *bytes, lar_model **model,
                         lar_error *error) {
    lar_feb feb = {0};
    lar_status status = lar_feb_open(&feb, path, bytes, error);
    lar_model *fresh = status ? NULL : lar_model_create();
    if (!status && fresh) {
        fresh->source = lar_strdup(path);
        fresh->own_units = true;
        feb.model = fresh;
        feb.mesh = &fresh->mesh;
        status = fresh->source ? read_model(&feb) : lar_feb_no_memory(&feb, "the model");
    } else if (!status) {
        status = lar_feb_no_memory(&feb, "the model");
    }
    lar_feb_clear(&feb);
    if (status)
        lar_model_destroy(fresh);
    else
        *model = fresh;
    return status;
}

lar_status lar_feb_read(const char *path, lar_model **model, lar_error *error) {
    lar_bytes bytes = {0};
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (!status) status = lar_feb_parse(path, &bytes, model, error);
    lar_bytes_free(&bytes);
    return status;
}

lar_status lar_feb_parse_mesh(const char *path, const lar_bytes *bytes, lar_mesh *mesh,
                              lar_error *error) {
    lar_feb feb = {0};
    feb.mesh = mesh;
    lar_status status = lar_feb_open(&feb, path, bytes, error);
    if (!status) status = lar_feb_list_materials(&feb);
    if (!status) status = lar_feb_read_mesh(&feb);
    lar_feb_clear(&feb);
    return status;
}
