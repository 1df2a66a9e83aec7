/* Fuzz target: the JSON reader. Nothing outside the text is read; what is whole can be gone over by
 * name and by element; what is said of a text is true of it. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/json/read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void demand(int holds) {
    if (!holds) abort();
}

static void look_at(lar_json_reader value, int depth) {
    char text[16];
    char first = lar_json_next(&value);
    lar_json_reader array = value, element;
    demand(lar_json_scalar(value, text, sizeof text) == (first != '{' && first != '['));
    if (first == '{') {
        lar_json_member(value, "absent");
        array = lar_json_member(value, "a");
        if (array.at) look_at(array, depth);
    }
    if (first != '[' || depth == 3) return;
    demand(lar_json_take(&array, '['));
    while (lar_json_element(&array, &element)) look_at(element, depth + 1);
    demand(lar_json_take(&array, ']'));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *exact = malloc(size ? size : 1), text[16];
    if (!exact) return 0;
    if (size > 0) memcpy(exact, data, size);
    const lar_json_reader begin = {exact, exact + size};
    lar_json_reader reader = begin;
    size_t length = 0;
    if (lar_json_is_whole(&reader)) look_at(begin, 0);
    demand(reader.at >= exact && reader.at <= exact + size);
    reader = begin;
    if (lar_json_take_string(&reader, text, sizeof text, &length))
        demand(strlen(text) == (length < sizeof text ? length : sizeof text - 1));
    free(exact);
    return 0;
}
