# The shared library exports the committed list and nothing else, under its SONAME. To renew the list, on purpose:
# RAYCONTACT_WRITE_SYMBOLS=1 ctest -R exported_symbols

execute_process(
    COMMAND "${NM}" --dynamic --defined-only --format=posix "${LIBRARY}"
    OUTPUT_VARIABLE output
    COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "[^\n]+" lines "${output}")
list(TRANSFORM lines REPLACE " .*" "")
list(SORT lines)
list(JOIN lines "\n" exported)
string(APPEND exported "\n")

if(DEFINED ENV{RAYCONTACT_WRITE_SYMBOLS})
    file(WRITE "${LIST}" "${exported}")
endif()
file(READ "${LIST}" committed)
if(NOT exported STREQUAL committed)
    message(FATAL_ERROR "The exported symbols are not those of ${LIST}.\nExported:\n${exported}")
endif()

execute_process(
    COMMAND "${READELF}" --dynamic --wide "${LIBRARY}"
    OUTPUT_VARIABLE output
    COMMAND_ERROR_IS_FATAL ANY)
if(NOT output MATCHES "SONAME[^\n]*\\[${SONAME}\\]")
    message(FATAL_ERROR "The SONAME is not ${SONAME}:\n${output}")
endif()
