# The example with Debian's Simbody ends with 0 only when the brick stays, with either contact.
find_package(Simbody QUIET)
if(NOT Simbody_FOUND)
    message(WARNING "Simbody is missing: the test simbody is left out (Debian: libsimbody-dev)")
    return()
endif()

add_executable(simbody "${PROJECT_SOURCE_DIR}/examples/simbody.cpp")
target_include_directories(simbody SYSTEM PRIVATE ${Simbody_INCLUDE_DIR})
target_link_libraries(simbody PRIVATE raycontact::raycontact ${Simbody_LIBRARIES})
add_test(NAME simbody COMMAND simbody)
add_test(NAME simbody_listing
         COMMAND "${CMAKE_COMMAND}" -D "PAGE=${PROJECT_SOURCE_DIR}/docs/hosts/simbody.md" -D
                 "PROGRAM=${PROJECT_SOURCE_DIR}/examples/simbody.cpp" -P "${CMAKE_CURRENT_SOURCE_DIR}/listing.cmake")
set_tests_properties(simbody PROPERTIES TIMEOUT 120)
