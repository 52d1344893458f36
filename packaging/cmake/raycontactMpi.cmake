# Offers raycontact::mpi: what <raycontact/mpi.hpp> needs besides the library, MPI and Zoltan. Only programs that include
# it link them.

# raycontact_add_mpi(<variable>) sets the variable to what is missing, or to nothing.
function(raycontact_add_mpi missing)
    set(${missing} "" PARENT_SCOPE)
    if(TARGET raycontact::mpi)
        return()
    endif()
    # The compiler of MPI may be there without its headers (Debian: openmpi-bin comes with VTK, for instance), and then
    # FindMPI ends in an error.
    find_program(RAYCONTACT_MPICC mpicc)
    mark_as_advanced(RAYCONTACT_MPICC)
    set(has_headers 0)
    if(RAYCONTACT_MPICC)
        file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/has_mpi.c" "#include <mpi.h>\n")
        execute_process(COMMAND "${RAYCONTACT_MPICC}" -E "${CMAKE_CURRENT_BINARY_DIR}/has_mpi.c"
                        RESULT_VARIABLE has_headers OUTPUT_QUIET ERROR_QUIET)
    endif()
    if(has_headers EQUAL 0)
        find_package(MPI QUIET COMPONENTS C)
    endif()
    if(NOT MPI_C_FOUND)
        set(${missing} "MPI is missing (Debian: libopenmpi-dev)" PARENT_SCOPE)
        return()
    endif()
    find_path(RAYCONTACT_ZOLTAN_INCLUDE_DIR zoltan.h PATH_SUFFIXES trilinos)
    find_library(RAYCONTACT_ZOLTAN_LIBRARY NAMES trilinos_zoltan zoltan)
    mark_as_advanced(RAYCONTACT_ZOLTAN_INCLUDE_DIR RAYCONTACT_ZOLTAN_LIBRARY)
    if(NOT RAYCONTACT_ZOLTAN_INCLUDE_DIR OR NOT RAYCONTACT_ZOLTAN_LIBRARY)
        set(${missing} "Zoltan is missing (Debian: libtrilinos-zoltan-dev)" PARENT_SCOPE)
        return()
    endif()
    add_library(raycontact::mpi INTERFACE IMPORTED GLOBAL)
    target_compile_features(raycontact::mpi INTERFACE cxx_std_17)
    # MPI's old C++ classes are not used.
    target_compile_definitions(raycontact::mpi INTERFACE OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
    target_include_directories(raycontact::mpi SYSTEM INTERFACE "${RAYCONTACT_ZOLTAN_INCLUDE_DIR}")
    target_link_libraries(raycontact::mpi INTERFACE raycontact::raycontact "${RAYCONTACT_ZOLTAN_LIBRARY}" MPI::MPI_C)
endfunction()
