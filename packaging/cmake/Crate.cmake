# Builds the crate with cargo and offers it as raycontact::raycontact (shared) and raycontact::static.

find_program(RAYCONTACT_CARGO cargo HINTS "$ENV{CARGO_HOME}/bin" "$ENV{HOME}/.cargo/bin")
find_program(RAYCONTACT_RUSTC rustc HINTS "$ENV{CARGO_HOME}/bin" "$ENV{HOME}/.cargo/bin")
if(NOT RAYCONTACT_CARGO OR NOT RAYCONTACT_RUSTC)
    message(FATAL_ERROR "cargo and rustc are needed to build raycontact. Install a Rust toolchain "
                        "(https://rustup.rs) or set RAYCONTACT_CARGO and RAYCONTACT_RUSTC.")
endif()

if(CMAKE_BUILD_TYPE STREQUAL "Debug")
    set(cargo_profile dev)
    set(cargo_profile_folder debug)
else()
    set(cargo_profile release)
    set(cargo_profile_folder release)
endif()
set(cargo_output "${RAYCONTACT_CARGO_TARGET_DIR}/${cargo_profile_folder}")

# The names a user of the library sees, as each system has them: file, SONAME link, development link. The SONAME is that of
# build.rs. A DLL has no links and no version, and programs are linked with its import library.
if(PROJECT_VERSION_MAJOR EQUAL 0)
    set(RAYCONTACT_SOVERSION "0.${PROJECT_VERSION_MINOR}")
else()
    set(RAYCONTACT_SOVERSION "${PROJECT_VERSION_MAJOR}")
endif()
set(RAYCONTACT_SHARED_NAME "${CMAKE_SHARED_LIBRARY_PREFIX}raycontact${CMAKE_SHARED_LIBRARY_SUFFIX}")
if(WIN32)
    # As rustc calls them: with MSVC raycontact.lib is the static library.
    set(RAYCONTACT_SHARED_NAME raycontact.dll)
    set(RAYCONTACT_IMPORT_FILE libraycontact.dll.a)
    if(MSVC)
        set(RAYCONTACT_IMPORT_FILE raycontact.dll.lib)
    endif()
    set(RAYCONTACT_SHARED_SONAME "${RAYCONTACT_SHARED_NAME}")
    set(RAYCONTACT_SHARED_FILE "${RAYCONTACT_SHARED_NAME}")
elseif(APPLE)
    set(RAYCONTACT_SHARED_SONAME "libraycontact.${RAYCONTACT_SOVERSION}.dylib")
    set(RAYCONTACT_SHARED_FILE "libraycontact.${PROJECT_VERSION}.dylib")
else()
    set(RAYCONTACT_SHARED_SONAME "${RAYCONTACT_SHARED_NAME}.${RAYCONTACT_SOVERSION}")
    set(RAYCONTACT_SHARED_FILE "${RAYCONTACT_SHARED_NAME}.${PROJECT_VERSION}")
endif()
set(RAYCONTACT_IMPORTED_SONAME "${RAYCONTACT_SHARED_SONAME}")
if(APPLE)
    string(PREPEND RAYCONTACT_IMPORTED_SONAME "@rpath/")
endif()
set(RAYCONTACT_STATIC_FILE "${CMAKE_STATIC_LIBRARY_PREFIX}raycontact${CMAKE_STATIC_LIBRARY_SUFFIX}")
set(RAYCONTACT_LIBRARY_DIR "${CMAKE_CURRENT_BINARY_DIR}/lib")

if(WIN32)
    set(commands_beside COMMAND "${CMAKE_COMMAND}" -E copy_if_different "${cargo_output}/${RAYCONTACT_IMPORT_FILE}"
                        "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_IMPORT_FILE}")
    set(import_library "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_IMPORT_FILE}")
else()
    set(commands_beside COMMAND "${CMAKE_COMMAND}" -E create_symlink "${RAYCONTACT_SHARED_FILE}"
                        "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_SONAME}"
                        COMMAND "${CMAKE_COMMAND}" -E create_symlink "${RAYCONTACT_SHARED_SONAME}"
                        "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_NAME}")
    set(import_library "")
endif()

# Runs at every build: cargo alone knows whether anything is to be done. Copies keep their time stamp when nothing
# changed, so that programs are not linked again.
add_custom_target(
    raycontact_crate ALL
    COMMAND "${RAYCONTACT_CARGO}" build --lib --locked --profile ${cargo_profile}
            --manifest-path "${CMAKE_CURRENT_SOURCE_DIR}/Cargo.toml"
            --target-dir "${RAYCONTACT_CARGO_TARGET_DIR}"
    COMMAND "${CMAKE_COMMAND}" -E make_directory "${RAYCONTACT_LIBRARY_DIR}"
    COMMAND "${CMAKE_COMMAND}" -E copy_if_different "${cargo_output}/${RAYCONTACT_STATIC_FILE}"
            "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_STATIC_FILE}"
    COMMAND "${CMAKE_COMMAND}" -E copy_if_different "${cargo_output}/${RAYCONTACT_SHARED_NAME}"
            "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_FILE}"
    ${commands_beside}
    BYPRODUCTS "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_STATIC_FILE}"
               "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_FILE}" ${import_library}
    COMMENT "Building the crate (cargo, profile ${cargo_profile})"
    USES_TERMINAL VERBATIM)

set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED GLOBAL)
include("${CMAKE_CURRENT_LIST_DIR}/SystemLibraries.cmake")
raycontact_find_system_libraries(RAYCONTACT_SYSTEM_LIBRARIES RAYCONTACT_SYSTEM_FLAGS)

add_library(raycontact::raycontact SHARED IMPORTED GLOBAL)
set_target_properties(
    raycontact::raycontact
    PROPERTIES IMPORTED_LOCATION "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_FILE}"
               IMPORTED_SONAME "${RAYCONTACT_IMPORTED_SONAME}")
if(WIN32)
    set_property(TARGET raycontact::raycontact PROPERTY IMPORTED_IMPLIB "${import_library}")
endif()

add_library(raycontact::static STATIC IMPORTED GLOBAL)
set_target_properties(
    raycontact::static
    PROPERTIES IMPORTED_LOCATION "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_STATIC_FILE}"
               INTERFACE_LINK_LIBRARIES "${RAYCONTACT_SYSTEM_LIBRARIES}")

foreach(library IN ITEMS raycontact::raycontact raycontact::static)
    add_dependencies(${library} raycontact_crate)
    target_include_directories(${library} INTERFACE "${CMAKE_CURRENT_SOURCE_DIR}/include")
endforeach()
