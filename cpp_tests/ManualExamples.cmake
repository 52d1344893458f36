# Programs that stand in the manual: built and run as they stand there.

# raycontact_add_example(<name> <file> <expression its output must match>) takes the first C++ listing of the file.
function(raycontact_add_example name file expected)
    file(READ "${PROJECT_SOURCE_DIR}/${file}" text)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/${file}")
    string(FIND "${text}" "```cpp\n" start)
    if(start EQUAL -1)
        message(FATAL_ERROR "${file} has no C++ example: it should start with a line ```cpp")
    endif()
    math(EXPR start "${start} + 7")
    string(SUBSTRING "${text}" ${start} -1 example)
    string(FIND "${example}" "```" length)
    string(SUBSTRING "${example}" 0 ${length} example)
    file(CONFIGURE OUTPUT ${name}.cpp CONTENT "${example}" @ONLY)

    add_executable(${name} "${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp")
    target_link_libraries(${name} PRIVATE raycontact::raycontact)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES PASS_REGULAR_EXPRESSION "${expected}")
endfunction()

# The corner of b inside a has the volume 0.4^3 / 6; the force is that volume times the normal of the face of a through
# which the rays leave, as for a body in water: 0.4^3 / 6 / sqrt(3) = 0.00616 along each axis.
raycontact_add_example(readme_example README.md "contacts push b by 0\\.0049 along x")
# The bodies have parted, and nothing from outside has pushed them.
raycontact_add_example(tutorial_example docs/tutorial.md "[1-9][0-9]* contacts\n.*\n0 contacts left, momentum -?[0-9.]+e-1[2-9]")
