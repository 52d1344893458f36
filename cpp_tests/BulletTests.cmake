# The adapter against Debian's Bullet, once for each precision that is installed.
find_package(PkgConfig)
if(NOT PkgConfig_FOUND)
    message(WARNING "pkg-config is missing: the tests with Bullet are left out")
    return()
endif()

# raycontact_add_bullet_test(<target> <test> <library> <precision>) builds bullet_<test>.cpp and runs it.
function(raycontact_add_bullet_test target test library precision)
    # Two translation units, so that a function of the adapter that is not inline is noticed.
    add_executable(${target} bullet_${test}.cpp bullet_second_unit.cpp)
    # Bullet's own headers set this off, although they are system headers, once they are inlined.
    target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)
    target_link_libraries(${target} PRIVATE raycontact::raycontact ${library})
    target_compile_definitions(${target} PRIVATE RAYCONTACT_BULLET_PRECISION=${precision})
    # The world and the shapes are those of the demos.
    target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/evaluation/demos")
    add_test(NAME ${target} COMMAND ${target})
    set_tests_properties(${target} PROPERTIES TIMEOUT 120)
endfunction()

foreach(package IN ITEMS bullet bullet-float64)
    if(package MATCHES "float64$")
        set(precision 64)
    else()
        set(precision 32)
    endif()
    string(REPLACE "-" "_" name "${package}")
    pkg_check_modules(${name} QUIET IMPORTED_TARGET ${package})
    if(NOT ${name}_FOUND)
        message(WARNING "${package} is missing: its test is left out (Debian: libbullet-dev)")
        continue()
    endif()
    foreach(test IN ITEMS contact_law elasticity links own_contacts parts_bodies rigid_bodies soft_bodies supports)
        raycontact_add_bullet_test(${name}_${test} ${test} PkgConfig::${name} ${precision})
    endforeach()
endforeach()

# The listing of the page.
if(TARGET PkgConfig::bullet)
    raycontact_add_listings(docs/bullet.md PkgConfig::bullet)
    foreach(listing IN LISTS listings)
        target_compile_options(${listing} PRIVATE -Wno-maybe-uninitialized)
        target_compile_definitions(${listing} PRIVATE RAYCONTACT_BULLET_PRECISION=32)
    endforeach()
endif()

# A mixture of Bullet's two builds must not compile: each way round.
if(TARGET PkgConfig::bullet)
    foreach(mixture IN ITEMS 32:-DBT_USE_DOUBLE_PRECISION 64:-UBT_USE_DOUBLE_PRECISION)
        string(REGEX MATCH "^[0-9]+" precision "${mixture}")
        string(REGEX REPLACE "^[0-9]+:" "" definition "${mixture}")
        add_test(NAME bullet_mixed_with_${precision}
                 COMMAND "${CMAKE_CXX_COMPILER}" -std=c++17 -fsyntax-only ${definition}
                         -DRAYCONTACT_BULLET_PRECISION=${precision} "-I${PROJECT_SOURCE_DIR}/include"
                         "-I$<JOIN:${bullet_INCLUDE_DIRS},;-I>" "${CMAKE_CURRENT_SOURCE_DIR}/bullet_second_unit.cpp"
                 COMMAND_EXPAND_LISTS)
        set_tests_properties(bullet_mixed_with_${precision} PROPERTIES
                             PASS_REGULAR_EXPRESSION "build of Bullet is linked but BT_USE_DOUBLE_PRECISION")
    endforeach()
endif()
