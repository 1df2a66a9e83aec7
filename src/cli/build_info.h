/* What this command was built of. */
#ifndef LAR_CLI_BUILD_INFO_H
#define LAR_CLI_BUILD_INFO_H

/* The commit, with "-changed" behind it when there were changes that are in none; "unknown" when it
 * was not built in a git checkout. */
extern const char *const cli_build_commit;
/* As in "gcc 12.2.0". */
extern const char *const cli_build_compiler;
/* Of every source; the element kernels have those of their instruction set besides. */
extern const char *const cli_build_flags;

#endif
