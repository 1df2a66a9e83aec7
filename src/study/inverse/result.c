#include "study/inverse/result.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

bool lar_inverse_at_bound(const lar_inverse_result *result) {
    for (int j = 0; j < result->parameters; j++)
        if (result->estimate[j].at_bound) return true;
    return false;
}

void lar_inverse_note(lar_inverse_result *result, const char *format, ...) {
    if (result->notes == LAR_INVERSE_NOTES_MAX) return;
    va_list args;
    va_start(args, format);
    vsnprintf(result->note[result->notes++], LAR_INVERSE_NOTE, format, args);
    va_end(args);
}

void lar_inverse_result_clear(lar_inverse_result *result) {
    free(result->model);
    *result = (lar_inverse_result){0};
}
