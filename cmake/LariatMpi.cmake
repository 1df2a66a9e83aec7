# Backend mpi: one loadable module for every MPI that is installed (src/comm/mpi_shim.h). What a
# program needs to be compiled with MPI is asked of its compiler wrapper, not of find_package(MPI),
# which knows only one MPI at a time. A wrapper alone is no MPI: Debian's openmpi-bin and mpich have
# one without the headers.
#
# lariat_mpi(name title package option wrapper...): the first wrapper that answers `option` with
# flags with which a program of MPI compiles and links.
set(LARIAT_HAVE_MPI)
function(lariat_mpi name title package probe)
  set(half FALSE)
  foreach(wrapper ${ARGN})
    find_program(found ${wrapper} NO_CACHE)
    if(NOT found)
      continue()
    endif()
    execute_process(COMMAND ${found} ${probe}
      OUTPUT_VARIABLE words ERROR_QUIET RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE)
    unset(found)
    if(failed)
      continue()
    endif()
    separate_arguments(words UNIX_COMMAND "${words}")
    set(folders ${words})
    list(FILTER folders INCLUDE REGEX "^-I")
    list(TRANSFORM folders REPLACE "^-I" "")
    list(FILTER words INCLUDE REGEX "^-(L|l|Wl,)")
    lariat_links(works mpi-${name} INCLUDES ${folders} LIBRARIES ${words} SOURCE
      "#include <mpi.h>
int main(void) { int there; return MPI_Initialized(&there); }")
    if(NOT works)
      set(half TRUE)
      continue()
    endif()
    set(target lariat-mpi-${name})
    add_library(${target} MODULE comm/mpi_shim.c)
    target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
    target_include_directories(${target} SYSTEM PRIVATE ${folders})
    target_link_libraries(${target} PRIVATE lariat_flags ${words})
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${target} PREFIX lib SUFFIX .so
      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
    set(LARIAT_HAVE_MPI ${LARIAT_HAVE_MPI} ${name} PARENT_SCOPE)
    return()
  endforeach()
  if(half)
    message(NOTICE "${title} is only half installed and not used: no backend mpi with it "
      "(apt-get install ${package})")
  endif()
endfunction()

if(mpi IN_LIST LARIAT_WITHOUT)
  message(STATUS "MPI left out (LARIAT_WITHOUT): no backend mpi and no start by mpirun")
else()
  # `mpicc` alone may be either: only Open MPI's knows --showme, only MPICH's -link_info.
  lariat_mpi(openmpi "Open MPI" libopenmpi-dev --showme mpicc.openmpi mpicc)
  lariat_mpi(mpich MPICH libmpich-dev -link_info mpicc.mpich mpicc)
  if(NOT LARIAT_HAVE_MPI)
    message(STATUS "MPI not found: no backend mpi and no start by mpirun "
      "(apt-get install libopenmpi-dev or libmpich-dev)")
  endif()
endif()
# A module of an earlier configuration, whose MPI is gone: the command would find it.
foreach(name openmpi mpich)
  if(NOT TARGET lariat-mpi-${name})
    file(REMOVE ${PROJECT_BINARY_DIR}/liblariat-mpi-${name}.so)
  endif()
endforeach()
if(LARIAT_HAVE_MPI)
  set_property(SOURCE comm/mpi.c APPEND PROPERTY COMPILE_DEFINITIONS LAR_HAVE_MPI)
endif()
# From the command's folder to where the modules are installed.
file(RELATIVE_PATH LARIAT_MPI_FROM_BIN "/root/${CMAKE_INSTALL_BINDIR}"
  "/root/${CMAKE_INSTALL_LIBDIR}")
set_property(SOURCE comm/mpi_world.c APPEND PROPERTY COMPILE_DEFINITIONS
  LAR_MPI_FROM_BIN="${LARIAT_MPI_FROM_BIN}")
