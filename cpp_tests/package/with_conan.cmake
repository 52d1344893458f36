# `conan create` builds the package in an unoptimised build, for speed, and passes its test_package. The client comes
# from PyPI, into a folder of its own that stays for the next run.
include("${CMAKE_CURRENT_LIST_DIR}/tools.cmake")

set(conan_version 2.34.0)
set(client "${SCRATCH}/client_${conan_version}")
if(NOT EXISTS "${client}/bin/conan")
    run(python3 -m venv "${client}")
    run("${client}/bin/pip" --quiet --disable-pip-version-check install "conan==${conan_version}")
endif()

set(ENV{CONAN_HOME} "${SCRATCH}/home")
file(REMOVE_RECURSE "${SCRATCH}/home" "${SCRATCH}/test")
run("${client}/bin/conan" profile detect)
foreach(shared IN ITEMS False True)
    run("${client}/bin/conan" create "${SOURCE}/packaging/conan" --settings build_type=Debug --options "shared=${shared}" --conf
        "user.raycontact:cargo_target_dir=${CARGO_TARGET_DIR}" --conf
        "tools.cmake.cmaketoolchain:generator=${GENERATOR}" --conf
        "tools.cmake.cmake_layout:test_folder=${SCRATCH}/test" --conf "tools.cmake.cmaketoolchain:user_presets=")
    if(NOT run_output MATCHES "RUN: [^\n]*consumer_c\n" OR NOT run_output MATCHES "RUN: [^\n]*consumer_cpp\n")
        message(FATAL_ERROR "the test package did not run its programs:\n${run_output}")
    endif()
endforeach()
