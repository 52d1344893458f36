# What the scripts of this folder share. Each is run as cmake -D … -P <script>, with
#   SOURCE, BUILD    the repository and its build
#   SCRATCH          a folder of its own; INSTALLED: where install.cmake leaves the package
#   VERSION, GENERATOR, C_COMPILER
cmake_minimum_required(VERSION 3.25)

# run(<command>...) stops with everything the command printed if it fails.
function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed (${result}): ${command}\n${output}")
    endif()
    set(run_output "${output}" PARENT_SCOPE)
endfunction()

# consume_with_cmake(<folder> <shared or static> <option>...) builds and runs the consumer there.
function(consume_with_cmake folder library)
    run("${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}" -B "${folder}" -G "${GENERATOR}" "-DVERSION=${VERSION}"
        "-DLIBRARY=${library}" ${ARGN})
    run("${CMAKE_COMMAND}" --build "${folder}")
    run("${folder}/consumer_c")
    run("${folder}/consumer_cpp")
endfunction()

# consume_with_pkg_config(<folder> <prefix> <pkg-config option>...) builds and runs the consumer there with nothing but
# the compiler's own command and pkg-config.
function(consume_with_pkg_config folder prefix)
    file(GLOB_RECURSE file "${prefix}/raycontact.pc")
    cmake_path(GET file PARENT_PATH pc_dir)
    set(ENV{PKG_CONFIG_PATH} "${pc_dir}")
    run(pkg-config --modversion raycontact)
    if(NOT run_output STREQUAL "${VERSION}\n")
        message(FATAL_ERROR "pkg-config gives version ${run_output}, not ${VERSION}")
    endif()
    run(pkg-config --cflags --libs ${ARGN} raycontact)
    separate_arguments(flags UNIX_COMMAND "${run_output}")
    file(MAKE_DIRECTORY "${folder}")
    run("${C_COMPILER}" "${CMAKE_CURRENT_LIST_DIR}/consumer.c" -o "${folder}/consumer" ${flags})
    set(ENV{LD_LIBRARY_PATH} "${pc_dir}/..")
    run("${folder}/consumer")
endfunction()
