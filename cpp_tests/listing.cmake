# A listing of a page is a part of the program that it is said to be of. PAGE, PROGRAM: files; LANGUAGE: that of the page's first
# listing in it, cpp unless told.
if(NOT LANGUAGE)
    set(LANGUAGE cpp)
endif()
file(READ "${PAGE}" page)
file(READ "${PROGRAM}" program)
string(REGEX MATCH "```${LANGUAGE}\n[^`]*```" listing "${page}")
string(REGEX REPLACE "```(${LANGUAGE}\n)?" "" listing "${listing}")
string(FIND "${program}" "${listing}" at)
if(listing STREQUAL "" OR at EQUAL -1)
    message(FATAL_ERROR "${PAGE}: its listing does not stand in ${PROGRAM}; copy it from there")
endif()
