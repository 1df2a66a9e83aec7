# The viewers' server; without libwebsockets only what does not need it.
lar_test(session/test_server_message.c)
if(LWS_FOUND)
  lar_test(session/test_server.c)
  lar_test(session/test_server_hostile.c)
  lar_test(session/test_server_refused.c)
endif()
