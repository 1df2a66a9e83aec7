#include "study/predict/cluster.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

const char *const lar_cluster_number_name[LAR_CLUSTER_NUMBERS] = {
    "element", "node", "vector",  "step", "overhead", "byte",
    "receive", "join", "latency", "gap",  "bandwidth"};

/* ---- the table ---------------------------------------------------------------------------- */

/* The thesis's cluster. Its figures 7.6 to 7.8 are curves without numbers in the text: what is only
 * there is marked as an assumption. Link: half of the peak at 196 bytes (7.3) and 111 MB/s at its
 * mean packet of 424 bytes give 162 MB/s and 1.2 us, and 1.28 Gbit/s (5.2.3) are 160 MB/s. 6.5.3.1
 * says up to 120 MB/s. */
#define THESIS_NETWORK                                                                             \
    [LAR_CLUSTER_STEP] = 0, [LAR_CLUSTER_OVERHEAD] = 0.5e-6, [LAR_CLUSTER_BYTE] = 1 / 241.1e6,     \
    [LAR_CLUSTER_RECEIVE] = 0.2e-6, [LAR_CLUSTER_JOIN] = 0.5e-6, [LAR_CLUSTER_LATENCY] = 6e-6,     \
    [LAR_CLUSTER_GAP] = 196 / 160e6, [LAR_CLUSTER_BANDWIDTH] = 160e6
#define THESIS_SOURCES(element)                                                                    \
    {                                                                                              \
        element,                                                                                   \
            "assumed: 20 operations at the 500 MFLOPS that thesis 6.10 prints, scaled as the "     \
            "element (at the 408 of its 816 operations in 2 us: 0.049 us)",                        \
            "assumed: three additions and a part of a line of memory, scaled likewise", "assumed", \
            "assumed: two words written to the card, and the call",                                \
            "thesis table 7.3: 241.1 MByte/s written to the card",                                 \
            "assumed: one word in main memory looked at (thesis 7.3)",                             \
            "assumed: memory latency is less than a microsecond (thesis 6.5.3.1)",                 \
            "assumed within the few microseconds of thesis 6.5.3.1",                               \
            "thesis 7.3: half of the peak bandwidth at 196 bytes",                                 \
            "thesis 5.2.3: 1.28 GBit/s in each direction; 6.5.3.1 counts on 120 MByte/s at most"   \
    }

/* Lariat's element on the machine that docs/performance.md names: 8.7 ns per element with its 1.2
 * nodes. */
#define TODAY                                                                                      \
    [LAR_CLUSTER_ELEMENT] = 8.0e-9, [LAR_CLUSTER_NODE] = 0.6e-9, [LAR_CLUSTER_VECTOR] = 1e-9,      \
    [LAR_CLUSTER_STEP] = 0, [LAR_CLUSTER_JOIN] = 0.1e-6
#define TODAY_SOURCES                                                                              \
    [LAR_CLUSTER_ELEMENT] =                                                                        \
        "docs/performance.md: 8.7 ns per element with 1.2 nodes, one core, Zen 5, AVX-512",        \
    [LAR_CLUSTER_NODE] = "assumed: 0.7 of the 8.7 ns",                                             \
    [LAR_CLUSTER_VECTOR] = "assumed, as lariat predict --measure does there (docs/prediction.md)", \
    [LAR_CLUSTER_STEP] = "assumed", [LAR_CLUSTER_JOIN] = "assumed: a cache line from core to core"
#define REMOTE_WRITES                                                                              \
    [LAR_CLUSTER_OVERHEAD] = "assumed: a descriptor and a doorbell",                               \
    [LAR_CLUSTER_BYTE] =                                                                           \
        "lariat predict --measure on the same machine: 0.024 to 0.032 ns by threads and shm",      \
    [LAR_CLUSTER_RECEIVE] = "assumed: one word looked at"

static const lar_cluster table[] = {
    {"thesis",
     "the thesis's cluster: Alpha 21264A 666 MHz, Myrinet, FE protocol (2000)",
     {[LAR_CLUSTER_ELEMENT] = 2e-6,
      [LAR_CLUSTER_NODE] = 0.04e-6,
      [LAR_CLUSTER_VECTOR] = 0.03e-6,
      THESIS_NETWORK},
     THESIS_SOURCES("thesis table 6.1: 2 us")},
    {"thesis-moderate",
     "the same network, processors of half the speed (thesis 5.1.7)",
     {[LAR_CLUSTER_ELEMENT] = 4e-6,
      [LAR_CLUSTER_NODE] = 0.08e-6,
      [LAR_CLUSTER_VECTOR] = 0.06e-6,
      THESIS_NETWORK},
     THESIS_SOURCES("thesis 5.1.7: half the speed of table 6.1")},
    {"thesis-slow",
     "the same network, processors of a quarter of the speed (thesis 5.1.7)",
     {[LAR_CLUSTER_ELEMENT] = 8e-6,
      [LAR_CLUSTER_NODE] = 0.16e-6,
      [LAR_CLUSTER_VECTOR] = 0.12e-6,
      THESIS_NETWORK},
     THESIS_SOURCES("thesis 5.1.7: a quarter of the speed of table 6.1")},
    {"infiniband",
     "a core for every thread, 200 Gbit/s InfiniBand with remote writes",
     {TODAY, [LAR_CLUSTER_OVERHEAD] = 0.2e-6, [LAR_CLUSTER_BYTE] = 0.03e-9,
      [LAR_CLUSTER_RECEIVE] = 0.05e-6, [LAR_CLUSTER_LATENCY] = 1.0e-6, [LAR_CLUSTER_GAP] = 5e-9,
      [LAR_CLUSTER_BANDWIDTH] = 25e9},
     {TODAY_SOURCES, REMOTE_WRITES,
      [LAR_CLUSTER_LATENCY] = "typical: ib_send_lat 0.8 us for 32 bytes, 1.5 us for 1 kB on a "
                              "reliable connection (D. Potter, master's thesis, table of MTU "
                              "performance)",
      [LAR_CLUSTER_GAP] = "assumed: 200 million packets a second",
      [LAR_CLUSTER_BANDWIDTH] = "nominal: 200 Gbit/s"}},
    {"roce",
     "a core for every thread, 25 Gbit/s RoCE",
     {TODAY, [LAR_CLUSTER_OVERHEAD] = 0.2e-6, [LAR_CLUSTER_BYTE] = 0.03e-9,
      [LAR_CLUSTER_RECEIVE] = 0.05e-6, [LAR_CLUSTER_LATENCY] = 1.9e-6, [LAR_CLUSTER_GAP] = 29e-9,
      [LAR_CLUSTER_BANDWIDTH] = 3.125e9},
     {TODAY_SOURCES, REMOTE_WRITES,
      [LAR_CLUSTER_LATENCY] = "typical: 1.93 us by MPI past the kernel over 40 Gbit/s Ethernet "
                              "(blogs.cisco.com/performance/mpi-over-40gb-ethernet)",
      [LAR_CLUSTER_GAP] = "assumed: 90 bytes of headers and pause around a packet",
      [LAR_CLUSTER_BANDWIDTH] = "nominal: 25 Gbit/s"}},
    {"ethernet",
     "a core for every thread, 1 Gbit/s Ethernet with TCP",
     {TODAY, [LAR_CLUSTER_OVERHEAD] = 2e-6, [LAR_CLUSTER_BYTE] = 0.1e-9,
      [LAR_CLUSTER_RECEIVE] = 2e-6, [LAR_CLUSTER_LATENCY] = 19e-6, [LAR_CLUSTER_GAP] = 0.72e-6,
      [LAR_CLUSTER_BANDWIDTH] = 125e6},
     {TODAY_SOURCES, [LAR_CLUSTER_OVERHEAD] = "assumed: a system call and the protocols below it",
      [LAR_CLUSTER_BYTE] = "assumed: a copy into the kernel",
      [LAR_CLUSTER_RECEIVE] = "assumed: a system call",
      [LAR_CLUSTER_LATENCY] = "typical: NetPIPE 23 us on a cluster (norma.mbg.duth.gr, network "
                              "benchmarks), less both system calls",
      [LAR_CLUSTER_GAP] = "90 bytes of headers and pause around a packet (IEEE 802.3, IP, TCP)",
      [LAR_CLUSTER_BANDWIDTH] = "nominal: 1 Gbit/s"}},
};

const lar_cluster *lar_cluster_at(int i) {
    return i >= 0 && i < (int)(sizeof table / sizeof table[0]) ? &table[i] : NULL;
}

double lar_cluster_alone(const lar_cluster *m, double elements, double nodes) {
    return m->number[LAR_CLUSTER_STEP] + elements * m->number[LAR_CLUSTER_ELEMENT] +
           nodes * m->number[LAR_CLUSTER_NODE];
}

lar_status lar_cluster_check(const lar_cluster *m, lar_error *error) {
    for (int i = 0; i < LAR_CLUSTER_NUMBERS; i++) {
        double x = m->number[i];
        if (i == LAR_CLUSTER_BANDWIDTH) {
            if (x >= 1 && x <= 1e18) continue;
            return lar_fail(error, LAR_ERROR_ARGUMENT,
                            "machine %s: its bandwidth is %g MB/s; give one above 0", m->name,
                            1e-6 * x);
        }
        if (x <= 1e3 && x >= (i == LAR_CLUSTER_ELEMENT ? 1e-15 : 0)) continue;
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "machine %s: %s is %g us; give a time of 0 to 1e9 us%s", m->name,
                        lar_cluster_number_name[i], 1e6 * x,
                        i == LAR_CLUSTER_ELEMENT ? ", and more than 0 for an element" : "");
    }
    return LAR_OK;
}

/* ---- files -------------------------------------------------------------------------------- */

static lar_status read_number(const char *path, lar_text *text, lar_span word, lar_cluster *m,
                              lar_error *error) {
    int i = 0, line = text->line;
    double x;
    lar_span value;
    while (i < LAR_CLUSTER_NUMBERS && !lar_span_equal(word, lar_cluster_number_name[i])) i++;
    if (i == LAR_CLUSTER_NUMBERS)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s:%d: '%.*s' is no number of a machine; there are element, node, vector, "
                        "step, overhead, byte, receive, join, latency, gap (us) and bandwidth "
                        "(MB/s)",
                        path, line, word.length < 40 ? (int)word.length : 40, word.at);
    if (!lar_text_word(text, &value) || text->line != line || !lar_span_double(value, &x) ||
        !isfinite(x))
        return lar_fail(error, LAR_ERROR_FORMAT, "%s:%d: %s needs a number behind it", path, line,
                        lar_cluster_number_name[i]);
    m->number[i] = x * (i == LAR_CLUSTER_BANDWIDTH ? 1e6 : 1e-6);
    return LAR_OK;
}

lar_status lar_cluster_parse(const char *path, const lar_bytes *bytes, lar_cluster *out,
                             lar_error *error) {
    lar_cluster made = {.title = "from a file"};
    lar_status status = LAR_OK;
    const char *slash = strrchr(path, '/');
    snprintf(made.name, sizeof made.name, "%s", slash ? slash + 1 : path);
    for (int i = 0; i < LAR_CLUSTER_NUMBERS; i++) made.source[i] = "from the file";
    lar_text text = lar_text_from(bytes);
    lar_span word;
    while (!status && lar_text_word(&text, &word)) {
        if (*word.at == '#')
            lar_text_line(&text, &word);
        else
            status = read_number(path, &text, word, &made, error);
    }
    if (!status) status = lar_cluster_check(&made, error);
    if (!status) *out = made;
    return status;
}

static lar_status read_file(const char *path, lar_cluster *out, lar_error *error) {
    lar_bytes bytes;
    lar_status status = lar_bytes_read(path, &bytes, error);
    if (status) return status;
    status = lar_cluster_parse(path, &bytes, out, error);
    lar_bytes_free(&bytes);
    return status;
}

lar_status lar_cluster_find(const char *name, lar_cluster *out, lar_error *error) {
    for (int i = 0; lar_cluster_at(i); i++)
        if (strcmp(table[i].name, name) == 0) {
            *out = table[i];
            return LAR_OK;
        }
    if (strchr(name, '/') || strchr(name, '.')) return read_file(name, out, error);
    return lar_fail(error, LAR_ERROR_ARGUMENT,
                    "there is no machine %s; lariat predict --list-machines tells which there are, "
                    "and a file is named with a folder or an ending",
                    name);
}
