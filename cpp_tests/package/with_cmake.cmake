# find_package(raycontact) with the LIBRARY, raycontact or static.
include("${CMAKE_CURRENT_LIST_DIR}/tools.cmake")

file(REMOVE_RECURSE "${SCRATCH}")
consume_with_cmake("${SCRATCH}" ${LIBRARY} "-DCMAKE_PREFIX_PATH=${INSTALLED}")
