# <raycontact/mpi.hpp> on 1 to 4 ranks of this machine, however few cores it has.
include(${PROJECT_SOURCE_DIR}/packaging/cmake/raycontactMpi.cmake)
raycontact_add_mpi(missing)
if(missing)
    message(WARNING "${missing}: the tests of raycontact/mpi.hpp are left out")
    return()
endif()

# raycontact_add_mpi_test(<name> <ranks> <program> [argument...])
function(raycontact_add_mpi_test name ranks program)
    add_test(NAME ${name} COMMAND "${MPIEXEC_EXECUTABLE}" --oversubscribe ${MPIEXEC_NUMPROC_FLAG} ${ranks}
                                  $<TARGET_FILE:${program}> ${ARGN})
    # Ranks that wait give way to those that work.
    set_tests_properties(
        ${name} PROPERTIES TIMEOUT 600 PROCESSORS ${ranks} ENVIRONMENT
                           "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_mpi_yield_when_idle=1")
endfunction()

foreach(program IN ITEMS drifting_bodies rubbing_bodies distributed_bad_input distributed_system_bad_input)
    add_executable(${program} mpi/${program}.cpp)
    target_include_directories(${program} PRIVATE .)
    target_link_libraries(${program} PRIVATE raycontact::mpi)
    set_target_properties(${program} PROPERTIES NO_SYSTEM_FROM_IMPORTED ON)
endforeach()
# The other numbers of ranks and the other parts take more than seven minutes on two cores.
set(numbers_of_ranks 1 4)
set(parts_left_out looks escape)
if(RAYCONTACT_LONG_TESTS)
    set(numbers_of_ranks 1 2 3 4)
    set(parts_left_out looks materials half-spaces collision escape)
endif()
foreach(ranks IN LISTS numbers_of_ranks)
    raycontact_add_mpi_test(distributed_on_${ranks} ${ranks} drifting_bodies)
    raycontact_add_mpi_test(distributed_system_on_${ranks} ${ranks} rubbing_bodies)
    raycontact_add_mpi_test(distributed_pairs_on_${ranks} ${ranks} drifting_bodies --pairs)
    raycontact_add_mpi_test(distributed_system_with_all_on_${ranks} ${ranks} rubbing_bodies --all)
    raycontact_add_mpi_test(distributed_explicit_on_${ranks} ${ranks} rubbing_bodies --explicit)
endforeach()
raycontact_add_mpi_test(distributed_in_single_precision 3 drifting_bodies --single)
raycontact_add_mpi_test(distributed_without_memory 3 drifting_bodies --drop-memory)
raycontact_add_mpi_test(distributed_system_without_memory 3 rubbing_bodies --drop-memory)
raycontact_add_mpi_test(distributed_pairs_untold 3 drifting_bodies --silent)
foreach(part IN LISTS parts_left_out)
    raycontact_add_mpi_test(distributed_system_without_${part} 2 rubbing_bodies --all-but ${part})
endforeach()
raycontact_add_mpi_test(distributed_killed_rank 3 drifting_bodies --kill)
set_tests_properties(distributed_killed_rank PROPERTIES PASS_REGULAR_EXPRESSION "process rank 2 .*signal 9" TIMEOUT 30)
raycontact_add_mpi_test(distributed_bad_input 3 distributed_bad_input)
raycontact_add_mpi_test(distributed_bad_input_alone 1 distributed_bad_input)
raycontact_add_mpi_test(distributed_system_bad_input 3 distributed_system_bad_input)
raycontact_add_mpi_test(distributed_system_bad_input_alone 1 distributed_system_bad_input)

# The listing of the page, on two ranks.
set(launcher "${MPIEXEC_EXECUTABLE}" --oversubscribe ${MPIEXEC_NUMPROC_FLAG} 2)
raycontact_add_listings(docs/distributed.md raycontact::mpi)
unset(launcher)
set_tests_properties(${listings} PROPERTIES PROCESSORS 2 ENVIRONMENT
                     "OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1;OMPI_MCA_mpi_yield_when_idle=1")
