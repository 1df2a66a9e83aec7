# The installed side: shared and static library, headers, pkg-config files, CMake package, command.
#
# The shared library is made of the same objects as lariat_core. Everything is hidden except what
# carries LAR_API; tests/install looks at the symbol table. Its target is called liblariat because
# the name `lariat` is the command's, which lies beside it in the build folder.
include(CMakePackageConfigHelpers)

add_library(liblariat SHARED $<TARGET_OBJECTS:lariat_core>)
add_library(Lariat::lariat ALIAS liblariat)
set_target_properties(liblariat PROPERTIES
  OUTPUT_NAME lariat
  EXPORT_NAME lariat
  LINKER_LANGUAGE C
  VERSION ${PROJECT_VERSION}
  SOVERSION 0
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
target_include_directories(liblariat INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# Linking lariat_core as well brings its libraries along.
target_link_libraries(liblariat PRIVATE lariat_core)
if(NOT LARIAT_SANITIZE)
  target_link_options(liblariat PRIVATE -Wl,--no-undefined -Wl,--as-needed -Wl,--gc-sections
    -Wl,-Bsymbolic-functions)
  include(CheckCSourceCompiles)
  include(CheckLinkerFlag)
  # Code begins and ends within pages of read-only data instead of pages of its own: 2 kB.
  check_linker_flag(C -Wl,-z,noseparate-code LARIAT_LINKER_HAS_NOSEPARATE_CODE)
  if(LARIAT_LINKER_HAS_NOSEPARATE_CODE)
    target_link_options(liblariat PRIVATE -Wl,-z,noseparate-code)
  endif()
  # Addresses in tables as bits instead of 24 bytes each (DT_RELR), where the loader knows them.
  check_linker_flag(C -Wl,-z,pack-relative-relocs LARIAT_LINKER_HAS_RELR)
  check_c_source_compiles("#include <features.h>
#if !defined(__GLIBC_PREREQ) || !__GLIBC_PREREQ(2, 36)
#error the loader does not know DT_RELR
#endif
int main(void) { return 0; }" LARIAT_LOADER_HAS_RELR)
  if(LARIAT_LINKER_HAS_RELR AND LARIAT_LOADER_HAS_RELR)
    target_link_options(liblariat PRIVATE -Wl,-z,pack-relative-relocs)
  endif()
endif()

# The same objects as an archive, for programs that shall need no file of ours. What the objects call
# is named for those who link it; headers of these libraries nobody needs.
set(LARIAT_PRIVATE_LIBRARIES xml2 yaml z)
foreach(pair HWLOC:hwloc METIS:metis NIFTI:nifti2 LIBWEBSOCKETS:websockets)
  string(REPLACE ":" ";" pair ${pair})
  list(GET pair 0 name)
  list(GET pair 1 library)
  if(LARIAT_HAVE_${name})
    list(APPEND LARIAT_PRIVATE_LIBRARIES ${library})
  endif()
endforeach()
list(APPEND LARIAT_PRIVATE_LIBRARIES pthread dl m)
# One object in which names that carry no LAR_API are local, so that a program may have the same ones.
# Not where objects are no machine code yet, or call a sanitizer's.
string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
set(flags "${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_${type}}")
set(LARIAT_LIBRARIES liblariat)
set(LARIAT_PC_FILES lariat)
if(NOT LARIAT_SANITIZE AND NOT CMAKE_INTERPROCEDURAL_OPTIMIZATION AND NOT flags MATCHES "-flto")
  set(whole ${PROJECT_BINARY_DIR}/lariat_whole.o)
  add_custom_command(OUTPUT ${whole} DEPENDS lariat_core
    COMMAND ${CMAKE_LINKER} -r -o ${whole} --whole-archive $<TARGET_FILE:lariat_core>
    COMMAND ${CMAKE_OBJCOPY} --localize-hidden ${whole}
    COMMENT "The library as one object" VERBATIM)
  set_source_files_properties(${whole} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  add_library(liblariat_static STATIC ${whole})
  set_target_properties(liblariat_static PROPERTIES OUTPUT_NAME lariat EXPORT_NAME lariat_static
    LINKER_LANGUAGE C ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  target_include_directories(liblariat_static INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_definitions(liblariat_static INTERFACE LARIAT_STATIC)
  target_link_libraries(liblariat_static INTERFACE ${LARIAT_PRIVATE_LIBRARIES})
  list(APPEND LARIAT_LIBRARIES liblariat_static)
  list(APPEND LARIAT_PC_FILES lariat-static)
endif()

# Fits, where cminpack is there: a library beside the first one, which does without it.
if(LARIAT_HAVE_CMINPACK)
  add_library(liblariat_fit SHARED $<TARGET_OBJECTS:lariat_fit_objects>)
  add_library(Lariat::fit ALIAS liblariat_fit)
  set_target_properties(liblariat_fit PROPERTIES OUTPUT_NAME lariat-fit EXPORT_NAME fit
    LINKER_LANGUAGE C VERSION ${PROJECT_VERSION} SOVERSION 0 INSTALL_RPATH "$ORIGIN"
    LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  target_link_libraries(liblariat_fit PUBLIC liblariat
    PRIVATE lariat_flags PkgConfig::CMINPACK Threads::Threads m)
  if(NOT LARIAT_SANITIZE)
    target_link_options(liblariat_fit PRIVATE -Wl,--no-undefined -Wl,--as-needed)
  endif()
  list(APPEND LARIAT_LIBRARIES liblariat_fit)
  list(APPEND LARIAT_PC_FILES lariat-fit)
  if(TARGET liblariat_static)
    set(whole ${PROJECT_BINARY_DIR}/lariat_fit_whole.o)
    add_custom_command(OUTPUT ${whole} DEPENDS lariat_fit_objects $<TARGET_OBJECTS:lariat_fit_objects>
      COMMAND ${CMAKE_LINKER} -r -o ${whole} $<TARGET_OBJECTS:lariat_fit_objects>
      COMMAND ${CMAKE_OBJCOPY} --localize-hidden ${whole}
      COMMAND_EXPAND_LISTS COMMENT "Fits as one object" VERBATIM)
    set_source_files_properties(${whole} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
    add_library(liblariat_fit_static STATIC ${whole})
    set_target_properties(liblariat_fit_static PROPERTIES OUTPUT_NAME lariat-fit
      EXPORT_NAME fit_static LINKER_LANGUAGE C ARCHIVE_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
    target_link_libraries(liblariat_fit_static INTERFACE liblariat_static cminpack m)
    list(APPEND LARIAT_LIBRARIES liblariat_fit_static)
    list(APPEND LARIAT_PC_FILES lariat-fit-static)
  endif()
  install(FILES include/lariat_fit.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
else() # those of an earlier configuration
  foreach(old .a .so .so.0 .so.${PROJECT_VERSION})
    file(REMOVE ${PROJECT_BINARY_DIR}/liblariat-fit${old})
  endforeach()
endif()

install(TARGETS ${LARIAT_LIBRARIES} EXPORT LariatTargets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES include/lariat.h include/lariat_sizes.h include/lariat.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
set_target_properties(lariat PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
install(TARGETS lariat RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})

# Man pages and completion, which the command makes of its own tables of options (src/cli/help.h).
if(NOT CMAKE_CROSSCOMPILING)
  set(help ${PROJECT_BINARY_DIR}/help)
  add_custom_command(OUTPUT ${help}/man/man1/lariat.1
    COMMAND lariat help --write ${help} DEPENDS lariat
    COMMENT "Man pages and completion" VERBATIM)
  add_custom_target(lariat_help ALL DEPENDS ${help}/man/man1/lariat.1)
  install(DIRECTORY ${help}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR})
  install(DIRECTORY ${help}/bash-completion ${help}/zsh ${help}/fish
    DESTINATION ${CMAKE_INSTALL_DATADIR})
endif()

# What headers and help refer to, with all that these pages lead to but the source.
install(DIRECTORY docs examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md CONTRIBUTING.md LICENSE CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES tools/render/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/tools/render)
install(FILES include/lariat.h include/lariat_fit.h DESTINATION ${CMAKE_INSTALL_DOCDIR}/include)

# Both package files find the prefix from where they lie, so that an installed tree can be moved.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Lariat)
configure_package_config_file(cmake/LariatConfig.cmake.in ${PROJECT_BINARY_DIR}/LariatConfig.cmake
  INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/LariatConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/LariatConfig.cmake
  ${PROJECT_BINARY_DIR}/LariatConfigVersion.cmake DESTINATION ${package_folder})
install(EXPORT LariatTargets NAMESPACE Lariat:: DESTINATION ${package_folder})

file(RELATIVE_PATH LARIAT_PC_PREFIX
  "/root/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/root")
string(REGEX REPLACE "/$" "" LARIAT_PC_PREFIX "${LARIAT_PC_PREFIX}")
list(TRANSFORM LARIAT_PRIVATE_LIBRARIES PREPEND -l)
list(JOIN LARIAT_PRIVATE_LIBRARIES " " LARIAT_PC_PRIVATE)
foreach(name ${LARIAT_PC_FILES})
  configure_file(cmake/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

# What `make` builds: all that is installed, and the viewer's page, but no tests.
add_custom_target(products DEPENDS lariat ${LARIAT_LIBRARIES})
foreach(target lariat_help lariat-mpi-openmpi lariat-mpi-mpich lariat-petsc viewer)
  if(TARGET ${target})
    add_dependencies(products ${target})
  endif()
endforeach()
