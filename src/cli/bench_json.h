/* What the benchmarks' JSON has in common. */
#ifndef LAR_CLI_BENCH_JSON_H
#define LAR_CLI_BENCH_JSON_H

#include "cli/json.h"
#include "study/bench_kernel.h"

/* Least, median and greatest of some samples, as an object. */
static inline void bench_write_spread(json_writer *json, const char *name,
                                      const lar_spread *spread) {
    json_open(json, name, '{');
    json_number(json, "min", spread->least);
    json_number(json, "median", spread->median);
    json_number(json, "max", spread->most);
    json_close(json);
}

#endif
