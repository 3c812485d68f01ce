# SPDX-License-Identifier: MIT
# cmake -DHEADERS=<directory> -DTESTS=<directory> -DAWK=<awk> -P check_extreme.cmake
#
# Each public function that takes a number is named in a test of <tests>, which calls it with extreme numbers, or in
# <tests>/left_out.txt with the reason why not. Functions of one name count as one.

cmake_minimum_required(VERSION 3.22)

file(GLOB_RECURSE headers "${HEADERS}/*.hpp" "${HEADERS}/*.h")
list(FILTER headers EXCLUDE REGEX "/detail/[^/]*$")
list(SORT headers)
execute_process(
  COMMAND "${AWK}" -f "${CMAKE_CURRENT_LIST_DIR}/list_number_functions.awk" ${headers}
  OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY
)
string(REPLACE "\n" ";" found "${found}")
list(REMOVE_DUPLICATES found)

file(GLOB tests "${TESTS}/*_test.cpp")
set(called)
foreach(test IN LISTS tests)
  file(READ "${test}" text)
  string(REGEX REPLACE "//[^\n]*|#include[^\n]*" "" text "${text}")
  string(REGEX MATCHALL "[a-z_0-9]+" words "${text}")
  list(APPEND called ${words})
endforeach()
list(REMOVE_DUPLICATES called)
file(STRINGS "${TESTS}/left_out.txt" lines REGEX "^[^#]")

set(left_out)
set(faults)
foreach(line IN LISTS lines)
  string(REGEX REPLACE ":.*" "" name "${line}")
  list(APPEND left_out "${name}")
  if(NOT line MATCHES "^[a-z_0-9]+: .")
    list(APPEND faults "left_out.txt: '${line}' is not 'name: why'")
  elseif(NOT "${found};" MATCHES ": ${name};")
    list(APPEND faults "left_out.txt: no function ${name} takes a number")
  elseif(name IN_LIST called)
    list(APPEND faults "left_out.txt: a test calls ${name}")
  endif()
endforeach()
foreach(each IN LISTS found)
  string(REGEX REPLACE "^.*: " "" name "${each}")
  if(NOT name IN_LIST called AND NOT name IN_LIST left_out)
    list(APPEND faults "${each} is not called with extreme numbers: add it to a test in tests/extreme")
  endif()
endforeach()
list(LENGTH found count)
if(count LESS 1)
  list(APPEND faults "no function takes a number")
endif()
if(faults)
  list(JOIN faults "\n" faults)
  message(FATAL_ERROR "${faults}")
endif()
message("${count} public functions take numbers; each is tested with extreme ones, or left out for a reason")
