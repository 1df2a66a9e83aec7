# The viewers' server; without libwebsockets only what does not need it.
lar_test(session/test_server_message.c)
lar_fuzz(viewer_message)
if(LARIAT_HAVE_LIBWEBSOCKETS)
  lar_test(session/test_server.c)
  lar_test(session/test_server_hostile.c)
  lar_test(session/test_server_activation.c)
  lar_test(session/test_server_inspect.c)
  lar_test(session/test_server_refused.c)
  lar_test(session/test_server_strangers.c)
  lar_test(session/test_server_embedded.c)
  lar_test(session/test_server_scan.c)
  lar_test(session/test_server_tools.c)
  lar_test(session/test_server_many.c slow)
else() # the preset tsan names them
  add_custom_target(test_session_server)
  add_custom_target(test_session_server_hostile)
endif()
add_test(NAME cli/view COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/cli/view.sh
  $<TARGET_FILE:lariat> $<TARGET_FILE:json_check> ${CMAKE_CURRENT_BINARY_DIR}/cli-view
  ${PROJECT_SOURCE_DIR})
set_tests_properties(cli/view PROPERTIES LABELS fast TIMEOUT 300)
