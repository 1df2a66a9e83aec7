# Optional: PETSc solves the linear systems of the implicit comparison (src/study/implicit/petsc_shim.h), in
# a loadable module, because it brings an MPI and some dozen libraries that nothing else needs.
if(LARIAT_HAVE_PETSC)
  add_library(lariat-petsc MODULE study/implicit/petsc_shim.c)
  target_include_directories(lariat-petsc PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_include_directories(lariat-petsc PRIVATE ${PROJECT_SOURCE_DIR}/include)
  # Headers of others warn.
  target_include_directories(lariat-petsc SYSTEM PRIVATE ${LARIAT_PETSC_INCLUDES})
  target_link_libraries(lariat-petsc PRIVATE lariat_flags ${PETSC_LINK_LIBRARIES})
  set_target_properties(lariat-petsc PROPERTIES PREFIX lib SUFFIX .so
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  install(TARGETS lariat-petsc LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
else() # a module of an earlier configuration, whose PETSc is gone: the command would find it
  file(REMOVE ${PROJECT_BINARY_DIR}/liblariat-petsc.so)
endif()
# From the command's folder to where the module is installed.
file(RELATIVE_PATH LARIAT_PETSC_FROM_BIN "/root/${CMAKE_INSTALL_BINDIR}"
  "/root/${CMAKE_INSTALL_LIBDIR}")
set_property(SOURCE study/implicit/linear_solver.c APPEND PROPERTY COMPILE_DEFINITIONS
  LAR_PETSC_FROM_BIN="${LARIAT_PETSC_FROM_BIN}")
