#include "base/error.h"

#include <errno.h>
#include <stdarg.h>
#include <string.h>

#include "base/text.h"

lar_status lar_fail(lar_error *error, lar_status status, const char *format, ...) {
    if (error) {
        va_list args;
        va_start(args, format);
        lar_text_print(error->message, sizeof error->message, format, args);
        va_end(args);
        error->status = status;
    }
    return status;
}

lar_status lar_fail_memory(lar_error *error, size_t bytes, const char *what) {
    return lar_fail(error, LAR_ERROR_MEMORY,
                    "out of memory: %zu bytes for %s could not be had; use a smaller model or a "
                    "machine with more memory",
                    bytes, what);
}

lar_status lar_fail_thread(lar_error *error, int cause, const char *what) {
    return lar_fail(error, LAR_ERROR_MEMORY,
                    "the system gives no thread for %s: %s; free memory, or raise the limit "
                    "(ulimit -u)",
                    what, strerror(cause));
}

const char *lar_remedy(int cause, const char *usual) {
    if (cause == EMFILE) return "raise the limit on open files (ulimit -n)";
    if (cause == EFBIG) return "raise the limit on the size of files (ulimit -f)";
    if (cause == EROFS) return "mount it for writing or take another place";
    return usual;
}
