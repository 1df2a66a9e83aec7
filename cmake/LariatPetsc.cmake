# Optional: PETSc solves the linear systems of the implicit comparison (src/study/petsc_shim.h), in
# a loadable module, because it brings an MPI and some dozen libraries that nothing else needs.
pkg_check_modules(PETSC QUIET IMPORTED_TARGET PETSc>=3.12)
if(PETSC_FOUND)
  add_library(lariat-petsc MODULE study/petsc_shim.c)
  # Headers of others, MPI's among them (of the compiler wrapper), warn.
  execute_process(COMMAND mpicc.openmpi --showme:incdirs OUTPUT_VARIABLE folders ERROR_QUIET
    OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(failed)
    set(folders)
  endif()
  separate_arguments(folders UNIX_COMMAND "${folders}")
  target_include_directories(lariat-petsc PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_include_directories(lariat-petsc PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_include_directories(lariat-petsc SYSTEM PRIVATE ${PETSC_INCLUDE_DIRS} ${folders})
  target_link_libraries(lariat-petsc PRIVATE lariat_flags ${PETSC_LINK_LIBRARIES})
  set_target_properties(lariat-petsc PROPERTIES PREFIX lib SUFFIX .so
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  install(TARGETS lariat-petsc LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
else()
  message(STATUS "PETSc not found: lariat bench implicit has its own solver only "
    "(install petsc-dev)")
endif()
# From the command's folder to where the module is installed.
file(RELATIVE_PATH LARIAT_PETSC_FROM_BIN "/root/${CMAKE_INSTALL_BINDIR}"
  "/root/${CMAKE_INSTALL_LIBDIR}")
set_property(SOURCE study/linear_solver.c APPEND PROPERTY COMPILE_DEFINITIONS
  LAR_PETSC_FROM_BIN="${LARIAT_PETSC_FROM_BIN}")
