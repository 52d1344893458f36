# A listing of the manual ends with 0 and prints what the manual says. PROGRAM: the listing, built, after what launches it;
# OUTPUT: a file.
execute_process(COMMAND ${PROGRAM} RESULT_VARIABLE ended OUTPUT_VARIABLE printed ERROR_VARIABLE complaint)
file(READ "${OUTPUT}" expected)
if(NOT ended STREQUAL "0" OR NOT printed STREQUAL expected)
    message(FATAL_ERROR "It ended with ${ended}, complained '${complaint}' and printed\n${printed}The manual says\n${expected}")
endif()
