#include "server/files.h"

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file/folder.h"
#include "base/memory.h"
#include "lariat.h"

/* Far above any viewer: a wrong folder is refused, not read. */
enum { FILES_MAX = 256, DEPTH_MAX = 4 };
static const size_t BYTES_MAX = 64u << 20;

static const char OCTETS[] = "application/octet-stream";

static const struct {
    const char *extension, *type;
} type_table[] = {{"html", "text/html; charset=utf-8"},
                  {"js", "text/javascript; charset=utf-8"},
                  {"mjs", "text/javascript; charset=utf-8"},
                  {"css", "text/css; charset=utf-8"},
                  {"json", "application/json"},
                  {"map", "application/json"},
                  {"webmanifest", "application/manifest+json"},
                  {"svg", "image/svg+xml"},
                  {"png", "image/png"},
                  {"jpg", "image/jpeg"},
                  {"webp", "image/webp"},
                  {"ico", "image/x-icon"},
                  {"woff2", "font/woff2"},
                  {"wasm", "application/wasm"},
                  {"glb", "model/gltf-binary"},
                  {"hdr", OCTETS},
                  {"txt", "text/plain; charset=utf-8"}};

static const char *type_of(const char *path) {
    const char *extension = lar_path_extension(path);
    for (size_t i = 0; i < sizeof type_table / sizeof type_table[0]; i++)
        if (strcmp(extension, type_table[i].extension) == 0) return type_table[i].type;
    return OCTETS;
}

/* ---- reading a folder ---------------------------------------------------------------------- */

typedef struct collector {
    lar_files *files;
    size_t capacity, bytes;
    const char *root;
    lar_error *error;
} collector;

/* `at` is the path below the root, "" or "/assets". */
static lar_status read_folder(collector *c, const char *at, int depth);

static lar_status add_file(collector *c, const char *path, const char *at, size_t size) {
    lar_files *files = c->files;
    lar_bytes bytes;
    c->bytes += size;
    if (files->count == FILES_MAX || c->bytes > BYTES_MAX)
        return lar_fail(c->error, LAR_ERROR_ARGUMENT,
                        "%s: this is no folder of a viewer: more than %d files or %zu MB; give the "
                        "one that the viewer was built into",
                        c->root, FILES_MAX, BYTES_MAX >> 20);
    if (!LAR_GROW(files->file, c->capacity, files->count))
        return lar_fail_memory(c->error, sizeof *files->file, "the viewer's files");
    lar_status status = lar_bytes_read(path, &bytes, c->error);
    if (status) return status;
    char *name = lar_strdup(at);
    if (!name) {
        lar_bytes_free(&bytes);
        return lar_fail_memory(c->error, strlen(at), "the viewer's files");
    }
    files->file[files->count++] = (lar_file){.path = name,
                                             .type = type_of(name),
                                             .lasting = strncmp(at, "/assets/", 8) == 0,
                                             .data = bytes.data,
                                             .size = bytes.size};
    return LAR_OK;
}

static lar_status add_entry(collector *c, const char *at, const char *name, int depth) {
    struct stat found;
    lar_status status = LAR_OK;
    char *below = lar_folder_join(at, name);
    char *path = below ? lar_folder_join(c->root, below + 1) : NULL;
    if (!path)
        status = lar_fail_memory(c->error, 4096, "the viewer's files");
    else if (lstat(path, &found) != 0)
        status = lar_fail(c->error, LAR_ERROR_IO, "%s: cannot be read: %s", path, strerror(errno));
    else if (S_ISDIR(found.st_mode) && depth < DEPTH_MAX)
        status = read_folder(c, below, depth + 1);
    else if (S_ISREG(found.st_mode) && found.st_size > 0)
        status = add_file(c, path, below, (size_t)found.st_size);
    free(path);
    free(below);
    return status;
}

static lar_status read_folder(collector *c, const char *at, int depth) {
    char *path = *at ? lar_folder_join(c->root, at + 1) : lar_strdup(c->root);
    if (!path) return lar_fail_memory(c->error, 4096, "the viewer's files");
    DIR *folder = opendir(path);
    lar_status status = LAR_OK;
    if (!folder)
        status = lar_fail(c->error, LAR_ERROR_IO,
                          "%s: the folder of the viewer cannot be read: %s; give the one that it "
                          "was built into",
                          path, strerror(errno));
    for (struct dirent *entry = NULL; !status && (entry = readdir(folder));)
        if (entry->d_name[0] != '.') status = add_entry(c, at, entry->d_name, depth);
    if (folder) closedir(folder);
    free(path);
    return status;
}

/* ---- which folder ---------------------------------------------------------------------------- */

#ifdef LAR_VIEWER_PACKAGE
#define LAR_VIEWER_FOLDER "" /* only where packages put it */
#define LAR_BUILD_FOLDER  ""
#define ABSENT_WHY                                                                                 \
    "<h1>The engine runs, but its viewer is not installed</h1><p>It is a package of its own: "     \
    "<code>apt-get install " LAR_VIEWER_PACKAGE "</code>, "
#else
#define ABSENT_WHY                                                                                 \
    "<h1>The engine runs, but its viewer is not built</h1>"                                        \
    "<p>The viewer is made of the files in <code>web/</code> by npm. With Debian's packages: "     \
    "<code>apt-get install nodejs npm</code>, then <code>make</code> in Lariat's folder, where "   \
    "npm reaches its registry, "
#endif

/* The page that stands in for a viewer that is not there. */
static const char ABSENT[] =
    "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Lariat</title>" ABSENT_WHY
    "and start <code>lariat view</code> again.</p>"
    "<p>Other viewers can connect to this address meanwhile: docs/viewer-protocol.md.</p></html>";

static bool is_folder(const char *path) {
    struct stat found;
    return stat(path, &found) == 0 && S_ISDIR(found.st_mode);
}

static char *cut_last(char *path) {
    char *slash = strrchr(path, '/');
    if (!slash) return NULL;
    *slash = '\0';
    return slash + 1;
}

/* Where pip puts the page of a wheel, whose command lies in PREFIX/bin: into the module. */
static bool wheel_folder(const char *prefix, char *out, size_t size) {
    char pattern[4096];
    glob_t found = {0};
    int length =
        snprintf(pattern, sizeof pattern, "%s/lib/python3*/site-packages/lariat/viewer", prefix);
    bool there = length > 0 && (size_t)length < sizeof pattern &&
                 glob(pattern, GLOB_ONLYDIR, NULL, &found) == 0 && found.gl_pathc > 0 &&
                 strlen(found.gl_pathv[0]) < size;
    if (there) memcpy(out, found.gl_pathv[0], strlen(found.gl_pathv[0]) + 1);
    globfree(&found);
    return there && is_folder(out);
}

/* The folder of the file that this code lies in. */
static bool own_folder(char path[4096]) {
    static const char here;
    Dl_info module;
    if (!dladdr(&here, &module) || !module.dli_fname) return false;
    /* A command that the shell found on its PATH goes by its bare name. */
    const char *file = strchr(module.dli_fname, '/') ? module.dli_fname : "/proc/self/exe";
    return realpath(file, path) && cut_last(path);
}

/* PREFIX/share/lariat/viewer, when this code lies in PREFIX/bin, PREFIX/lib or one below: an
 * installed tree may be moved. False when there is none. */
static bool installed_folder(char *out, size_t size) {
    char path[4096];
    if (!own_folder(path)) return false;
    for (int i = 0; i < 2; i++) {
        const char *name = cut_last(path);
        if (!name) return false;
        if (strcmp(name, "bin") != 0 && strncmp(name, "lib", 3) != 0) continue;
        int length = snprintf(out, size, "%s/%s", path, LAR_VIEWER_BELOW_PREFIX);
        if (length > 0 && (size_t)length < size && is_folder(out)) return true;
        return wheel_folder(path, out, size);
    }
    return false;
}

/* Whether this code lies where it was built: what is installed serves no page out of a folder that
 * may be anybody's by then. */
static bool is_where_built(void) {
    char path[4096], built[4096];
    size_t length;
    if (!own_folder(path) || !realpath(LAR_BUILD_FOLDER, built)) return false;
    length = strlen(built);
    return strncmp(path, built, length) == 0 && (path[length] == '/' || path[length] == '\0');
}

static lar_status read_default(lar_files *files, lar_error *error) {
    char path[4096];
    if (installed_folder(path, sizeof path)) return lar_files_read(path, files, error);
    snprintf(path, sizeof path, "%s/index.html", LAR_VIEWER_FOLDER);
    struct stat found;
    if (*LAR_VIEWER_FOLDER && is_where_built() && stat(path, &found) == 0)
        return lar_files_read(LAR_VIEWER_FOLDER, files, error);
    files->file = lar_calloc(1, sizeof *files->file);
    char *name = lar_strdup("/index.html"), *data = lar_strdup(ABSENT);
    if (!files->file || !name || !data) {
        free(files->file);
        free(name);
        free(data);
        files->file = NULL;
        return lar_fail_memory(error, sizeof ABSENT, "the viewer's files");
    }
    files->count = 1;
    files->file[0] = (lar_file){
        .path = name, .type = type_of(name), .data = (unsigned char *)data, .size = strlen(data)};
    return LAR_OK;
}

int lar_server_has_page(void) {
    lar_files files;
    if (lar_files_read(NULL, &files, NULL)) return 0;
    int whole = files.count > 1; /* what stands in for it is one file */
    lar_files_clear(&files);
    return whole;
}

lar_status lar_files_read(const char *folder, lar_files *files, lar_error *error) {
    *files = (lar_files){0};
    if (!folder) return read_default(files, error);
    collector c = {.files = files, .root = folder, .error = error};
    lar_status status = read_folder(&c, "", 0);
    if (!status && !lar_files_find(files, "/"))
        status = lar_fail(error, LAR_ERROR_IO,
                          "%s: there is no index.html; give the folder that the viewer was built "
                          "into",
                          folder);
    if (status) lar_files_clear(files);
    return status;
}

void lar_files_clear(lar_files *files) {
    for (int32_t i = 0; i < files->count; i++) {
        free(files->file[i].path);
        free(files->file[i].data);
    }
    free(files->file);
    *files = (lar_files){0};
}

const lar_file *lar_files_find(const lar_files *files, const char *path) {
    if (strcmp(path, "/") == 0) path = "/index.html";
    for (int32_t i = 0; i < files->count; i++)
        if (strcmp(files->file[i].path, path) == 0) return &files->file[i];
    return NULL;
}
