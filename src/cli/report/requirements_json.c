#include <stddef.h>
#include <stdio.h>

#include "cli/report/json.h"
#include "cli/report/requirements.h"

static void write_quantities(json_writer *json, const char *name, const lar_quantities *q) {
    json_open(json, name, '{');
    json_number(json, "n_el", q->n_el);
    json_number(json, "n_k", q->n_k);
    json_number(json, "n_eav", q->n_eav);
    json_number(json, "df_el", q->df_el);
    json_number(json, "df_eav", q->df_eav);
    json_number(json, "df_g", lar_freedoms(q));
    json_number(json, "n_int", q->n_int);
    json_number(json, "n_it", q->n_it);
    json_number(json, "dt_im", q->step_im);
    json_number(json, "dt_ex", q->step_ex);
    json_number(json, "n_p", q->n_p);
    json_number(json, "n_pav", q->n_pav);
    json_close(json);
}

static void write_rows(json_writer *json, const char *name,
                       const lar_formula_row row[LAR_FORMULA_ROWS]) {
    json_open(json, name, '[');
    for (int i = 0; i < LAR_FORMULA_ROWS; i++) {
        json_open(json, NULL, '{');
        json_text(json, "calculation", row[i].calculation);
        json_number(json, "additions", row[i].additions);
        json_number(json, "multiplications", row[i].multiplications);
        json_close(json);
    }
    json_close(json);
}

static void write_formulas(json_writer *json, const requirements_report *p) {
    const lar_quantities *q = &p->r->quantities;
    lar_formula_row row[LAR_FORMULA_ROWS];
    lar_formula_matrix(q->df_el, row);
    write_rows(json, "table_4_1", row);
    lar_formula_vector(q->df_el, row);
    write_rows(json, "table_4_2", row);
    json_open(json, "equations", '{');
    json_number(json, "matrix_operations", lar_formula_N_K(q));
    json_number(json, "iteration_operations", lar_formula_N_g(q));
    json_number(json, "vector_operations", lar_formula_N_Ku(q));
    json_number(json, "matrix_values", lar_formula_C_K(q));
    json_number(json, "iteration_values", lar_formula_C_g(q));
    json_close(json);
    json_open(json, "methods", '[');
    for (int m = 0; m < LAR_METHODS; m++) {
        lar_method method = (lar_method)m;
        double step = lar_formula_step(method, q);
        double operations = lar_formula_operations(method, q);
        double values = lar_formula_values(method, q);
        const lar_thesis_print *t = &lar_thesis_printed[m];
        json_open(json, NULL, '{');
        json_text(json, "method", lar_method_name[m]);
        json_number(json, "operations_per_step", operations);
        json_number(json, "operations_per_second", operations / step);
        json_number(json, "values_per_step", values);
        json_number(json, "bytes_per_second", 8 * values / step);
        if (p->thesis) {
            json_open(json, "thesis_prints", '{');
            json_number(json, "operations_per_step", t->operations);
            json_number(json, "operations_per_second", t->operations_per_second);
            json_number(json, "values_per_step", t->values);
            json_number(json, "bytes_per_second", t->bytes_per_second);
            json_close(json);
        }
        json_close(json);
    }
    json_close(json);
}

static void write_vectors(json_writer *json, const lar_quantities *q) {
    int64_t n = lar_formula_edge(q);
    json_open(json, "table_3_1", '{');
    json_integer(json, "edge", n);
    json_open(json, "schemes", '[');
    for (int s = 0; s < LAR_FORMULA_SCHEMES; s++) {
        lar_formula_traffic row = lar_formula_scheme(s, n);
        json_open(json, NULL, '{');
        json_text(json, "scheme", row.scheme);
        json_integer(json, "local_vectors", row.local);
        json_integer(json, "global_vectors", row.global);
        json_close(json);
    }
    json_close(json);
    json_number(json, "vectors_all", lar_formula_vectors_all((double)n));
    json_number(json, "vectors_local", lar_formula_vectors_local((double)n));
    json_close(json);
}

static void write_operations(json_writer *json, const char *name, const lar_operations *o,
                             const lar_step_bytes *bytes) {
    json_open(json, NULL, '{');
    json_text(json, "kernel", name);
    json_integer(json, "additions", o->additions);
    json_integer(json, "multiplications", o->multiplications);
    json_integer(json, "fused", o->fused);
    json_integer(json, "divisions", o->divisions);
    json_integer(json, "roots", o->roots);
    json_integer(json, "integer_additions", o->integer_additions);
    json_integer(json, "conversions", o->conversions);
    json_integer(json, "floating", lar_operations_floating(o));
    json_integer(json, "operations", lar_operations_all(o));
    json_integer(json, "bytes_read", bytes->read);
    json_integer(json, "bytes_written", bytes->written);
    json_close(json);
}

static void write_kernels(json_writer *json) {
    json_open(json, "kernels", '[');
    for (int k = 0; k < LAR_KERNEL_KINDS; k++) {
        lar_operations o = lar_operations_of_element((lar_kernel_kind)k, 0);
        lar_step_bytes bytes = lar_bytes_of_element((lar_kernel_kind)k, 0);
        write_operations(json, lar_kernel_kind_name[k], &o, &bytes);
    }
    lar_operations node = lar_operations_of_node();
    lar_step_bytes bytes = lar_bytes_of_node();
    write_operations(json, "node", &node, &bytes);
    json_close(json);
}

static void write_packets(json_writer *json, const lar_requirements_sent *sent) {
    json_open(json, "list", '[');
    for (int64_t i = 0; i < sent->packets; i++) {
        const lar_requirements_packet *packet = &sent->packet[i];
        json_open(json, NULL, '[');
        json_integer(json, NULL, packet->from);
        json_integer(json, NULL, packet->to);
        json_integer(json, NULL, packet->bytes);
        json_close(json);
    }
    json_close(json);
}

static void write_model(json_writer *json, const lar_requirements *r) {
    double step = r->quantities.step_ex;
    json_open(json, "shapes", '[');
    for (int i = 0; i < r->shape_count; i++) {
        json_open(json, NULL, '{');
        json_text(json, "kernel", lar_kernel_kind_name[r->shape[i].kind]);
        json_integer(json, "elements", r->shape[i].elements);
        json_integer(json, "lanes", r->shape[i].lanes);
        json_close(json);
    }
    json_close(json);
    json_open(json, "sent", '[');
    for (int i = 0; i < LAR_REQUIREMENTS_SCHEMES; i++) {
        const lar_requirements_sent *s = &r->sent[i];
        json_open(json, NULL, '{');
        json_text(json, "scheme", s->scheme);
        json_integer(json, "vectors", s->vectors);
        json_integer(json, "packets", s->packets);
        json_integer(json, "empty_packets", s->empty);
        json_integer(json, "bytes", s->bytes);
        json_integer(json, "bytes_max", s->bytes_max);
        json_number(json, "bytes_per_second", (double)s->bytes / step);
        write_packets(json, s);
        json_close(json);
    }
    json_close(json);
    json_open(json, "needs", '[');
    for (int k = 0; k < LAR_NEEDS; k++) {
        const lar_requirements_kernel *n = &r->kernel[k];
        json_open(json, NULL, '{');
        json_text(json, "element", n->name);
        json_number(json, "operations_per_step", n->operations);
        json_number(json, "floating_per_second", n->floating / step);
        json_number(json, "operations_per_second", n->operations / step);
        json_number(json, "bytes_per_step", n->bytes);
        json_number(json, "bytes_per_second", n->bytes / step);
        if (r->measured) {
            json_number(json, "step_seconds", n->seconds);
            json_number(json, "cores", n->seconds / step);
        }
        json_close(json);
    }
    json_close(json);
    if (r->measured) {
        json_text(json, "isa", r->isa);
        json_number(json, "peak_gflops", r->peak_gflops);
        json_number(json, "ns_per_element", r->nanoseconds);
    } else if (r->why_not.status) {
        json_text(json, "why_not", r->why_not.message);
    }
}

void requirements_write_json(const requirements_report *p) {
    json_writer json = json_begin(stdout);
    if (p->title) {
        json_text(&json, "title", p->title);
        json_boolean(&json, "demonstration", p->r->demonstration);
        json_open(&json, "grid", '[');
        for (int i = 0; i < 3; i++) json_integer(&json, NULL, p->r->grid[i]);
        json_close(&json);
        json_integer(&json, "elements_max", p->r->elements_max);
    }
    write_quantities(&json, "quantities", &p->r->quantities);
    if (p->thesis && p->title) {
        lar_quantities thesis = lar_thesis_quantities();
        write_quantities(&json, "thesis_quantities", &thesis);
    }
    write_formulas(&json, p);
    write_vectors(&json, &p->r->quantities);
    write_kernels(&json);
    if (p->title) write_model(&json, p->r);
    json_end(&json);
}
