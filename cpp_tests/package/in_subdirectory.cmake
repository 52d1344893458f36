# add_subdirectory(raycontact), with the LIBRARY, raycontact or static.
include("${CMAKE_CURRENT_LIST_DIR}/tools.cmake")

file(REMOVE_RECURSE "${SCRATCH}")
consume_with_cmake("${SCRATCH}" ${LIBRARY} "-DSUBDIRECTORY=${SOURCE}" "-DCMAKE_BUILD_TYPE=${BUILD_TYPE}"
                   "-DRAYCONTACT_CARGO_TARGET_DIR=${CARGO_TARGET_DIR}")
