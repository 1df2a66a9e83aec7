/* Which saved states and recordings there are, also from sessions before. */
#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file/folder.h"
#include "server/state.h"

void lar_saved_add(lar_saved_list *list, const char *name) {
    if (list->count == LAR_SAVES_MAX) {
        list->count--;
        memmove(list->name, list->name + 1, (size_t)list->count * sizeof *list->name);
    }
    snprintf(list->name[list->count++], sizeof *list->name, "%s", name);
}

const char *lar_saved_find(const lar_saved_list *list, const char *name) {
    for (int i = list->count - 1; i >= 0; i--)
        if (!name[0] || strcmp(name, list->name[i]) == 0) return list->name[i];
    return NULL;
}

/* ---- what lies in the folder ----------------------------------------------------------------- */

enum { FOUND_MAX = 4096 };

typedef struct found_file {
    char name[LAR_NAME_MAX + 1];
    struct timespec at;
    bool recording;
} found_file;

static int older_first(const void *a, const void *b) {
    const found_file *x = a, *y = b;
    if (x->at.tv_sec != y->at.tv_sec) return x->at.tv_sec < y->at.tv_sec ? -1 : 1;
    if (x->at.tv_nsec != y->at.tv_nsec) return x->at.tv_nsec < y->at.tv_nsec ? -1 : 1;
    return strcmp(x->name, y->name);
}

/* Names that a message can hold as they are. */
static bool good_name(const char *name) {
    size_t length = strlen(name);
    for (const char *c = name; *c; c++)
        if ((unsigned char)*c < 0x20 || (unsigned char)*c >= 0x7f || *c == '"' || *c == '\\' ||
            *c == '/')
            return false;
    return length > 0 && length <= LAR_NAME_MAX && name[0] != '.';
}

/* Whether it belongs to what is simulated here; files may have other spares. */
static bool fits(const lar_server *server, const char *path, bool recording) {
    const lar_simulation_info *here = &server->simulated;
    lar_checkpoint_info c;
    lar_recording_info r;
    if (recording && lar_recording_inspect(path, &r, NULL)) return false;
    if (!recording && lar_checkpoint_inspect(path, &c, NULL)) return false;
    if (recording)
        c = (lar_checkpoint_info){.element = r.element,
                                  .nodes = r.nodes,
                                  .elements = r.elements,
                                  .tools = r.tools,
                                  .time_step = r.time_step};
    return c.nodes == lar_model_node_count(server->model) &&
           c.elements == lar_model_element_count(server->model) && c.tools == here->tools &&
           c.time_step == here->time_step && c.element == here->element;
}

static bool look_at(const lar_server *server, const char *name, found_file *found) {
    const char *extension = lar_path_extension(name);
    struct stat about;
    found->recording = strcmp(extension, "recording") == 0;
    if ((!found->recording && strcmp(extension, "checkpoint") != 0) || !good_name(name))
        return false;
    char *path = lar_folder_join(server->save_folder, name);
    bool good = path && lstat(path, &about) == 0 && S_ISREG(about.st_mode) &&
                fits(server, path, found->recording);
    if (good) {
        memcpy(found->name, name, strlen(name) + 1); /* a good name fits */
        found->at = about.st_mtim;
    }
    free(path);
    return good;
}

bool lar_server_saves_full(const lar_server *server) {
    DIR *folder = opendir(server->save_folder);
    double bytes = 0;
    for (struct dirent *entry = folder ? readdir(folder) : NULL; entry; entry = readdir(folder)) {
        const char *extension = lar_path_extension(entry->d_name);
        struct stat about;
        bool ours = strcmp(extension, "recording") == 0 || strcmp(extension, "checkpoint") == 0;
        if (ours && fstatat(dirfd(folder), entry->d_name, &about, AT_SYMLINK_NOFOLLOW) == 0)
            bytes += (double)about.st_size;
    }
    if (folder) closedir(folder);
    return bytes >= server->save_max;
}

void lar_server_list_saved(lar_server *server) {
    DIR *folder = server->save_folder ? opendir(server->save_folder) : NULL;
    found_file *found = folder ? lar_calloc(FOUND_MAX, sizeof *found) : NULL;
    int count = 0;
    for (struct dirent *entry = found ? readdir(folder) : NULL; entry && count < FOUND_MAX;
         entry = readdir(folder))
        count += look_at(server, entry->d_name, &found[count]);
    if (count > 0) qsort(found, (size_t)count, sizeof *found, older_first);
    for (int i = 0; i < count; i++)
        lar_saved_add(found[i].recording ? &server->recordings : &server->states, found[i].name);
    free(found);
    if (folder) closedir(folder);
}
