# Backend mpi: one loadable module for every MPI that is installed (src/comm/mpi_shim.h). What a
# program needs to be compiled with MPI is asked of its compiler wrapper, not of find_package(MPI),
# which knows only one MPI at a time.
#
# lariat_mpi(name option wrapper...): the first wrapper that answers `option` with flags.
set(LARIAT_MPI_FOUND)
function(lariat_mpi name probe)
  foreach(wrapper ${ARGN})
    string(MAKE_C_IDENTIFIER ${name}_${wrapper} id)
    find_program(LARIAT_WRAPPER_${id} ${wrapper})
    mark_as_advanced(LARIAT_WRAPPER_${id})
    if(NOT LARIAT_WRAPPER_${id})
      continue()
    endif()
    execute_process(COMMAND ${LARIAT_WRAPPER_${id}} ${probe}
      OUTPUT_VARIABLE words ERROR_QUIET RESULT_VARIABLE failed OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(failed)
      continue()
    endif()
    separate_arguments(words UNIX_COMMAND "${words}")
    set(folders ${words})
    list(FILTER folders INCLUDE REGEX "^-I")
    list(TRANSFORM folders REPLACE "^-I" "")
    list(FILTER words INCLUDE REGEX "^-(L|l|Wl,)")
    set(target lariat-mpi-${name})
    add_library(${target} MODULE comm/mpi_shim.c)
    target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
    target_include_directories(${target} SYSTEM PRIVATE ${folders})
    target_link_libraries(${target} PRIVATE lariat_flags ${words})
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${target} PREFIX lib SUFFIX .so
      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
    set(LARIAT_MPI_FOUND ${LARIAT_MPI_FOUND} ${name} PARENT_SCOPE)
    return()
  endforeach()
endfunction()

# `mpicc` alone may be either: only Open MPI's knows --showme, only MPICH's -link_info.
lariat_mpi(openmpi --showme mpicc.openmpi mpicc)
lariat_mpi(mpich -link_info mpicc.mpich mpicc)
if(LARIAT_MPI_FOUND)
  set_property(SOURCE comm/mpi.c APPEND PROPERTY COMPILE_DEFINITIONS LAR_HAVE_MPI)
else()
  message(STATUS "MPI not found: no backend mpi and no start by mpirun "
    "(install libopenmpi-dev or libmpich-dev)")
endif()
# From the command's folder to where the modules are installed.
file(RELATIVE_PATH LARIAT_MPI_FROM_BIN "/root/${CMAKE_INSTALL_BINDIR}"
  "/root/${CMAKE_INSTALL_LIBDIR}")
set_property(SOURCE comm/mpi_world.c APPEND PROPERTY COMPILE_DEFINITIONS
  LAR_MPI_FROM_BIN="${LARIAT_MPI_FROM_BIN}")
