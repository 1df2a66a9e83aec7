/* Fuzz target: what a viewer says. Whatever is taken keeps what the rest of the server relies on; a
 * refusal has a reason that may be sent: UTF-8 that fits into a close frame. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "server/json.h"
#include "server/message.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { TOOLS = 6 };

static void demand(int holds) {
    if (!holds) abort();
}

static void check_wish(const lar_wish *wish) {
    double square = 0;
    demand(wish->tool >= 0 && wish->tool < TOOLS);
    demand(wish->hand >= 0 && wish->hand < LAR_VIEWER_HANDS);
    demand(wish->steps <= 100000 && (wish->kind != LAR_WISH_STEP || wish->steps > 0));
    demand(wish->pace == 0 || (wish->pace >= 0.001 && wish->pace <= 100));
    demand(wish->opening >= 0 && wish->opening <= 1);
    for (int i = 0; i < 3; i++) demand(fabs(wish->point[i]) <= 1000);
    for (int i = 0; i < 4; i++) square += wish->orientation[i] * wish->orientation[i];
    demand(!wish->turns || fabs(square - 1) < 1e-12);
    demand(memchr(wish->name, '\0', sizeof wish->name) != NULL);
    demand(lar_field_names[lar_field_index(wish->field)].field == wish->field);
}

static void check_reason(const char *reason) {
    size_t length = strlen(reason);
    demand(length > 0 && length < LAR_REASON_BYTES);
    for (size_t i = 0; i < length;) {
        int bytes = lar_utf8_length((const unsigned char *)reason + i, length - i);
        demand(bytes > 0);
        i += (size_t)bytes;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char reason[LAR_REASON_BYTES] = "", *exact = malloc(size ? size : 1);
    lar_wish wish;
    if (!exact) return 0;
    if (size > 0) memcpy(exact, data, size);
    if (lar_wish_read(exact, size, TOOLS, &wish, reason) == LAR_CLOSE_NOT)
        check_wish(&wish);
    else
        check_reason(reason);
    free(exact);
    return 0;
}
