#include "cli/build_info.h"

#include <lariat_build.h> /* cmake/LariatBuildInfo.cmake writes it at every build */

const char *const cli_build_commit = LAR_BUILD_COMMIT;
const char *const cli_build_flags = LAR_BUILD_FLAGS;
#if defined __clang__
const char *const cli_build_compiler = "clang " __clang_version__;
#elif defined __GNUC__
const char *const cli_build_compiler = "gcc " __VERSION__;
#else
const char *const cli_build_compiler = "unknown";
#endif
