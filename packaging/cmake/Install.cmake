# Installs the headers, both libraries and what finds them: a CMake package and a pkg-config file, both of which may be
# moved with the rest. Component `runtime` is what a program needs to run, `development` what it needs to be built.
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/raycontact")

# Development link, SONAME link, the file itself. Windows looks for DLLs beside programs.
if(WIN32)
    set(shared_dir "${CMAKE_INSTALL_BINDIR}")
    set(development_file "${RAYCONTACT_IMPORT_FILE}")
else()
    set(shared_dir "${CMAKE_INSTALL_LIBDIR}")
    set(development_file "${RAYCONTACT_SHARED_NAME}")
    install(FILES "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_SONAME}" DESTINATION "${shared_dir}" COMPONENT runtime)
endif()
install(PROGRAMS "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_FILE}" DESTINATION "${shared_dir}" COMPONENT runtime)
install(FILES LICENSE-MIT LICENSE-APACHE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT runtime)
install(
    DIRECTORY include/
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
    COMPONENT development
    FILES_MATCHING
    PATTERN "*.h"
    PATTERN "*.hpp")
install(FILES "${RAYCONTACT_LIBRARY_DIR}/${development_file}"
              "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_STATIC_FILE}" DESTINATION "${CMAKE_INSTALL_LIBDIR}"
        COMPONENT development)

# `cmake --install --strip` strips only what CMake has linked itself. The options are those of GNU's strip.
if(CMAKE_STRIP AND NOT APPLE)
    foreach(entry IN ITEMS "runtime:--strip-unneeded:${shared_dir}/${RAYCONTACT_SHARED_FILE}"
                           "development:--strip-debug:${CMAKE_INSTALL_LIBDIR}/${RAYCONTACT_STATIC_FILE}")
        string(REPLACE ":" ";" entry "${entry}")
        list(GET entry 0 component)
        list(GET entry 1 option)
        list(GET entry 2 file)
        install(
            CODE "if(CMAKE_INSTALL_DO_STRIP)
                set(file \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${file}\")
                execute_process(COMMAND \"${CMAKE_STRIP}\" ${option} \"\${file}\" COMMAND_ERROR_IS_FATAL ANY)
            endif()"
            COMPONENT ${component})
    endforeach()
endif()

configure_package_config_file(
    packaging/cmake/raycontactConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/raycontactConfig.cmake"
    INSTALL_DESTINATION "${package_dir}"
    PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR shared_dir)
# What the versions cannot tell before 1.0, the ABI number does: the C++ headers check it.
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/raycontactConfigVersion.cmake"
                                 COMPATIBILITY SameMajorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/raycontactConfig.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/raycontactConfigVersion.cmake" packaging/cmake/raycontactMpi.cmake DESTINATION "${package_dir}"
        COMPONENT development)

# Relative to the file itself, unless the folders were given as absolute paths.
set(pc_prefix "${CMAKE_INSTALL_PREFIX}")
set(pc_libdir "${CMAKE_INSTALL_FULL_LIBDIR}")
set(pc_includedir "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" AND NOT IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
    file(RELATIVE_PATH up "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
    string(REGEX REPLACE "/$" "" pc_prefix "\${pcfiledir}/${up}")
    set(pc_libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
    set(pc_includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()
configure_file(packaging/cmake/raycontact.pc.in "${CMAKE_CURRENT_BINARY_DIR}/raycontact.pc" @ONLY)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/raycontact.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
        COMPONENT development)
