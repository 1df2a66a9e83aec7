/* Fuzz target: what a viewer says. Whatever is taken keeps what the rest of the server relies on; a
 * refusal has a reason that may be sent: UTF-8 that fits into a close frame. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "server/message.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { TOOLS = 6 };

static void demand(int holds) {
    if (!holds) abort();
}

static void check_command(const lar_command *command) {
    double square = 0;
    demand(command->tool >= 0 && command->tool < TOOLS);
    demand(command->hand >= 0 && command->hand < LAR_VIEWER_HANDS);
    demand(command->steps <= 100000 && (command->kind != LAR_COMMAND_STEP || command->steps > 0));
    demand(command->pace == 0 || (command->pace >= 0.001 && command->pace <= 100));
    demand(command->opening >= 0 && command->opening <= 1);
    for (int i = 0; i < 3; i++) demand(fabs(command->point[i]) <= 1000);
    for (int i = 0; i < 4; i++) square += command->orientation[i] * command->orientation[i];
    demand(!command->turns || fabs(square - 1) < 1e-12);
    demand(memchr(command->name, '\0', sizeof command->name) != NULL);
    demand(lar_field_names[lar_field_index(command->field)].field == command->field);
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
    lar_command command;
    if (!exact) return 0;
    if (size > 0) memcpy(exact, data, size);
    if (lar_command_read(exact, size, TOOLS, &command, reason) == LAR_CLOSE_NOT)
        check_command(&command);
    else
        check_reason(reason);
    free(exact);
    return 0;
}
