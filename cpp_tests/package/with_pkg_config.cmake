# Plain cc and pkg-config, with the LIBRARY, raycontact or static.
include("${CMAKE_CURRENT_LIST_DIR}/tools.cmake")

file(REMOVE_RECURSE "${SCRATCH}")
if(LIBRARY STREQUAL "static")
    # As on a machine that has the static library only; the linker would prefer the other.
    file(COPY "${INSTALLED}/" DESTINATION "${SCRATCH}/static_only")
    file(GLOB_RECURSE shared_libraries "${SCRATCH}/static_only/*.so*")
    file(REMOVE ${shared_libraries})
    consume_with_pkg_config("${SCRATCH}/build" "${SCRATCH}/static_only" --static)
else()
    consume_with_pkg_config("${SCRATCH}/build" "${INSTALLED}")
endif()
