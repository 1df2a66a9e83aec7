# The demonstration organ, made once for all that only look at what is done with it: demo_organ in
# cli/lib.sh.
set(demo_organ ${CMAKE_CURRENT_BINARY_DIR}/demo_organ_of_all)
add_test(NAME cli/demo_organ COMMAND lariat demo-model ${demo_organ})
set_tests_properties(cli/demo_organ PROPERTIES LABELS fast TIMEOUT 600 COST 1000
  FIXTURES_SETUP demo_organ)

foreach(name adversary/soak_30 adversary/soak_3600 browser/engine browser/jaws cli/bench cli/contact
    cli/disk cli/doctor cli/grid_auto cli/matrix_1 cli/matrix_61 cli/mesh_bad cli/namespaces cli/parallel
    cli/partition cli/predict cli/predict_settles cli/processes cli/real_time cli/replay
    cli/requirements cli/scripts cli/scripts_full cli/verify cli/view report/figures)
  if(TEST ${name})
    set_property(TEST ${name} PROPERTY FIXTURES_REQUIRED demo_organ)
    set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT LARIAT_TEST_DEMO=${demo_organ})
  endif()
endforeach()
