/* The demonstration organ for a command that says what it has left as it was. */
#ifndef LAR_STUDY_DEMO_H
#define LAR_STUDY_DEMO_H

#include <stdbool.h>

#include "base/error.h"

enum { LAR_DEMO_KEPT_MAX = 4 };

/* lar_demo_write (lariat.h); with `force` all scenes are written. kept[]: names of those that were
 * there, differ and stay, NULL behind them. */
lar_status lar_demo_write_or_keep(const char *folder, bool force,
                                  const char *kept[LAR_DEMO_KEPT_MAX], lar_error *error);

#endif
