# Installs the headers, both libraries and a package that find_package(raycontact) finds wherever it is moved to.
include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/raycontact")

install(
    DIRECTORY include/
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
    FILES_MATCHING
    PATTERN "*.h"
    PATTERN "*.hpp")
# Development link, SONAME link, the file itself.
install(PROGRAMS "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_FILE}" DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(FILES "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_SONAME}"
              "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_SHARED_NAME}"
              "${RAYCONTACT_LIBRARY_DIR}/${RAYCONTACT_STATIC_FILE}" DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(FILES LICENSE-MIT LICENSE-APACHE DESTINATION "${CMAKE_INSTALL_DOCDIR}")

configure_package_config_file(
    cmake/raycontactConfig.cmake.in "${CMAKE_CURRENT_BINARY_DIR}/raycontactConfig.cmake"
    INSTALL_DESTINATION "${package_dir}"
    PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_INCLUDEDIR)
# Before 1.0 a new minor version may break its callers.
if(PROJECT_VERSION_MAJOR EQUAL 0)
    set(compatibility SameMinorVersion)
else()
    set(compatibility SameMajorVersion)
endif()
write_basic_package_version_file("${CMAKE_CURRENT_BINARY_DIR}/raycontactConfigVersion.cmake"
                                 COMPATIBILITY ${compatibility})
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/raycontactConfig.cmake"
              "${CMAKE_CURRENT_BINARY_DIR}/raycontactConfigVersion.cmake" DESTINATION "${package_dir}")
