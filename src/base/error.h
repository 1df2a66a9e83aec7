/* How errors travel.
 *
 * Three tiers:
 *   1. our own bugs: assert();
 *   2. what a user or the environment did: a lar_status returned and, beside it, one
 *      sentence in a lar_error that names file, line or element and the remedy;
 *   3. what happens while a simulation runs: the sticky fault word of step/step.h.
 *
 * The sentence is written once, where the trouble is found. Callers pass the status on
 * unchanged. Outputs are set on success only. The public types live in lariat.h, so that
 * an embedding program sees the same words.
 */
#ifndef LAR_BASE_ERROR_H
#define LAR_BASE_ERROR_H

#include "lariat.h"

/* Writes the message (printf-style, always terminated) into *error, which may be NULL, and returns
 * `status` for `return lar_fail(...)`. What is too long loses its middle (lar_text_print). */
lar_status lar_fail(lar_error *error, lar_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The message for memory that the system refuses. `what` names what it was for. */
lar_status lar_fail_memory(lar_error *error, size_t bytes, const char *what);

/* The same for a thread: `cause` is what starting it returned. */
lar_status lar_fail_thread(lar_error *error, int cause, const char *what);

/* What helps against the errno `cause` of a file: its own remedy where it has one, else `usual`. */
const char *lar_remedy(int cause, const char *usual);
#define LAR_FILE_REMEDY "check the folder, its permissions and the free space"

#endif
