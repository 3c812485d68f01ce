# SPDX-License-Identifier: MIT
# cmake -DSCRIPT=<check_budgets.cmake> -DAWK=<awk> -DSCRATCH=<directory> -P check_budgets_test.cmake
#
# Test of the check itself, with files of known length.

cmake_minimum_required(VERSION 3.22)

function(expect budgets message)
  file(WRITE "${SCRATCH}/budgets.txt" "# a comment\n${budgets}")
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DROOT=${SCRATCH}" "-DBUDGETS=${SCRATCH}/budgets.txt" "-DAWK=${AWK}" -P "${SCRIPT}"
    OUTPUT_VARIABLE output ERROR_VARIABLE output
  )
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(NOT output MATCHES "${message}")
    message(FATAL_ERROR "expected '${message}', but:\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE "${SCRATCH}")
file(WRITE "${SCRATCH}/src/a.cpp" "1\n2\n3\n")
file(WRITE "${SCRATCH}/src/b.hpp" "1\n2\n")
file(WRITE "${SCRATCH}/tests/c.cpp" "1\n2\n3\n4\n")
file(WRITE "${SCRATCH}/tests/d.png" "1\n2\n3\n4\n")
expect("5 library ^src/\n4 tests ^tests/\n" "library: 5 of 5, tests: 4 of 4")
expect("4 library ^src/\n4 tests ^tests/\n" "library: 5 lines, at most 4 *$")
expect("- headers hpp$\n3 library ^src/\n" "library: 3 of 3")
expect("3 library ^src/a\n1 all .\n" "all: 6 lines, at most 1")
expect("2 files own ^src/\n5 library ^src/\n" "own: 2 of 2 files, library: 5 of 5")
expect("5 library ^src/\n1 files headers hpp$\n2 files all ^(src|tests)/\n" "all: 3 files, at most 2")
expect("five library ^src/\n" "not a room: five library")
