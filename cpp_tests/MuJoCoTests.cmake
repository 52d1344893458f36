# The adapter against MuJoCo itself, where evaluation/demos/CMakeLists.txt has found it.
if(NOT TARGET raycontact_mujoco)
    return()
endif()

add_executable(mujoco_contact mujoco_contact.cpp)
target_link_libraries(mujoco_contact PRIVATE raycontact::raycontact raycontact_mujoco)
add_test(NAME mujoco_contact COMMAND mujoco_contact)
set_tests_properties(mujoco_contact PROPERTIES TIMEOUT 300)

# Scenes end with 0 only when they went as they should: bodies apart in time, no element inside out, no energy gained.
foreach(scene IN ITEMS tori impact skins)
    foreach(dt IN ITEMS 0.002 0.005 0.02)
        add_test(NAME mujoco_${scene}_${dt} COMMAND mujoco_flexes ${scene} --dt ${dt})
        set_tests_properties(mujoco_${scene}_${dt} PROPERTIES TIMEOUT 300)
    endforeach()
endforeach()
add_test(NAME mujoco_pile COMMAND mujoco_flexes pile)
set_tests_properties(mujoco_pile PROPERTIES TIMEOUT 600)
add_test(NAME mujoco_usage COMMAND mujoco_flexes --help)

# The manual's listings are those of files that are built and run; its model is switched on by the plugin alone.
set(mujoco_model "${PROJECT_SOURCE_DIR}/evaluation/demos/mujoco/two_blocks.xml")
add_test(NAME mujoco_plugin
         COMMAND mujoco_step "${mujoco_model}" --plugin "$<TARGET_FILE:raycontact_flex_contact>" --seconds 2)
# The upper block lies on the lower one.
set_tests_properties(mujoco_plugin PROPERTIES PASS_REGULAR_EXPRESSION "flex 0 at .*0\\.14[0-9]*\nflex 1 at .*0\\.4[0-9]*\n")
# A net holds a block: none of its vertices is 1 mm deep in it, at any time.
add_test(NAME mujoco_models COMMAND mujoco_models "${PROJECT_SOURCE_DIR}/evaluation/demos/mujoco/net.xml" --run 1)
set_tests_properties(mujoco_models PROPERTIES PASS_REGULAR_EXPRESSION "raycontact \\| 0\\.000")
foreach(listing IN ITEMS cpp:step_model.cpp xml:two_blocks.xml)
    string(REPLACE ":" ";" listing "${listing}")
    list(GET listing 0 language)
    list(GET listing 1 file)
    add_test(NAME mujoco_listing_${language}
             COMMAND "${CMAKE_COMMAND}" -D "PAGE=${PROJECT_SOURCE_DIR}/docs/mujoco.md" -D "LANGUAGE=${language}" -D
                     "PROGRAM=${PROJECT_SOURCE_DIR}/evaluation/demos/mujoco/${file}" -P "${CMAKE_CURRENT_SOURCE_DIR}/listing.cmake")
endforeach()
