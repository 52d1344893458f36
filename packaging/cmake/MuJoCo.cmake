# MuJoCo 4.0 as the target raycontact_mujoco, where it is found; scripts/mujoco.sh puts it where this looks.
set(RAYCONTACT_MUJOCO_DIR "${PROJECT_SOURCE_DIR}/build/mujoco" CACHE PATH "MuJoCo: a folder with include/ and lib/")
file(GLOB mujoco_library "${RAYCONTACT_MUJOCO_DIR}/lib/libmujoco.so.4.0.*")
if(NOT mujoco_library OR NOT EXISTS "${RAYCONTACT_MUJOCO_DIR}/include/mujoco/mujoco.h")
    message(WARNING "MuJoCo 4.0 is missing: its demo, plugin and tests are left out (scripts/mujoco.sh fetches it)")
    return()
endif()
list(GET mujoco_library 0 mujoco_library)
add_library(raycontact_mujoco SHARED IMPORTED GLOBAL)
set_target_properties(raycontact_mujoco PROPERTIES IMPORTED_LOCATION "${mujoco_library}" INTERFACE_INCLUDE_DIRECTORIES
                                                   "${RAYCONTACT_MUJOCO_DIR}/include")
