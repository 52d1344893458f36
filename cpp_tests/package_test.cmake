# Installs the package, moves it, and builds and runs a program that finds it there: with the shared library and with
# the static one.

function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        string(REPLACE ";" " " command "${ARGN}")
        message(FATAL_ERROR "failed (${result}): ${command}\n${output}")
    endif()
endfunction()

file(REMOVE_RECURSE "${SCRATCH}")
run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${SCRATCH}/first")
file(RENAME "${SCRATCH}/first" "${SCRATCH}/moved")

file(GLOB_RECURSE shared_libraries "${SCRATCH}/moved/*/libraycontact.so*")
list(LENGTH shared_libraries count)
if(NOT count EQUAL 3)
    message(FATAL_ERROR "expected libraycontact.so, .so.<major> and .so.<version>, found: ${shared_libraries}")
endif()

foreach(library IN ITEMS raycontact static)
    set(build "${SCRATCH}/${library}")
    run("${CMAKE_COMMAND}" -S "${CONSUMER}" -B "${build}" -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${SCRATCH}/moved"
        "-DVERSION=${VERSION}" "-DLIBRARY=${library}")
    run("${CMAKE_COMMAND}" --build "${build}")
    run("${build}/consumer_c")
    run("${build}/consumer_cpp")
endforeach()
