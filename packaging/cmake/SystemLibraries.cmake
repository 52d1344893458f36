# raycontact_find_system_libraries(<variable> <variable for flags>)
# The system libraries that a program linking the static library needs. rustc itself is asked, so that no list is
# kept by hand; the answer goes into the installed package as well: as CMake's names, and as flags for other builds.
function(raycontact_find_system_libraries variable variable_for_flags)
    set(probe "${CMAKE_CURRENT_BINARY_DIR}/system_libraries")
    file(WRITE "${probe}.rs" "")
    execute_process(
        COMMAND "${RAYCONTACT_RUSTC}" --crate-type staticlib --print native-static-libs -o "${probe}.a" "${probe}.rs"
        OUTPUT_VARIABLE output
        ERROR_VARIABLE output
        RESULT_VARIABLE result)
    file(REMOVE "${probe}.rs" "${probe}.a")
    if(NOT result EQUAL 0 OR NOT output MATCHES "native-static-libs:([^\n]*)")
        message(FATAL_ERROR "${RAYCONTACT_RUSTC} did not name the system libraries of a static library:\n${output}")
    endif()

    string(STRIP "${CMAKE_MATCH_1}" flags)
    separate_arguments(flags UNIX_COMMAND "${flags}")
    list(REMOVE_DUPLICATES flags)
    list(JOIN flags " " joined)
    set(${variable_for_flags} "${joined}" PARENT_SCOPE)
    list(TRANSFORM flags REPLACE "^-l" "")
    # CMake knows what else threads need, such as a compiler flag.
    list(TRANSFORM flags REPLACE "^pthread$" "Threads::Threads")
    set(${variable} "${flags}" PARENT_SCOPE)
endfunction()
