# The README's C++ example: built and run as it stands there.

file(READ "${PROJECT_SOURCE_DIR}/README.md" readme)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/README.md")
string(FIND "${readme}" "```cpp\n" start)
if(start EQUAL -1)
    message(FATAL_ERROR "README.md has no C++ example: it should start with a line ```cpp")
endif()
math(EXPR start "${start} + 7")
string(SUBSTRING "${readme}" ${start} -1 example)
string(FIND "${example}" "```" length)
string(SUBSTRING "${example}" 0 ${length} example)
file(CONFIGURE OUTPUT readme_example.cpp CONTENT "${example}" @ONLY)

add_executable(readme_example "${CMAKE_CURRENT_BINARY_DIR}/readme_example.cpp")
target_link_libraries(readme_example PRIVATE raycontact::raycontact)
add_test(NAME readme_example COMMAND readme_example)
# The corner of b inside a has the volume 0.4^3 / 6; the force is that volume times the normal of the face of a through
# which the rays leave, as for a body in water: 0.4^3 / 6 / sqrt(3) = 0.00616 along each axis.
set_tests_properties(readme_example PROPERTIES PASS_REGULAR_EXPRESSION "contacts push b by 0\\.006[12] along x")
