# A listing of a page is a part of the program that it is said to be of. PAGE, PROGRAM: files.
file(READ "${PAGE}" page)
file(READ "${PROGRAM}" program)
string(REGEX MATCH "```cpp\n[^`]*```" listing "${page}")
string(REGEX REPLACE "```(cpp\n)?" "" listing "${listing}")
string(FIND "${program}" "${listing}" at)
if(listing STREQUAL "" OR at EQUAL -1)
    message(FATAL_ERROR "${PAGE}: its listing does not stand in ${PROGRAM}; copy it from there")
endif()
