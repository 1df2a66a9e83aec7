#include "study/label_list.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/vector.h"
#include "meshing/image/image.h"

void lar_label_list_clear(lar_label_list *list) {
    for (int32_t i = 0; i < list->count; i++) free(list->row[i].name);
    free(list->row);
    *list = (lar_label_list){0};
}

static lar_status fill(const lar_image *image, lar_label_list *list, lar_error *error) {
    int64_t *voxels = lar_calloc(LAR_IMAGE_LABEL_MAX + 1, sizeof *voxels);
    size_t rows = 0;
    if (voxels) lar_image_count(image, voxels);
    for (int32_t l = 1; voxels && l <= LAR_IMAGE_LABEL_MAX; l++) rows += voxels[l] > 0;
    list->row = voxels ? lar_calloc(rows, sizeof *list->row) : NULL;
    bool good = list->row != NULL;
    for (int32_t l = 1; good && l <= LAR_IMAGE_LABEL_MAX; l++) {
        if (voxels[l] == 0) continue;
        const char *name = lar_image_label_name(image, l);
        lar_label_row *row = &list->row[list->count++];
        *row = (lar_label_row){l, name ? lar_strdup(name) : NULL, voxels[l]};
        good = !name || row->name;
    }
    free(voxels);
    if (!good) return lar_fail_memory(error, rows * sizeof *list->row, "a list of labels");
    memcpy(list->size, image->size, sizeof list->size);
    list->voxel = lar_image_voxel_volume(image);
    for (int a = 0; a < 3; a++) {
        double step[3];
        for (int d = 0; d < 3; d++) step[d] = image->to_world[d][a];
        list->edge[a] = lar_length(step);
    }
    return LAR_OK;
}

lar_status lar_label_list_read(const char *path, const char *names, lar_label_list *list,
                               lar_error *error) {
    *list = (lar_label_list){0};
    lar_image image = {0};
    lar_status status = lar_image_read(path, &image, error);
    if (!status && names) status = lar_image_read_names(names, &image, error);
    if (!status) status = fill(&image, list, error);
    lar_image_clear(&image);
    if (status) lar_label_list_clear(list);
    return status;
}

bool lar_label_list_has(const lar_label_list *list, const char *word) {
    char *end;
    long number = strtol(word, &end, 10);
    bool numeric = end != word && *end == '\0';
    for (int32_t i = 0; i < list->count; i++) {
        const lar_label_row *row = &list->row[i];
        if (numeric && row->label == number) return true;
        if (row->name && strcasecmp(row->name, word) == 0) return true;
    }
    return false;
}
