/* What `lariat fit --profile` says. */
#ifndef LAR_CLI_REPORT_PROFILE_H
#define LAR_CLI_REPORT_PROFILE_H

#include <stdio.h>

#include "study/frames/profiles.h"

void profile_report_table(const lar_profiles *profiles, FILE *out);
void profile_report_json(const lar_profiles *profiles, FILE *out);

#endif
