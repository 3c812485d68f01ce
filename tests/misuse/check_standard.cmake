# SPDX-License-Identifier: MIT
# cmake -DCOMPILER=<c++> -DINCLUDE=<directory> -DEIGEN=<directory> -DSCRATCH=<directory>
#   -P check_standard.cmake
#
# Compiled as C++17, each public header gives one message, that C++20 is needed, and nothing else.

cmake_minimum_required(VERSION 3.22)
set(ENV{LC_ALL} C) # the messages in English, with plain quotes
file(GLOB_RECURSE headers RELATIVE "${INCLUDE}" "${INCLUDE}/g4lidar/*.hpp")
list(LENGTH headers count)
if(count EQUAL 0)
  message(FATAL_ERROR "No headers in ${INCLUDE}")
endif()

foreach(header IN LISTS headers)
  file(WRITE "${SCRATCH}/source.cpp" "#include \"${header}\"\n")
  execute_process(
    COMMAND "${COMPILER}" -std=c++17 -fsyntax-only "-I${INCLUDE}" -isystem "${EIGEN}" "${SCRATCH}/source.cpp"
    RESULT_VARIABLE result ERROR_VARIABLE output
  )
  string(REPLACE ";" " " lines "${output}")
  string(REPLACE "\n" ";" lines "${lines}")
  list(FILTER lines INCLUDE REGEX "error: ")
  list(LENGTH lines errors)
  if(result EQUAL 0 OR NOT errors EQUAL 2
     OR NOT lines MATCHES "^[^;]*libg4lidar needs C\\+\\+20: compile with[^;]*;[^;]*libg4lidar-needs-c\\+\\+20"
  )
    message(FATAL_ERROR "${header} as C++17: expected the sentence and no further error, but:\n${output}")
  endif()
endforeach()
message("${count} headers, each with the sentence")
