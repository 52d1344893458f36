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
# One corner of b inside a, 0.4/sqrt(3) deep, normal to the face it leaves through; a third of three triangles of
# area 1/2, halved, is its weight: (0.4/sqrt(3)) * (1/4) / sqrt(3).
set_tests_properties(readme_example PROPERTIES PASS_REGULAR_EXPRESSION "1 contact.* by 0\\.0333 along x")
