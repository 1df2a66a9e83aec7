# The viewer: the server inside the engine (libwebsockets), and the page that it serves (web/, made
# by npm into web/dist). Both are optional; without them a sentence says how to get them.
#
# With LARIAT_VIEWER the page is built along. It is off by default, because npm fetches from the
# network and all build folders share web/dist; `make` has it on.
option(LARIAT_VIEWER "Build the viewer's page with npm when web/ has changed" OFF)

if(LARIAT_HAVE_LIBWEBSOCKETS)
  lariat_sources(sources server)
  list(REMOVE_ITEM sources server/absent.c)
  target_sources(lariat_core PRIVATE ${sources})
  lariat_optimise(s "^server/" ${sources})
  target_link_libraries(lariat_core PRIVATE PkgConfig::LWS)
else()
  target_sources(lariat_core PRIVATE server/absent.c server/message.c)
endif()
# In a distribution the page is looked for where it is installed only, and the sentences name the
# package that brings it.
set(LARIAT_VIEWER_PACKAGE "" CACHE STRING "The package of a distribution that brings the page")
set(LARIAT_VIEWER_BELOW_PREFIX ${CMAKE_INSTALL_DATADIR}/lariat/viewer)
set_property(SOURCE server/files.c APPEND PROPERTY COMPILE_DEFINITIONS
  LAR_VIEWER_BELOW_PREFIX="${LARIAT_VIEWER_BELOW_PREFIX}")
if(LARIAT_VIEWER_PACKAGE)
  set_property(SOURCE server/files.c study/doctor.c APPEND PROPERTY COMPILE_DEFINITIONS
    LAR_VIEWER_PACKAGE="${LARIAT_VIEWER_PACKAGE}")
else()
  set_property(SOURCE server/files.c APPEND PROPERTY COMPILE_DEFINITIONS
    LAR_VIEWER_FOLDER="${PROJECT_SOURCE_DIR}/web/dist" LAR_BUILD_FOLDER="${PROJECT_BINARY_DIR}")
endif()

if(LARIAT_VIEWER)
  add_custom_target(viewer ALL COMMAND ${PROJECT_SOURCE_DIR}/tools/web.sh VERBATIM
    COMMENT "The viewer's page, when web/ has changed")
endif()
# At the time of installing: web/dist may not be there yet when this is configured.
install(CODE "
  if(EXISTS \"${PROJECT_SOURCE_DIR}/web/dist/index.html\")
    file(INSTALL \"${PROJECT_SOURCE_DIR}/web/dist/\"
      DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${LARIAT_VIEWER_BELOW_PREFIX}\")
  endif()")
