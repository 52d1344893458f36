# The package as a stranger meets it: installed and moved, as a subdirectory, from Debian's packages, from Conan.

set(package_scripts "${CMAKE_CURRENT_LIST_DIR}")

# raycontact_add_package_test(<name> <script> <-D option>...)
function(raycontact_add_package_test name script)
    add_test(
        NAME ${name}
        COMMAND
            "${CMAKE_COMMAND}" -D "SOURCE=${PROJECT_SOURCE_DIR}" -D "BUILD=${PROJECT_BINARY_DIR}" -D
            "INSTALLED=${CMAKE_CURRENT_BINARY_DIR}/package/moved here" -D "SCRATCH=${CMAKE_CURRENT_BINARY_DIR}/package/${name}"
            -D "VERSION=${PROJECT_VERSION}" -D "GENERATOR=${CMAKE_GENERATOR}" -D "C_COMPILER=${CMAKE_C_COMPILER}" ${ARGN}
            -P "${package_scripts}/${script}.cmake")
    set_tests_properties(${name} PROPERTIES TIMEOUT 600)
endfunction()

raycontact_add_package_test(package_install install)
set_tests_properties(package_install PROPERTIES FIXTURES_SETUP installed_package)
raycontact_add_package_test(package_manual_commands manual_commands)
set_tests_properties(package_manual_commands PROPERTIES FIXTURES_REQUIRED installed_package)
foreach(library IN ITEMS raycontact static)
    if(library STREQUAL "static")
        set(kind static)
    else()
        set(kind shared)
    endif()
    raycontact_add_package_test(package_cmake_${kind} with_cmake -D "LIBRARY=${library}")
    raycontact_add_package_test(package_pkg_config_${kind} with_pkg_config -D "LIBRARY=${library}")
    set_tests_properties(package_cmake_${kind} package_pkg_config_${kind} PROPERTIES FIXTURES_REQUIRED installed_package)
    raycontact_add_package_test(
        package_subdirectory_${kind} in_subdirectory -D "LIBRARY=${library}" -D "BUILD_TYPE=${CMAKE_BUILD_TYPE}" -D
        "CARGO_TARGET_DIR=${RAYCONTACT_CARGO_TARGET_DIR}")
endforeach()

find_program(RAYCONTACT_DPKG_DEB dpkg-deb)
if(RAYCONTACT_DPKG_DEB AND CMAKE_BUILD_TYPE STREQUAL "Release")
    raycontact_add_package_test(package_debian from_debian_packages)
endif()
raycontact_add_package_test(package_conan with_conan -D "CARGO_TARGET_DIR=${RAYCONTACT_CARGO_TARGET_DIR}")
