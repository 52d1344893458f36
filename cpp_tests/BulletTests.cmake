# The adapter against Debian's Bullet, once for each precision that is installed.
find_package(PkgConfig)
if(NOT PkgConfig_FOUND)
    message(WARNING "pkg-config is missing: the tests with Bullet are left out")
    return()
endif()

foreach(package IN ITEMS bullet bullet-float64)
    string(REPLACE "-" "_" name "${package}")
    pkg_check_modules(${name} QUIET IMPORTED_TARGET ${package})
    if(NOT ${name}_FOUND)
        message(WARNING "${package} is missing: its test is left out (Debian: libbullet-dev)")
        continue()
    endif()
    # Two translation units, so that a function of the adapter that is not inline is noticed.
    add_executable(${name}_parts_bodies bullet_parts_bodies.cpp bullet_second_unit.cpp)
    target_link_libraries(${name}_parts_bodies PRIVATE raycontact::raycontact PkgConfig::${name})
    # The world and the shapes are those of the demos.
    target_include_directories(${name}_parts_bodies PRIVATE "${PROJECT_SOURCE_DIR}/demos")
    add_test(NAME ${name}_parts_bodies COMMAND ${name}_parts_bodies)
    set_tests_properties(${name}_parts_bodies PROPERTIES TIMEOUT 120)
endforeach()
