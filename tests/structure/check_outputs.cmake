# SPDX-License-Identifier: MIT
# cmake -DROOT=<project> -P check_outputs.cmake
#
# Each source of the programs that creates, replaces or removes files has a claimed_output (tools/shared/io/command_files.hpp),
# which refuses the inputs of the command. tests/cli/outputs_test.cpp tries the commands.

cmake_minimum_required(VERSION 3.22)
set(writes "recording_writer::create|ofstream|O_WRONLY|O_RDWR|O_CREAT|fopen\\([^)]*\"[wa]|::(unlink|rename|truncate)\\(|filesystem::(remove|rename|resize_file|copy)")

# Sources that need none, and why.
set(others
    tools/g4-serve/page_recorder.cpp # creates files with names of its own, and removes them
)

file(GLOB_RECURSE sources RELATIVE "${ROOT}" "${ROOT}/tools/*.[ch]pp")
set(faults)
set(found 0)
foreach(source IN LISTS sources)
  file(STRINGS "${ROOT}/${source}" lines REGEX "${writes}")
  if(NOT lines)
    continue()
  endif()
  math(EXPR found "${found} + 1")
  file(STRINGS "${ROOT}/${source}" claims REGEX "claimed_output|claim_")
  if(NOT claims AND NOT source IN_LIST others)
    list(APPEND faults "${source} writes files without a claimed_output: ${lines}")
  endif()
endforeach()
if(found EQUAL 0)
  list(APPEND faults "no source in ${ROOT}/tools writes files")
endif()
if(faults)
  list(JOIN faults "\n  " text)
  message(FATAL_ERROR "Outputs that are not checked:\n  ${text}")
endif()
message("${found} sources write files, and each is checked")
