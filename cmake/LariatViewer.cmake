# The viewer: the server inside the engine (libwebsockets), and the page that it serves (web/, made
# by npm into web/dist). Both are optional; without them a sentence says how to get them.
#
# With LARIAT_VIEWER the page is built along. It is off by default, because npm fetches from the
# network and all build folders share web/dist; `make` has it on.
option(LARIAT_VIEWER "Build the viewer's page with npm when web/ has changed" OFF)

target_sources(lariat PRIVATE cli/view.c cli/view_report.c)
target_sources(lariat_core PRIVATE session/server_json.c session/server_message.c)
if(LARIAT_HAVE_LIBWEBSOCKETS)
  target_sources(lariat_core PRIVATE
    session/server.c
    session/server_act.c
    session/server_files.c
    session/server_hands.c
    session/server_http.c
    session/server_inspect.c
    session/server_picture.c
    session/server_reading.c
    session/server_riding.c
    session/server_saved.c
    session/server_scan.c
    session/server_send.c
    session/server_socket.c
    session/server_work.c)
  target_link_libraries(lariat_core PRIVATE PkgConfig::LWS)
else()
  target_sources(lariat_core PRIVATE session/server_absent.c)
endif()
set(LARIAT_VIEWER_BELOW_PREFIX ${CMAKE_INSTALL_DATADIR}/lariat/viewer)
set_property(SOURCE session/server_files.c APPEND PROPERTY COMPILE_DEFINITIONS
  LAR_VIEWER_FOLDER="${PROJECT_SOURCE_DIR}/web/dist"
  LAR_VIEWER_BELOW_PREFIX="${LARIAT_VIEWER_BELOW_PREFIX}")

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
