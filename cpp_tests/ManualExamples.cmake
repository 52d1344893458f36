# Programs that stand in the manual: built as they stand there, they print what stands below them.

# raycontact_add_listings(<page> <target to link>...) takes every C and C++ listing of the page. Its output is the block of
# text that comes next. Tests are named by page, heading and language, and run by the command `launcher` where that is set.
function(raycontact_add_listings page)
    set(file "${PROJECT_SOURCE_DIR}/${page}")
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
    file(READ "${file}" rest)
    cmake_path(GET page STEM stem)
    string(TOLOWER "${stem}" stem)
    set(count 0)
    set(names)
    while(rest MATCHES "```(cpp|c)\n")
        math(EXPR count "${count} + 1")
        set(language "${CMAKE_MATCH_1}")
        string(FIND "${rest}" "${CMAKE_MATCH_0}" start)
        string(SUBSTRING "${rest}" 0 ${start} before)
        string(REGEX REPLACE ".*\n##+ ([^\n]*)\n.*" "\\1" heading "${before}")
        string(TOLOWER "${stem} ${heading} ${language}" name)
        string(REGEX REPLACE "[^a-z0-9]+" "_" name "${name}")

        string(SUBSTRING "${rest}" ${start} -1 rest)
        raycontact_take_block("${page}" "${language}" listing)
        raycontact_take_block("${page}" text output)
        file(CONFIGURE OUTPUT ${name}.${language} CONTENT "${listing}" @ONLY)
        file(CONFIGURE OUTPUT ${name}.txt CONTENT "${output}" @ONLY)
        add_executable(${name} "${CMAKE_CURRENT_BINARY_DIR}/${name}.${language}")
        target_link_libraries(${name} PRIVATE raycontact::raycontact ${ARGN})
        add_test(NAME ${name}
                 COMMAND "${CMAKE_COMMAND}" -D "PROGRAM=${launcher};$<TARGET_FILE:${name}>" -D
                         "OUTPUT=${CMAKE_CURRENT_BINARY_DIR}/${name}.txt" -P
                         "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/listing_output.cmake")
        set_tests_properties(${name} PROPERTIES TIMEOUT 120)
        list(APPEND names ${name})
    endwhile()
    if(count EQUAL 0)
        message(FATAL_ERROR "${page} has no listing: it should start with a line ```cpp or ```c")
    endif()
    set(listings ${names} PARENT_SCOPE)
endfunction()

# Takes the next block off `rest`, which must be of this language.
macro(raycontact_take_block page language block)
    string(FIND "${rest}" "```" start)
    string(SUBSTRING "${rest}" ${start} -1 rest)
    if(NOT rest MATCHES "^```${language}\n")
        message(FATAL_ERROR "${page}: listing ${count} should be followed by its output, a block ```${language}")
    endif()
    string(LENGTH "```${language}\n" length)
    string(SUBSTRING "${rest}" ${length} -1 rest)
    string(FIND "${rest}" "```" length)
    string(SUBSTRING "${rest}" 0 ${length} ${block})
    math(EXPR length "${length} + 3")
    string(SUBSTRING "${rest}" ${length} -1 rest)
endmacro()

# Pages that tell of the presets name what these build with.
file(READ "${PROJECT_SOURCE_DIR}/CMakePresets.json" presets)
string(JSON generator GET "${presets}" configurePresets 0 generator)
foreach(page IN ITEMS README.md CONTRIBUTING.md docs/tutorial.md)
    file(READ "${PROJECT_SOURCE_DIR}/${page}" text)
    if(NOT text MATCHES "${generator}")
        message(FATAL_ERROR "${page} does not say that the presets need ${generator}")
    endif()
endforeach()

raycontact_add_listings(README.md)
raycontact_add_listings(docs/tutorial.md m)
raycontact_add_listings(docs/recipes.md)
