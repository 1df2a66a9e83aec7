#include "model/scene/scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "model/contact_check.h"

/* ---- messages ----------------------------------------------------------------------------- */

lar_status lar_scene_fail(const lar_scene *scene, const lar_yaml *at, lar_status status,
                          const char *format, ...) {
    char sentence[sizeof scene->error->message];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    return lar_fail(scene->error, status, "%s:%d:%d: %s", scene->path, at->line, at->column,
                    sentence);
}

lar_status lar_scene_no_memory(const lar_scene *scene, size_t bytes) {
    return lar_fail_memory(scene->error, bytes, scene->path);
}

/* Levenshtein distance, for short words; long ones are never close. */
static int edit_distance(const char *a, const char *b) {
    enum { LONGEST = 40, FAR = 99 };
    size_t n = strlen(a), m = strlen(b);
    if (n > LONGEST || m > LONGEST) return FAR;
    int row[LONGEST + 1];
    for (size_t j = 0; j <= m; j++) row[j] = (int)j;
    for (size_t i = 1; i <= n; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= m; j++) {
            int best = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            if (row[j] + 1 < best) best = row[j] + 1;
            if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
            row[j] = best;
        }
    }
    return row[m];
}

static const char *closest(const char *word, const char *const *names, int count) {
    int best = 3;
    const char *found = NULL;
    for (int i = 0; i < count; i++) {
        int distance = edit_distance(word, names[i]);
        if (distance < best && distance < (int)strlen(word)) {
            best = distance;
            found = names[i];
        }
    }
    return found;
}

lar_status lar_scene_unknown(const lar_scene *scene, const lar_yaml *at, lar_status status,
                             const char *what, const char *list, const char *const *names,
                             int count) {
    enum { MAX = 30 };
    char all[600] = "";
    size_t used = 0;
    int listed = 0;
    while (listed < count && listed < MAX) {
        int wrote =
            snprintf(all + used, sizeof all - used, "%s%s", listed ? ", " : "", names[listed]);
        if (wrote < 0 || (size_t)wrote >= sizeof all - used) break;
        used += (size_t)wrote;
        listed++;
    }
    all[used] = '\0';
    char more[40] = "", meant[80] = "", shown[LAR_YAML_SHOWN];
    if (listed < count) snprintf(more, sizeof more, " and %d more", count - listed);
    const char *near = at->kind == LAR_YAML_SCALAR ? closest(at->text, names, count) : NULL;
    if (near) snprintf(meant, sizeof meant, "; did you mean %s?", near);
    return lar_scene_fail(scene, at, status, "%s %s is unknown%s %s: %s%s", what,
                          lar_yaml_show(at, shown), near ? meant : ";", list, count ? all : "none",
                          more);
}

static lar_status wrong_type(const lar_scene *scene, const lar_yaml *node, const char *expected) {
    char shown[LAR_YAML_SHOWN];
    const char *key = node->key ? node->key->text : NULL;
    return lar_scene_fail(scene, node, LAR_ERROR_FORMAT, "%.40s%sexpected %s, but found %s",
                          key ? key : "", key ? ": " : "", expected, lar_yaml_show(node, shown));
}

/* ---- shapes ------------------------------------------------------------------------------- */

/* What stands behind the comma of 2,5. */
static bool is_digits(const char *text) {
    return *text && text[strspn(text, "0123456789")] == '\0';
}

lar_status lar_scene_keys(const lar_scene *scene, const lar_yaml *node, const char *what,
                          const char *const *keys) {
    char text[160];
    int count = 0;
    while (keys[count]) count++;
    if (node->kind != LAR_YAML_MAPPING) {
        snprintf(text, sizeof text, "%s as a mapping, {%s: ...}", what, keys[0]);
        return wrong_type(scene, node, text);
    }
    for (const lar_yaml *entry = node->first; entry; entry = entry->next) {
        int i = 0;
        while (i < count && strcmp(entry->key->text, keys[i]) != 0) i++;
        if (i == count) {
            snprintf(text, sizeof text, "%s%s may have the keys",
                     is_digits(entry->key->text) ? "decimals have a point, as in 2.5, and " : "",
                     what);
            return lar_scene_unknown(scene, entry->key, LAR_ERROR_FORMAT, "the key", text, keys,
                                     count);
        }
    }
    return LAR_OK;
}

lar_status lar_scene_list(const lar_scene *scene, const lar_yaml *node, const char *what) {
    char expected[120];
    if (node->kind == LAR_YAML_LIST) return LAR_OK;
    snprintf(expected, sizeof expected, "a list of %s, each after '- ' or all in brackets [ ]",
             what);
    return wrong_type(scene, node, expected);
}

lar_status lar_scene_need(const lar_scene *scene, const lar_yaml *mapping, const char *what,
                          const char *key, const char *example, const lar_yaml **value) {
    *value = lar_yaml_get(mapping, key);
    if (*value) return LAR_OK;
    return lar_scene_fail(scene, mapping, LAR_ERROR_FORMAT,
                          "%s needs the key \"%s\"; add it, for example %s", what, key, example);
}

/* ---- numbers and words -------------------------------------------------------------------- */

lar_status lar_scene_number(const lar_scene *scene, const lar_yaml *node, const char *expected,
                            double *value) {
    double number;
    if (node->kind != LAR_YAML_SCALAR) return wrong_type(scene, node, expected);
    const char *text = node->text;
    bool special = strcmp(text, ".nan") == 0 || strcmp(text, ".NaN") == 0 ||
                   strcmp(text, ".inf") == 0 || strcmp(text, "-.inf") == 0;
    if (!special) {
        if (node->quoted || !lar_span_double((lar_span){text, strlen(text)}, &number))
            return wrong_type(scene, node, expected);
        if (isfinite(number)) {
            *value = number;
            return LAR_OK;
        }
    }
    return lar_scene_fail(scene, node, LAR_ERROR_FORMAT,
                          "\"%.40s\" is not a finite number; expected %s", text, expected);
}

static lar_status check_sign(const lar_scene *scene, const lar_yaml *node, const char *expected,
                             bool good, const char *need) {
    const char *key = node->key ? node->key->text : "the number";
    if (good) return LAR_OK;
    return lar_scene_fail(scene, node, LAR_ERROR_MODEL, "%.40s is %.40s; it must %s: expected %s",
                          key, node->text, need, expected);
}

lar_status lar_scene_positive(const lar_scene *scene, const lar_yaml *node, const char *expected,
                              double *value) {
    lar_status status = lar_scene_number(scene, node, expected, value);
    return status ? status : check_sign(scene, node, expected, *value > 0.0, "be more than zero");
}

lar_status lar_scene_not_negative(const lar_scene *scene, const lar_yaml *node,
                                  const char *expected, double *value) {
    lar_status status = lar_scene_number(scene, node, expected, value);
    return status ? status : check_sign(scene, node, expected, *value >= 0.0, "not be negative");
}

lar_status lar_scene_friction(const lar_scene *scene, const lar_yaml *entry, double *friction) {
    const lar_yaml *node = lar_yaml_get(entry, "friction");
    if (!node) return LAR_OK;
    lar_status status = lar_scene_number(scene, node, LAR_A_FRICTION, friction);
    if (status || !lar_friction_problem(*friction)) return status;
    return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                          "friction is %.40s; it must be from 0 to 5, for example 0.3", node->text);
}

lar_status lar_scene_vector(const lar_scene *scene, const lar_yaml *node, const char *expected,
                            double value[3]) {
    double vector[3];
    if (node->kind != LAR_YAML_LIST || node->count != 3) return wrong_type(scene, node, expected);
    const lar_yaml *entry = node->first;
    for (int i = 0; i < 3; i++, entry = entry->next) {
        lar_status status = lar_scene_number(scene, entry, expected, &vector[i]);
        if (status) return status;
    }
    memcpy(value, vector, sizeof vector);
    return LAR_OK;
}

lar_status lar_scene_direction(const lar_scene *scene, const lar_yaml *node, double unit[3]) {
    double v[3] = {0, 0, 0};
    lar_status status = lar_scene_vector(scene, node, LAR_A_DIRECTION, v);
    if (status) return status;
    double length = hypot(hypot(v[0], v[1]), v[2]);
    if (!(length > 0.0) || !isfinite(length))
        return lar_scene_fail(scene, node, LAR_ERROR_MODEL,
                              "%.40s: this vector has no direction; expected %s",
                              node->key ? node->key->text : "the direction", LAR_A_DIRECTION);
    for (int i = 0; i < 3; i++) unit[i] = v[i] / length;
    return LAR_OK;
}

bool lar_scene_is_integer(const lar_yaml *node, int64_t *value) {
    return node->kind == LAR_YAML_SCALAR && !node->quoted &&
           lar_span_int64((lar_span){node->text, strlen(node->text)}, value);
}

lar_status lar_scene_integer(const lar_scene *scene, const lar_yaml *node, const char *expected,
                             int64_t *value) {
    return lar_scene_is_integer(node, value) ? LAR_OK : wrong_type(scene, node, expected);
}

lar_status lar_scene_text(const lar_scene *scene, const lar_yaml *node, const char *expected,
                          const char **value) {
    if (node->kind != LAR_YAML_SCALAR || node->text[0] == '\0')
        return wrong_type(scene, node, expected);
    *value = node->text;
    return LAR_OK;
}

bool lar_scene_is_word(const lar_yaml *node, const char *word) {
    return node->kind == LAR_YAML_SCALAR && strcmp(node->text, word) == 0;
}
