#include "study/demo.h"

#include <stddef.h>

#include "model/demo/demo.h"

_Static_assert((int)LAR_DEMO_SCENES < (int)LAR_DEMO_KEPT_MAX, "a name for each, and NULL");

lar_status lar_demo_write_or_keep(const char *folder, bool force,
                                  const char *kept[LAR_DEMO_KEPT_MAX], lar_error *error) {
    bool stays[LAR_DEMO_SCENES];
    int count = 0;
    lar_status status = lar_demo_write_beside(folder, force, stays, error);
    for (int i = 0; i < LAR_DEMO_SCENES; i++)
        if (stays[i]) kept[count++] = lar_demo_scene_of[i].name;
    kept[count] = NULL;
    return status;
}
