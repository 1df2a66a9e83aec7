#include <stddef.h>
#include <stdio.h>

#include "base/json/write.h"
#include "cli/report/requirements.h"

static void write_quantities(lar_json *json, const char *name, const lar_quantities *q) {
    lar_json_open(json, name, '{');
    lar_json_number(json, "n_el", q->n_el);
    lar_json_number(json, "n_k", q->n_k);
    lar_json_number(json, "n_eav", q->n_eav);
    lar_json_number(json, "df_el", q->df_el);
    lar_json_number(json, "df_eav", q->df_eav);
    lar_json_number(json, "df_g", lar_freedoms(q));
    lar_json_number(json, "n_int", q->n_int);
    lar_json_number(json, "n_it", q->n_it);
    lar_json_number(json, "dt_im", q->step_im);
    lar_json_number(json, "dt_ex", q->step_ex);
    lar_json_number(json, "n_p", q->n_p);
    lar_json_number(json, "n_pav", q->n_pav);
    lar_json_close(json);
}

static void write_rows(lar_json *json, const char *name,
                       const lar_formula_row row[LAR_FORMULA_ROWS]) {
    lar_json_open(json, name, '[');
    for (int i = 0; i < LAR_FORMULA_ROWS; i++) {
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "calculation", row[i].calculation);
        lar_json_number(json, "additions", row[i].additions);
        lar_json_number(json, "multiplications", row[i].multiplications);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_formulas(lar_json *json, const requirements_report *p) {
    const lar_quantities *q = &p->r->quantities;
    lar_formula_row row[LAR_FORMULA_ROWS];
    lar_formula_matrix(q->df_el, row);
    write_rows(json, "table_4_1", row);
    lar_formula_vector(q->df_el, row);
    write_rows(json, "table_4_2", row);
    lar_json_open(json, "equations", '{');
    lar_json_number(json, "matrix_operations", lar_formula_N_K(q));
    lar_json_number(json, "iteration_operations", lar_formula_N_g(q));
    lar_json_number(json, "vector_operations", lar_formula_N_Ku(q));
    lar_json_number(json, "matrix_values", lar_formula_C_K(q));
    lar_json_number(json, "iteration_values", lar_formula_C_g(q));
    lar_json_close(json);
    lar_json_open(json, "methods", '[');
    for (int m = 0; m < LAR_METHODS; m++) {
        lar_method method = (lar_method)m;
        double step = lar_formula_step(method, q);
        double operations = lar_formula_operations(method, q);
        double values = lar_formula_values(method, q);
        const lar_thesis_print *t = &lar_thesis_printed[m];
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "method", lar_method_name[m]);
        lar_json_number(json, "operations_per_step", operations);
        lar_json_number(json, "operations_per_second", operations / step);
        lar_json_number(json, "values_per_step", values);
        lar_json_number(json, "bytes_per_second", 8 * values / step);
        if (p->thesis) {
            lar_json_open(json, "thesis_prints", '{');
            lar_json_number(json, "operations_per_step", t->operations);
            lar_json_number(json, "operations_per_second", t->operations_per_second);
            lar_json_number(json, "values_per_step", t->values);
            lar_json_number(json, "bytes_per_second", t->bytes_per_second);
            lar_json_close(json);
        }
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_vectors(lar_json *json, const lar_quantities *q) {
    int64_t n = lar_formula_edge(q);
    lar_json_open(json, "table_3_1", '{');
    lar_json_integer(json, "edge", n);
    lar_json_open(json, "schemes", '[');
    for (int s = 0; s < LAR_FORMULA_SCHEMES; s++) {
        lar_formula_traffic row = lar_formula_scheme(s, n);
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "scheme", row.scheme);
        lar_json_integer(json, "local_vectors", row.local);
        lar_json_integer(json, "global_vectors", row.global);
        lar_json_close(json);
    }
    lar_json_close(json);
    lar_json_number(json, "vectors_all", lar_formula_vectors_all((double)n));
    lar_json_number(json, "vectors_local", lar_formula_vectors_local((double)n));
    lar_json_close(json);
}

static void write_operations(lar_json *json, const char *name, const lar_operations *o,
                             const lar_step_bytes *bytes) {
    lar_json_open(json, NULL, '{');
    lar_json_text(json, "kernel", name);
    lar_json_integer(json, "additions", o->additions);
    lar_json_integer(json, "multiplications", o->multiplications);
    lar_json_integer(json, "fused", o->fused);
    lar_json_integer(json, "divisions", o->divisions);
    lar_json_integer(json, "roots", o->roots);
    lar_json_integer(json, "integer_additions", o->integer_additions);
    lar_json_integer(json, "conversions", o->conversions);
    lar_json_integer(json, "floating", lar_operations_floating(o));
    lar_json_integer(json, "operations", lar_operations_all(o));
    lar_json_integer(json, "bytes_read", bytes->read);
    lar_json_integer(json, "bytes_written", bytes->written);
    lar_json_close(json);
}

static void write_kernels(lar_json *json) {
    lar_json_open(json, "kernels", '[');
    for (int k = 0; k < LAR_KERNEL_KINDS; k++) {
        lar_operations o = lar_operations_of_element((lar_kernel_kind)k, 0);
        lar_step_bytes bytes = lar_bytes_of_element((lar_kernel_kind)k, 0);
        write_operations(json, lar_kernel_kind_name[k], &o, &bytes);
    }
    lar_operations node = lar_operations_of_node();
    lar_step_bytes bytes = lar_bytes_of_node();
    write_operations(json, "node", &node, &bytes);
    lar_json_close(json);
}

static void write_packets(lar_json *json, const lar_requirements_sent *sent) {
    lar_json_open(json, "list", '[');
    for (int64_t i = 0; i < sent->packets; i++) {
        const lar_requirements_packet *packet = &sent->packet[i];
        lar_json_open(json, NULL, '[');
        lar_json_integer(json, NULL, packet->from);
        lar_json_integer(json, NULL, packet->to);
        lar_json_integer(json, NULL, packet->bytes);
        lar_json_close(json);
    }
    lar_json_close(json);
}

static void write_model(lar_json *json, const lar_requirements *r) {
    double step = r->quantities.step_ex;
    lar_json_open(json, "shapes", '[');
    for (int i = 0; i < r->shape_count; i++) {
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "kernel", lar_kernel_kind_name[r->shape[i].kind]);
        lar_json_integer(json, "elements", r->shape[i].elements);
        lar_json_integer(json, "lanes", r->shape[i].lanes);
        lar_json_close(json);
    }
    lar_json_close(json);
    lar_json_open(json, "sent", '[');
    for (int i = 0; i < LAR_REQUIREMENTS_SCHEMES; i++) {
        const lar_requirements_sent *s = &r->sent[i];
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "scheme", s->scheme);
        lar_json_integer(json, "vectors", s->vectors);
        lar_json_integer(json, "packets", s->packets);
        lar_json_integer(json, "empty_packets", s->empty);
        lar_json_integer(json, "bytes", s->bytes);
        lar_json_integer(json, "bytes_max", s->bytes_max);
        lar_json_number(json, "bytes_per_second", (double)s->bytes / step);
        write_packets(json, s);
        lar_json_close(json);
    }
    lar_json_close(json);
    lar_json_open(json, "needs", '[');
    for (int k = 0; k < LAR_NEEDS; k++) {
        const lar_requirements_kernel *n = &r->kernel[k];
        lar_json_open(json, NULL, '{');
        lar_json_text(json, "element", n->name);
        lar_json_number(json, "operations_per_step", n->operations);
        lar_json_number(json, "floating_per_second", n->floating / step);
        lar_json_number(json, "operations_per_second", n->operations / step);
        lar_json_number(json, "bytes_per_step", n->bytes);
        lar_json_number(json, "bytes_per_second", n->bytes / step);
        if (r->measured) {
            lar_json_number(json, "step_seconds", n->seconds);
            lar_json_number(json, "cores", n->seconds / step);
        }
        lar_json_close(json);
    }
    lar_json_close(json);
    if (r->measured) {
        lar_json_text(json, "isa", r->isa);
        lar_json_number(json, "peak_gflops", r->peak_gflops);
        lar_json_number(json, "ns_per_element", r->nanoseconds);
    } else if (r->why_not.status) {
        lar_json_text(json, "why_not", r->why_not.message);
    }
}

void requirements_write_json(const requirements_report *p) {
    lar_json json = lar_json_to(stdout);
    if (p->title) {
        lar_json_text(&json, "title", p->title);
        lar_json_boolean(&json, "demonstration", p->r->demonstration);
        lar_json_integers(&json, "grid", p->r->grid, 3);
        lar_json_integer(&json, "elements_max", p->r->elements_max);
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
    lar_json_end(&json);
}
