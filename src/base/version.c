#include "lariat.h"

const char *lar_version(void) {
    return LAR_VERSION;
}
