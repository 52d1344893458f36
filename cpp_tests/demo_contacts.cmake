# The program evaluation/demos/contacts: its table, its CSV, its exit statuses.

file(WRITE "${FOLDER}/octahedron.obj"
     "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n"
     "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n")
set(two_files "${FOLDER}/octahedron.obj" "${FOLDER}/octahedron.obj")

# check(<exit status> <pattern in stdout> <pattern in stderr> <argument>...)
function(check expected_status stdout_pattern stderr_pattern)
    execute_process(COMMAND "${PROGRAM}" ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE err)
    if(NOT status EQUAL expected_status OR NOT out MATCHES "${stdout_pattern}" OR NOT err MATCHES "${stderr_pattern}")
        message(SEND_ERROR "contacts ${ARGN}: status ${status} (expected ${expected_status})\n"
                           "stdout, expected ${stdout_pattern}:\n${out}\nstderr, expected ${stderr_pattern}:\n${err}")
    endif()
endfunction()

set(overlapping --spacing 0 --shift 1.5 0.125 0.0625 ${two_files})
check(0 "first into second +1 +0\\.3125" "^$" ${overlapping})
check(0 "second into first +1 +0\\.3125" "^$" ${overlapping})
check(0 "net force \\(N\\) +-0\\.208333 " "^$" ${overlapping})
check(0 "\n0,1,[0-9]+,0,1,0,0,6,0\\.6875,0,0,-1,[^\n]*\n1,0,[0-9]+,1,[^\n]*\n$" "^$" --csv ${overlapping})
check(0 "both +0 +0\n" "^$" ${two_files} --shift -5 0 0)
check(0 "usage: contacts" "^$" --help)
check(2 "^$" "give two .obj files" "${FOLDER}/octahedron.obj")
check(2 "^$" "unknown option --fast" --fast ${two_files})
check(2 "^$" "finite numbers, not up" ${two_files} --shift 1 up 0)
check(2 "^$" "--spacing needs" --spacing -1 ${two_files})
check(2 "^$" "three numbers" ${two_files} --shift 1 2)
check(2 "^$" "missing.obj.*RAYC_STATUS_FILE_NOT_READABLE" "${FOLDER}/octahedron.obj" "${FOLDER}/missing.obj")
