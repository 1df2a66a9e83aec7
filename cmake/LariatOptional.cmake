# Optional libraries: found, tried, and told in one line when they are not used.
#
#     looked for     by pkg-config, find_library and find_path, or a compiler wrapper
#     tried          a program that includes the header and calls the library is compiled and linked
#     LARIAT_HAVE_X  set only when that worked: what is half installed is not there
#
# Debian brings halves along: openmpi-bin has mpicc without mpi.h, a library comes without its
# -dev package. Everything is asked again at every configuration, so that what was installed or
# removed meanwhile is seen; a try takes some hundredths of a second, which try_compile does not.
set(LARIAT_OPTIONAL_NAMES cminpack hwloc libwebsockets metis mpi nifti petsc png python sdl2 ucx)
set(LARIAT_WITHOUT "" CACHE STRING "Optional libraries to leave out: a list of ${LARIAT_OPTIONAL_NAMES}")
foreach(name ${LARIAT_WITHOUT})
  if(NOT name IN_LIST LARIAT_OPTIONAL_NAMES)
    message(FATAL_ERROR "LARIAT_WITHOUT: ${name} is no optional library; there are "
      "${LARIAT_OPTIONAL_NAMES}")
  endif()
endforeach()

# pkg_check_modules without its memory of earlier configurations.
macro(lariat_pkg prefix module)
  unset(__pkg_config_checked_${prefix} CACHE)
  pkg_check_modules(${prefix} QUIET IMPORTED_TARGET ${module})
endmacro()

# lariat_links(RESULT NAME SOURCE text INCLUDES folders LIBRARIES libraries): whether that program
# compiles and links. Libraries are paths, names or options of the linker.
function(lariat_links result name)
  cmake_parse_arguments(PARSE_ARGV 2 try "" "SOURCE" "INCLUDES;LIBRARIES")
  set(folder ${PROJECT_BINARY_DIR}/CMakeFiles/optional)
  file(WRITE ${folder}/${name}.c "${try_SOURCE}\n")
  separate_arguments(flags UNIX_COMMAND "${CMAKE_C_COMPILER_ARG1} ${CMAKE_C_FLAGS}")
  list(TRANSFORM try_INCLUDES PREPEND -I)
  list(TRANSFORM try_LIBRARIES REPLACE "^([^-/].*)$" "-l\\1")
  execute_process(COMMAND ${CMAKE_C_COMPILER} ${flags} -w ${try_INCLUDES} ${folder}/${name}.c
    -o ${folder}/${name} ${try_LIBRARIES}
    RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  file(WRITE ${folder}/${name}.log "${output}")
  if(failed)
    set(${result} FALSE PARENT_SCOPE)
  else()
    set(${result} TRUE PARENT_SCOPE)
  endif()
endfunction()

# lariat_optional(NAME CALLED title PACKAGE package WITHOUT consequence SIGNS found...
#   SOURCE text INCLUDES folders LIBRARIES libraries): sets LARIAT_HAVE_<NAME>. SIGNS: what was found
# of it; one that is true is a half.
function(lariat_optional name)
  cmake_parse_arguments(PARSE_ARGV 1 this "" "CALLED;PACKAGE;WITHOUT;SOURCE"
    "SIGNS;INCLUDES;LIBRARIES")
  string(TOUPPER ${name} upper)
  set(have FALSE)
  set(half FALSE)
  foreach(sign ${this_SIGNS})
    if(sign)
      set(half TRUE)
    endif()
  endforeach()
  if(name IN_LIST LARIAT_WITHOUT)
    message(STATUS "${this_CALLED} left out (LARIAT_WITHOUT): ${this_WITHOUT}")
  elseif(NOT half)
    message(STATUS "${this_CALLED} not found: ${this_WITHOUT} (apt-get install ${this_PACKAGE})")
  else()
    lariat_links(have ${name} SOURCE "${this_SOURCE}" INCLUDES ${this_INCLUDES}
      LIBRARIES ${this_LIBRARIES})
    if(NOT have)
      message(NOTICE "${this_CALLED} is only half installed and not used: ${this_WITHOUT} "
        "(apt-get install ${this_PACKAGE})")
    endif()
  endif()
  set(LARIAT_HAVE_${upper} ${have} PARENT_SCOPE)
endfunction()

# ---- what the library and the command may have -----------------------------------------------

lariat_pkg(HWLOC hwloc)
lariat_optional(hwloc CALLED hwloc PACKAGE libhwloc-dev WITHOUT "threads are not bound to cores"
  SIGNS "${HWLOC_FOUND}" INCLUDES ${HWLOC_INCLUDE_DIRS} LIBRARIES ${HWLOC_LINK_LIBRARIES}
  SOURCE "#include <hwloc.h>
int main(void) { hwloc_topology_t t; return hwloc_topology_init(&t); }")

# METIS has no pkg-config file.
find_library(METIS_LIBRARY metis NO_CACHE)
find_path(METIS_INCLUDE metis.h NO_CACHE)
lariat_optional(metis CALLED METIS PACKAGE libmetis-dev
  WITHOUT "lariat partition lacks --method metis"
  SIGNS "${METIS_LIBRARY}" "${METIS_INCLUDE}" INCLUDES ${METIS_INCLUDE} LIBRARIES ${METIS_LIBRARY}
  SOURCE "#include <metis.h>
int main(void) { idx_t o[METIS_NOPTIONS]; return METIS_SetDefaultOptions(o) != METIS_OK; }")

# Least squares of parameter fits.
lariat_pkg(CMINPACK cminpack)
lariat_optional(cminpack CALLED cminpack PACKAGE libcminpack-dev WITHOUT "no lariat fit"
  SIGNS "${CMINPACK_FOUND}" INCLUDES ${CMINPACK_INCLUDE_DIRS} LIBRARIES ${CMINPACK_LINK_LIBRARIES}
  SOURCE "#include <cminpack.h>
int main(void) { double x[2] = {3, 4}; return enorm(2, x) != 5; }")

# Frames of a camera, for profiles.
lariat_pkg(PNG libpng>=1.6)
lariat_optional(png CALLED libpng PACKAGE libpng-dev WITHOUT "lariat fit --profile reads no .png"
  SIGNS "${PNG_FOUND}" INCLUDES ${PNG_INCLUDE_DIRS} LIBRARIES ${PNG_LINK_LIBRARIES}
  SOURCE "#include <png.h>
int main(void) { png_image i = {.version = PNG_IMAGE_VERSION}; png_image_free(&i); return 0; }")

# Label images of NIfTI, -1 and -2. Older packages of libnifti lack the second.
find_library(NIFTI_LIBRARY nifti2 NO_CACHE)
find_path(NIFTI_INCLUDE nifti2_io.h PATH_SUFFIXES nifti NO_CACHE)
lariat_optional(nifti CALLED libnifti PACKAGE libnifti-dev WITHOUT "lariat mesh reads no .nii"
  SIGNS "${NIFTI_LIBRARY}" "${NIFTI_INCLUDE}" INCLUDES ${NIFTI_INCLUDE} LIBRARIES ${NIFTI_LIBRARY}
  SOURCE "#include <nifti2_io.h>
int main(void) { return is_nifti_file(\"none\") > 0; }")

# Processors of a cluster.
lariat_pkg(UCX ucx>=1.10)
lariat_optional(ucx CALLED UCX PACKAGE libucx-dev WITHOUT "no backend ucx"
  SIGNS "${UCX_FOUND}" INCLUDES ${UCX_INCLUDE_DIRS} LIBRARIES ${UCX_LINK_LIBRARIES}
  SOURCE "#include <ucp/api/ucp.h>
int main(void) { unsigned a, b, c; ucp_get_version(&a, &b, &c); return 0; }")

# Game controllers. The library is loaded when one is opened; its headers are needed here, and the
# library itself by a test.
lariat_pkg(SDL2 sdl2>=2.0.14)
lariat_optional(sdl2 CALLED SDL2 PACKAGE libsdl2-dev WITHOUT "no devices of kind gamepad"
  SIGNS "${SDL2_FOUND}" INCLUDES ${SDL2_INCLUDE_DIRS} LIBRARIES ${SDL2_LINK_LIBRARIES}
  SOURCE "#define SDL_MAIN_HANDLED
#include <SDL.h>
int main(void) { return SDL_WasInit(0) != 0; }")

# The server for viewers.
lariat_pkg(LWS libwebsockets>=4.1)
lariat_optional(libwebsockets CALLED libwebsockets PACKAGE libwebsockets-dev
  WITHOUT "no lariat view"
  SIGNS "${LWS_FOUND}" INCLUDES ${LWS_INCLUDE_DIRS} LIBRARIES ${LWS_LINK_LIBRARIES}
  SOURCE "#include <libwebsockets.h>
int main(void) { return !lws_get_library_version(); }")

# Solvers of the implicit comparison. Its headers want MPI's, which its own pkg-config file does not
# name.
lariat_pkg(PETSC PETSc>=3.12)
set(LARIAT_PETSC_INCLUDES ${PETSC_INCLUDE_DIRS})
find_program(LARIAT_PETSC_WRAPPER mpicc.openmpi NO_CACHE)
if(PETSC_FOUND AND LARIAT_PETSC_WRAPPER)
  execute_process(COMMAND ${LARIAT_PETSC_WRAPPER} --showme:incdirs OUTPUT_VARIABLE folders
    ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(NOT failed)
    separate_arguments(folders UNIX_COMMAND "${folders}")
    list(APPEND LARIAT_PETSC_INCLUDES ${folders})
  endif()
endif()
lariat_optional(petsc CALLED PETSc PACKAGE petsc-dev
  WITHOUT "lariat bench implicit has its own solver only"
  SIGNS "${PETSC_FOUND}" INCLUDES ${LARIAT_PETSC_INCLUDES} LIBRARIES ${PETSC_LINK_LIBRARIES}
  SOURCE "#include <petscksp.h>
int main(void) { return PetscInitializeNoArguments() != 0; }")

# `import lariat`. Headers of CPython 3.11 or later, of the interpreter that is there or of another;
# no library: the interpreter brings what the module calls.
find_program(PYTHON3 python3 NO_CACHE)
set(PYTHON_INCLUDE ${PYTHON_INCLUDE_FIRST})
if(PYTHON3 AND NOT EXISTS "${PYTHON_INCLUDE}/Python.h")
  execute_process(COMMAND ${PYTHON3} -c "import sysconfig; print(sysconfig.get_path('include'))"
    OUTPUT_VARIABLE PYTHON_INCLUDE ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
endif()
if(NOT EXISTS "${PYTHON_INCLUDE}/Python.h")
  if(NOT PYTHON_INCLUDE_ROOT)
    set(PYTHON_INCLUDE_ROOT /usr/include)
  endif()
  file(GLOB LARIAT_PYTHON_HEADERS "${PYTHON_INCLUDE_ROOT}/python3.*/Python.h")
  list(SORT LARIAT_PYTHON_HEADERS COMPARE NATURAL ORDER DESCENDING)
  set(PYTHON_INCLUDE "")
  if(LARIAT_PYTHON_HEADERS)
    list(GET LARIAT_PYTHON_HEADERS 0 PYTHON_INCLUDE)
    string(REGEX REPLACE "/Python.h$" "" PYTHON_INCLUDE "${PYTHON_INCLUDE}")
  endif()
endif()
lariat_optional(python CALLED "Python headers" PACKAGE python3-dev
  WITHOUT "the Python module is not built"
  SIGNS "${PYTHON_INCLUDE}" INCLUDES ${PYTHON_INCLUDE}
  SOURCE "#define Py_LIMITED_API 0x030b0000
#include <Python.h>
#if PY_VERSION_HEX < 0x030b0000
#error too old
#endif
int main(void) { return sizeof(PyObject) == 0; }")
