#include "cli/report/run.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cli/parallel.h"
#include "cli/report/mass_scaling.h"
#include "cli/report/elements.h"
#include "base/json/write.h"
#include "base/memory.h"
#include "base/vector.h"

/* Wall time that the simulated time is compared with: the steps, and the waiting between them when
 * they were paced. Writing frames is no part of it unless it had to fit between two ticks. */
static double stepping_time(const run_report *report) {
    return report->clock->paced ? report->elapsed : lar_step_clock_busy(report->clock);
}

/* Of this run's own steps: what it was resumed from took its time elsewhere. 0: none was taken. */
static double real_time_factor(const run_report *report) {
    double steps = (double)report->clock->times.count;
    return steps > 0 ? steps * lar_simulation_time_step(report->simulation) / stepping_time(report)
                     : 0;
}

static double ns_per_element(const run_report *report) {
    double steps = (double)report->clock->times.count;
    return steps > 0 ? 1e9 * lar_step_clock_busy(report->clock) / (steps * report->info.elements)
                     : 0;
}

/* What is missing in the account of this run, and as a share of what is in it: of all that went in
 * or out, since active muscles have a strain energy below zero and a sum of about nothing. */
typedef struct account {
    double open, share;
} account;

static double open_of(const lar_energy *e) {
    return e->kinetic + e->strain + e->hourglass + e->damping + e->contact + e->viscous -
           e->external;
}

static double turnover_of(const lar_energy *e) {
    double terms = fabs(e->kinetic) + fabs(e->strain) + fabs(e->hourglass) + fabs(e->damping) +
                   fabs(e->contact) + fabs(e->viscous);
    return fmax(terms, fabs(e->external));
}

static account account_of(const run_report *report) {
    lar_energy now;
    lar_simulation_energy(report->simulation, &now);
    double open = open_of(&now) - open_of(&report->began), all = turnover_of(&now);
    return (account){open, all > 0 ? fabs(open) / all : 0};
}

/* ---- for machines ----------------------------------------------------------------------- */

static void write_times(lar_json *json, const lar_step_clock *clock) {
    lar_json_open(json, "wall_per_step_us", '{');
    lar_json_number(json, "p50", lar_step_clock_quantile(clock, 0.5));
    lar_json_number(json, "p99", lar_step_clock_quantile(clock, 0.99));
    lar_json_number(json, "p999", lar_step_clock_quantile(clock, 0.999));
    lar_json_number(json, "max", lar_step_clock_longest(clock));
    lar_json_close(json);
}

/* Of what strains the body: how much of it the mean strains do not see. */
static double hourglass_share(const lar_energy *energy) {
    double whole = fabs(energy->strain) + energy->hourglass;
    return whole > 0 ? energy->hourglass / whole : 0;
}

static void write_energy(lar_json *json, const lar_simulation *simulation) {
    lar_energy energy;
    lar_simulation_energy(simulation, &energy);
    lar_json_open(json, "energy", '{');
    lar_json_number(json, "kinetic", energy.kinetic);
    lar_json_number(json, "strain", energy.strain);
    lar_json_number(json, "hourglass", energy.hourglass);
    lar_json_number(json, "hourglass_share", hourglass_share(&energy));
    lar_json_number(json, "external", energy.external);
    lar_json_number(json, "damping", energy.damping);
    lar_json_number(json, "contact", energy.contact);
    lar_json_number(json, "viscous", energy.viscous);
    lar_json_close(json);
}

static void write_account(lar_json *json, const run_report *report) {
    const account now = account_of(report);
    lar_json_open(json, "account", '{');
    lar_json_number(json, "open", now.open);
    lar_json_number(json, "share", now.share);
    lar_json_number(json, "rounding", report->info.rounding);
    lar_json_close(json);
}

/* What the springs of contact store, at most: every one's force is there twice [J]. */
static double stored_by_springs(const run_report *report, double deepest) {
    const int32_t nodes = report->info.nodes;
    double(*force)[3] = lar_calloc((size_t)nodes + 1, sizeof *force), all = 0;
    if (force && !lar_simulation_nodal_forces(report->simulation, LAR_CAUSE_BODIES, 0, force, NULL))
        for (int32_t n = 0; n < nodes; n++) all += lar_length(force[n]);
    free(force);
    return 0.25 * all * deepest;
}

static void write_contact(lar_json *json, const run_report *report) {
    lar_contact_info info;
    lar_simulation_contact(report->simulation, &info);
    int32_t inside = 0;
    lar_simulation_contact_inside(report->simulation, &inside, NULL, NULL);
    lar_json_open(json, "contact", '{');
    lar_json_integer(json, "touching", info.touching);
    lar_json_number(json, "deepest", info.deepest);
    lar_json_number(json, "deepest_ever", info.deepest_ever);
    lar_json_number(json, "distance", lar_simulation_contact_distance(report->simulation));
    lar_json_number(json, "springs", stored_by_springs(report, info.deepest));
    lar_json_integer(json, "through", (int64_t)info.through);
    lar_json_integer(json, "inside", inside);
    lar_json_number(json, "way", info.way);
    lar_json_integer(json, "possible", (int64_t)info.possible);
    lar_json_integer(json, "boxed", (int64_t)info.boxed);
    lar_json_integer(json, "tested", (int64_t)info.tested);
    lar_json_integer(json, "searches", (int64_t)info.searches);
    lar_json_close(json);
}

static void write_flat(lar_json *json, const run_report *report) {
    flat_elements found = {0};
    if (strcmp(report->element, "hex8") == 0)
        found = flat_elements_find(report->simulation, report->model);
    lar_json_open(json, "flat", '{');
    lar_json_integer(json, "elements", found.count);
    lar_json_number(json, "pressure", found.most);
    lar_json_close(json);
}

static void write_crushed(lar_json *json, const run_report *report) {
    const crushed_elements found = crushed_elements_find(report->simulation, report->model);
    lar_json_open(json, "crushed", '{');
    lar_json_integer(json, "elements", found.count);
    lar_json_integer(json, "inside_out", found.inside_out);
    lar_json_number(json, "least", found.least);
    lar_json_close(json);
}

/* Name and force of a tool of the scene or a hand, as of the last step. */
static bool tool_of(const lar_simulation *simulation, int32_t tool, lar_tool_info *info,
                    lar_tool_force *force) {
    return !lar_simulation_tool(simulation, tool, info, NULL) && info->shape != LAR_TOOL_NONE &&
           !lar_simulation_tool_force(simulation, tool, force, NULL);
}

static void write_tools(lar_json *json, const lar_simulation *simulation) {
    lar_json_open(json, "tools", '[');
    for (int32_t i = 0; i < lar_simulation_tool_count(simulation); i++) {
        lar_tool_info info;
        lar_tool_force force;
        if (!tool_of(simulation, i, &info, &force)) continue;
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "tool", info.name);
        lar_json_vector(json, "force", force.force, 3);
        lar_json_vector(json, "torque", force.torque, 3);
        lar_json_number(json, "grasp", force.grasp_force);
        lar_json_integer(json, "touching", force.touching);
        lar_json_integer(json, "held", force.held);
        lar_json_number(json, "depth", force.depth);
        lar_json_number(json, "apart", force.apart);
        lar_json_close(json);
    }
    lar_json_close(json);
}

/* Only what is known. */
static void write_rest(lar_json *json, const run_report *report) {
    const lar_rest *rest = report->rest;
    lar_json_open(json, "rest", '{');
    lar_json_boolean(json, "followed", rest != NULL);
    lar_json_boolean(json, "reached", rest && rest->reached);
    if (rest) {
        double step = lar_simulation_time_step(report->simulation);
        lar_json_number(json, "since", rest->since);
        lar_json_number(json, "limit", step * (double)rest->limit);
        if (rest->strain > 0)
            lar_json_number(json, "kinetic_over_strain", rest->kinetic / rest->strain);
        if (rest->looked) lar_json_number(json, "left", rest->left);
    }
    lar_json_close(json);
}

void run_report_json(const run_report *report, FILE *out) {
    const lar_simulation *simulation = report->simulation;
    int32_t max_parts;
    uint64_t divided = lar_simulation_divided_steps(simulation, &max_parts);
    lar_json json = lar_json_to(out);
    lar_json_text(&json, "title", report->info.title);
    lar_json_integer(&json, "elements", report->info.elements);
    lar_json_integer(&json, "nodes", report->info.nodes);
    lar_json_text(&json, "element", report->element);
    lar_json_integer(&json, "steps", (int64_t)lar_simulation_steps(simulation));
    lar_json_number(&json, "time", lar_simulation_time(simulation));
    lar_json_number(&json, "time_step", lar_simulation_time_step(simulation));
    lar_json_number(&json, "stable_step", report->info.stable_step);
    cli_write_mass_scaling(&json, report->model, &report->info.mass_scaling);
    cli_write_parallel(&json, report->parallel);
    lar_json_integer(&json, "redivisions", (int64_t)lar_simulation_redivisions(simulation));
    lar_json_text(&json, "isa", lar_simulation_isa(simulation));
    lar_json_number(&json, "wall_time", stepping_time(report));
    write_times(&json, report->clock);
    lar_json_number(&json, "ns_per_element", ns_per_element(report));
    lar_json_number(&json, "real_time_factor", real_time_factor(report));
    lar_json_boolean(&json, "realtime", report->clock->paced);
    lar_json_integer(&json, "deadline_misses", (int64_t)report->clock->misses);
    write_energy(&json, simulation);
    write_account(&json, report);
    write_contact(&json, report);
    write_flat(&json, report);
    write_crushed(&json, report);
    write_tools(&json, simulation);
    write_rest(&json, report);
    lar_json_integer(&json, "divided_steps", (int64_t)divided);
    lar_json_integer(&json, "most_parts", max_parts);
    cli_write_heavier(&json, simulation);
    lar_json_hash(&json, "state_hash", lar_simulation_hash(simulation));
    lar_json_boolean(&json, "verify", report->verify);
    lar_json_integer(&json, "frames", report->frames);
    lar_json_boolean(&json, "interrupted", report->interrupted);
    lar_json_end(&json);
}

/* ---- for people ------------------------------------------------------------------------- */

/* What is written with two digits and no more than it is: a step that does what is said of it. */
static double two_digits_of(double step) {
    double digit = pow(10, floor(log10(step)) - 1), down = floor(step / digit * (1 + 1e-9));
    return step > 0 ? down * digit : step;
}

static void print_division(const lar_parallel *parallel, FILE *out) {
    bool local = strcmp(parallel->scheme, "local") == 0;
    bool several = parallel->threads > 1;
    fprintf(out, "%-17s%s: %d processor%s", "grid", parallel->grid, (int)parallel->processors,
            parallel->processors == 1 ? "" : "s");
    if (several) fprintf(out, " of %d threads", (int)parallel->threads);
    fprintf(out, ", scheme %s%s%s, by %s\n", parallel->scheme, local ? ", channels " : "",
            local ? parallel->channels : "", parallel->comm);
}

/* Lengths of a body in metres are told in millimetres; those of a deck in its own unit, which is
 * called metre here, where its elements are larger than a finger. */
typedef struct length_unit {
    double per_metre;
    const char *name;
} length_unit;

static length_unit unit_of(const run_report *report) {
    static const double FINGER = 0.1; /* [m] */
    return report->info.shortest_edge > FINGER ? (length_unit){1, "m"} : (length_unit){1e3, "mm"};
}

/* Nothing where all went well. */
static void print_through(const run_report *report, const lar_contact_info *info, FILE *out) {
    static const double FAR = 0.5; /* of the shortest edge */
    const length_unit unit = unit_of(report);
    double step = lar_simulation_time_step(report->simulation);
    if (info->through > 0)
        fprintf(out,
                "%-17sTHROUGH: %" PRIu64 " times a node was pressed through a face: bodies lie in "
                "each other, or behind; --time-step %.2g makes contact four times as hard, and "
                "may be faster than steps that are divided\n",
                "", info->through, two_digits_of(0.5 * step));
    if (info->way > FAR * report->info.shortest_edge)
        fprintf(out,
                "%-17sa node went %.3g %s in a step, where the shortest edge is %.3g %s: contact "
                "may not see it in time; --time-step %.2g would\n",
                "", unit.per_metre * info->way, unit.name,
                unit.per_metre * report->info.shortest_edge, unit.name,
                two_digits_of(0.25 * step * report->info.shortest_edge / info->way));
}

/* Bodies lie in each other, and nothing keeps them apart. */
static void print_inside(const run_report *report, FILE *out) {
    int32_t count = 0, node = -1;
    if (lar_simulation_contact_inside(report->simulation, &count, &node, NULL) || count == 0)
        return;
    fprintf(out,
            "%-17sINSIDE: %d nodes lie inside another body, where contact does not see them, such "
            "as node %lld: they came in past the end of its faces or from behind, and forces are "
            "too small; let contact have all faces of both bodies, or take smaller steps\n",
            "", (int)count, (long long)lar_model_node_id(report->model, node));
}

/* Of a body that is back at its shape, or flies, what is left is a share of nothing. */
static bool is_nothing(const run_report *report, const lar_energy *energy) {
    static const double NOTHING = 1e-3;
    double all = fmax(turnover_of(energy), turnover_of(&report->began));
    return energy->strain + energy->hourglass < NOTHING * all;
}

/* What is let in is missing in the force: contact is as hard as a step bears (docs/theory.md,
 * "Contact"), so a shorter one lets in less. Of an impact nothing may be left in the last step. */
static void print_softness(const run_report *report, const lar_energy *energy,
                           const lar_contact_info *info, FILE *out) {
    static const double MUCH = 0.05,
                        SPRINGS = 0.1; /* of the shortest edge, and of what is stored */
    const length_unit unit = unit_of(report);
    const double edge = report->info.shortest_edge, part = info->deepest / edge;
    const double step = two_digits_of(0.5 * lar_simulation_time_step(report->simulation));
    const double stored = energy->strain + energy->hourglass;
    if (info->deepest_ever > fmax(MUCH * edge, 1.5 * info->deepest))
        fprintf(out,
                "%-17sbefore, up to %.3g %s deep, %.2g of the shortest edge: forces were less then "
                "than those of bodies that only touch, and peaks of them may be much too low; "
                "--time-step %.2g lets in a quarter of it\n",
                "", unit.per_metre * info->deepest_ever, unit.name, info->deepest_ever / edge,
                step);
    if (part > MUCH) {
        fprintf(out,
                "%-17s%.2g of the shortest edge: forces are less than those of bodies that only "
                "touch; --time-step %.2g lets in a quarter of it, but at edges, where only "
                "smaller elements help\n",
                "", part, step);
        return;
    }
    if (!(energy->strain > 0) || is_nothing(report, energy)) return;
    const double springs = stored_by_springs(report, info->deepest) / stored;
    if (springs > SPRINGS)
        fprintf(out,
                "%-17sits springs store up to %.2g of what the bodies do: where these are moved "
                "onto each other, forces are less than those of bodies that only touch, and what "
                "lies on another one sinks in; --time-step %.2g lets in a quarter of it\n",
                "", springs, step);
}

/* Nothing where nothing came close, nor where a scene has tools alone, which have lines of their
 * own. */
static void print_contact(const run_report *report, const lar_energy *energy, FILE *out) {
    const lar_simulation *simulation = report->simulation;
    const length_unit unit = unit_of(report);
    lar_contact_info info;
    lar_simulation_contact(simulation, &info);
    if (info.tested == 0 || lar_model_contact_count(report->model) == 0) {
        print_through(report, &info, out);
        return;
    }
    double steps = fmax(1, (double)info.steps);
    fprintf(out,
            "%-17s%d nodes touch, at most %.3g %s deep; %" PRIu64
            " searches, %.3g of %.3g pairs looked at in a step\n",
            "contact", (int)info.touching, unit.per_metre * info.deepest, unit.name, info.searches,
            (double)info.tested / steps, (double)info.possible / steps);
    const double distance = lar_simulation_contact_distance(simulation);
    if (distance > 0)
        fprintf(out,
                "%-17sbodies push each other from %.2g %s on, before they touch: gaps that matter "
                "take a smaller distance in the contact, or bodies that touch at rest\n",
                "", unit.per_metre * distance, unit.name);
    print_softness(report, energy, &info, out);
    print_through(report, &info, out);
    print_inside(report, out);
}

/* A tool's springs are in line with tissue, and where its volume may change they are no harder than
 * its elements (docs/theory.md, tools). */
static void print_depth(const run_report *report, const lar_tool_info *info,
                        const lar_tool_force *force, const lar_energy *energy, FILE *out) {
    static const double MUCH = 0.1; /* radii, and of what is stored in the bodies */
    const length_unit unit = unit_of(report);
    const double *f = force->force, deep = force->depth / info->radius;
    double springs = 0.5 * sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) * force->depth;
    if (!(force->depth > 0)) return;
    if (!(deep > MUCH || springs > MUCH * (energy->strain + energy->hourglass))) return;
    fprintf(out,
            "%-17stissue is %.2g %s deep in it, %.2g of its radius: the force is less than that "
            "of a hard tool; half the step, --time-step %.2g, shows how much\n",
            "", unit.per_metre * force->depth, unit.name, deep,
            two_digits_of(0.5 * lar_simulation_time_step(report->simulation)));
}

/* Nothing of tools that neither touch nor hold, and are where they are led. */
static void print_tools(const run_report *report, const lar_energy *energy, FILE *out) {
    static const double LATE = 0.1; /* radii */
    const lar_simulation *simulation = report->simulation;
    const length_unit unit = unit_of(report);
    for (int32_t i = 0; i < lar_simulation_tool_count(simulation); i++) {
        lar_tool_info info;
        lar_tool_force force;
        if (!tool_of(simulation, i, &info, &force)) continue;
        const bool moves = info.shape == LAR_TOOL_RIGID;
        const bool late = force.limited && force.apart > LATE * info.radius;
        if (force.touching == 0 && force.held == 0 && !moves && !late) continue;
        const double *f = force.force, *t = force.torque;
        fprintf(out, "%-17s%s: %.3g N", "tool", info.name,
                sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]));
        if (force.grasp_force > 0) fprintf(out, ", jaws grasp with %.3g N", force.grasp_force);
        if (moves)
            fprintf(out, " and %.3g N m on the nodes that it moves",
                    sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]));
        if (force.held > 0) fprintf(out, ", holds %d points", (int)force.held);
        if (late)
            fprintf(out, ", kept %.3g %s from where it is led", unit.per_metre * force.apart,
                    unit.name);
        fputc('\n', out);
        print_depth(report, &info, &force, energy, out);
    }
}

/* Nothing where steps stayed whole. */
static void print_parts(const lar_simulation *simulation, FILE *out) {
    int32_t max;
    uint64_t divided = lar_simulation_divided_steps(simulation, &max);
    if (divided > 0)
        fprintf(out, "%-17s%" PRIu64 " steps, into %d parts at most\n", "divided", divided,
                (int)max);
    cli_print_heavier(simulation, out);
    cli_print_redivisions(simulation, out);
}

static void print_rest(const run_report *report, FILE *out) {
    const lar_rest *rest = report->rest;
    if (!rest) return;
    fprintf(out, "%-17s%s; loads constant from %.4g s", "rest", rest->reached ? "yes" : "NO",
            rest->since);
    if (rest->strain > 0)
        fprintf(out, ", kinetic over strain energy %.2g", rest->kinetic / rest->strain);
    if (rest->looked)
        fprintf(out, ", motion to come %.2g (at rest: %.0e)", rest->left, rest->share);
    fputc('\n', out);
}

/* A step that was too long for what happened shows in the account before it shows anywhere else. */
static void print_open_account(const run_report *report, FILE *out) {
    static const double SMALL = 0.01;
    double time_step = lar_simulation_time_step(report->simulation);
    const account now = account_of(report);
    if (!(now.share > SMALL)) return;
    /* What is missing goes with the square of the step, or slower. */
    double shorter = fmin(0.25, 0.5 * sqrt(SMALL / now.share));
    if (fabs(now.open) <= report->info.rounding)
        fprintf(out, "%-17sopen by no more than rounding makes of strain energy here (%.1g J)\n",
                "account", report->info.rounding);
    else
        fprintf(out,
                "%-17sOPEN by %.2g J, %.2g %% of what is in it: something was faster than the "
                "steps; slower loads or --time-step %.2g close it\n",
                "account", now.open, 100 * now.share, two_digits_of(shorter * time_step));
}

/* Where they may have folded nothing else is to be said: they take few hourglass modes for that. */
static bool print_flat(const run_report *report, const lar_energy *energy, FILE *out) {
    if (strcmp(report->element, "hex8") != 0 || is_nothing(report, energy)) return false;
    const flat_elements found = flat_elements_find(report->simulation, report->model);
    if (found.count > 0)
        fprintf(out,
                "%-17s%d of nearly incompressible tissue are under up to %.2g times its shear "
                "modulus of pressure and more than 5 times as wide as thick: they may fold in a "
                "zigzag, which bears too little; make them less flat, by fewer through the "
                "thickness or more along it\n",
                "flat elements", (int)found.count, found.most);
    return found.count > 0;
}

/* Where hourglass modes bear much, the mesh answers and not the tissue. */
static void print_hourglass(const run_report *report, const lar_energy *energy, FILE *out) {
    static const double MUCH = 0.1;
    /* Where muscles have shortened, strain energy is below zero or near it: a part of nothing. */
    if (energy->strain < 0 || !(hourglass_share(energy) > MUCH)) return;
    if (is_nothing(report, energy)) return;
    fprintf(out,
            "%-17s%.3g %% of strain and hourglass energy: the mesh is too coarse for how it is "
            "bent or crushed; give it two or more elements through the thickness, or twice as "
            "many where it has them\n",
            "hourglass", 100 * hourglass_share(energy));
}

/* A corner that has hardly any volume is kept from having none by its barrier, which is no tissue.
 */
static void print_crushed(const run_report *report, FILE *out) {
    static const double MANY = 0.25; /* of all elements */
    const crushed_elements found = crushed_elements_find(report->simulation, report->model);
    if (!(found.inside_out > 0 || found.count > MANY * report->info.elements)) return;
    fprintf(out, "%-17s%d element%s a corner with less than a fifth of its volume at rest",
            "crushed", (int)found.count, found.count == 1 ? " has" : "s have");
    if (found.inside_out > 0) fprintf(out, ", %d of them inside out", (int)found.inside_out);
    fprintf(out,
            ", down to %.2g near (%.4g, %.4g, %.4g) m: there barriers push back and not the tissue "
            "alone, so forces are too high; smaller loads, or a finer mesh\n",
            found.least, found.at[0], found.at[1], found.at[2]);
}

static void print_body(const run_report *report, FILE *out) {
    lar_energy energy;
    lar_simulation_energy(report->simulation, &energy);
    fprintf(out, "%-17skinetic %.4g, strain %.4g, hourglass %.4g, damping %.4g", "energy [J]",
            energy.kinetic, energy.strain, energy.hourglass, energy.damping);
    if (energy.contact != 0) fprintf(out, ", contact %.4g", energy.contact);
    if (energy.viscous != 0) fprintf(out, ", viscous %.4g", energy.viscous);
    fprintf(out, "; external %.4g\n", energy.external);
    if (!print_flat(report, &energy, out)) print_hourglass(report, &energy, out);
    print_crushed(report, out);
    print_open_account(report, out);
    print_contact(report, &energy, out);
    print_tools(report, &energy, out);
    print_parts(report->simulation, out);
    print_rest(report, out);
    fprintf(out, "%-17s%016" PRIx64 "\n", "state hash", lar_simulation_hash(report->simulation));
}

static void print_pace(const run_report *report, FILE *out) {
    const lar_step_clock *clock = report->clock;
    double factor = real_time_factor(report);
    fprintf(out, "%-17s%.4g s", "wall time", stepping_time(report));
    if (clock->paced)
        fprintf(out, ", paced; %" PRIu64 " of %" PRIu64 " steps ended after their tick\n",
                clock->misses, clock->times.count);
    else if (factor > 0)
        fprintf(out, ", %.3g times as fast as real time\n", factor);
    else
        fputc('\n', out);
}

void run_report_steps(double p50, double p99, double p999, double longest, FILE *out) {
    const bool large = p50 >= 999.5;
    const double unit = large ? 1000 : 1;
    fprintf(out, "%-17smedian %.4g %s, 99 %% below %.4g, 99.9 %% below %.4g, longest %.*f\n",
            "a step", p50 / unit, large ? "ms" : "us", p99 / unit, p999 / unit,
            longest / unit < 10    ? 2
            : longest / unit < 100 ? 1
                                   : 0,
            longest / unit);
}

void run_report_table(const run_report *report, FILE *out) {
    const lar_simulation *simulation = report->simulation;
    const lar_step_clock *clock = report->clock;
    bool titled = *report->info.title != '\0';
    fprintf(out, "%s: %d elements, %d nodes (%s, %s)\n",
            titled ? report->info.title : report->scene, (int)report->info.elements,
            (int)report->info.nodes, report->element, lar_simulation_isa(simulation));
    if (report->parallel->divided) print_division(report->parallel, out);
    cli_print_reason(report->parallel, out);
    fprintf(out, "%-17s%.6g s in %" PRIu64 " steps of %.4g s%s\n", "simulated",
            lar_simulation_time(simulation), lar_simulation_steps(simulation),
            lar_simulation_time_step(simulation), report->interrupted ? ", interrupted" : "");
    cli_print_mass_scaling(report->model, &report->info.mass_scaling, false, out);
    print_pace(report, out);
    if (clock->times.count > 0) {
        run_report_steps(lar_step_clock_quantile(clock, 0.5), lar_step_clock_quantile(clock, 0.99),
                         lar_step_clock_quantile(clock, 0.999), lar_step_clock_longest(clock), out);
        fprintf(out, "%-17s%.4g ns on average\n", "an element", ns_per_element(report));
    }
    if (report->verify)
        fprintf(out, "%-17severy force arrived at its nodes once, in every step; nothing moved\n",
                "verified");
    else
        print_body(report, out);
    if (report->folder)
        fprintf(out, "%-17s%s: %d frame%s, .pvd, probes.csv, .checkpoint, run.json\n", "results",
                report->folder, report->frames, report->frames == 1 ? "" : "s");
}
