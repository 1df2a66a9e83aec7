# What this build is of, for the JSON of the benchmarks: a header that is rewritten only when it
# changes, so that a commit rebuilds one file. Run at every build:
#     cmake -DSOURCE=DIR -DFLAGS=TEXT -DHEADER=FILE -P LariatBuildInfo.cmake
set(commit "unknown")
find_program(GIT git)
# A copy without .git may lie inside another project's checkout, whose commit says nothing.
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(
    COMMAND ${GIT} --no-optional-locks describe --always --dirty=-changed --abbrev=40 --exclude=*
    WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE found RESULT_VARIABLE failed ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT failed)
    set(commit ${found})
  endif()
endif()
string(STRIP "${FLAGS}" FLAGS)
string(REPLACE "\\" "\\\\" FLAGS "${FLAGS}")
string(REPLACE "\"" "\\\"" FLAGS "${FLAGS}")
set(text "#define LAR_BUILD_COMMIT \"${commit}\"\n#define LAR_BUILD_FLAGS \"${FLAGS}\"\n")
set(before "")
if(EXISTS ${HEADER})
  file(READ ${HEADER} before)
endif()
if(NOT before STREQUAL text)
  file(WRITE ${HEADER} "${text}")
endif()
