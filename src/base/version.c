#include "lariat.h"

const char *lar_version(void) {
    return LAR_VERSION;
}

int32_t lar_version_number(void) {
    return LARIAT_VERSION;
}
