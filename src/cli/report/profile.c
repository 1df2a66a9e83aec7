#include "cli/report/profile.h"

#include "base/json/write.h"

static const double UM = 1e6; /* of a metre */

void profile_report_table(const lar_profiles *p, FILE *out) {
    fprintf(out, "frames          %d of %d x %d pixels, %.4g to %.4g s\n", (int)p->frames.count,
            p->width, p->height, lar_profiles_time(p, 0),
            lar_profiles_time(p, p->frames.count - 1));
    if (p->lost > 0)
        fprintf(out, "missing         %lld numbers between them; the others keep their time\n",
                (long long)p->lost);
    if (p->early > 0) fprintf(out, "left out        %d frames before time 0\n", (int)p->early);
    fprintf(out, "tissue          %s than what is behind it, edges blurred by %.1f pixels\n",
            p->view.tissue > 0 ? "brighter" : "darker", p->blur);
    fprintf(out, "points          %d, %d without an edge\n", (int)p->found, (int)p->missed);
    if (p->clipped > 0)
        fprintf(out,
                "exposure        %d points lie where the picture is black or white in full; their "
                "errors are as long as the blur: take other light\n",
                (int)p->clipped);
    fprintf(out,
            "uncertainty     %.2g um, %.2g um at worst (one standard deviation, pixels of %g um)\n",
            UM * p->error, UM * p->worst, UM * p->view.scale);
    fprintf(out, "speed           %.3g frames/s\n", p->frames.count / p->seconds);
}

void profile_report_json(const lar_profiles *p, FILE *out) {
    lar_json json = lar_json_to(out);
    lar_json_text(&json, "film", p->film);
    lar_json_text(&json, "view", p->view_path);
    lar_json_integer(&json, "frames", p->frames.count);
    lar_json_integer(&json, "missing_frames", p->lost);
    lar_json_integer(&json, "early_frames", p->early);
    lar_json_integer(&json, "width", p->width);
    lar_json_integer(&json, "height", p->height);
    lar_json_text(&json, "tissue", p->view.tissue > 0 ? "bright" : "dark");
    lar_json_integer(&json, "points", p->found);
    lar_json_integer(&json, "points_missed", p->missed);
    lar_json_integer(&json, "points_clipped", p->clipped);
    lar_json_number(&json, "uncertainty", p->error);
    lar_json_number(&json, "uncertainty_worst", p->worst);
    lar_json_number(&json, "blur", p->blur);
    lar_json_number(&json, "wall_time", p->seconds);
    lar_json_number(&json, "frames_per_second", p->frames.count / p->seconds);
    lar_json_end(&json);
}
