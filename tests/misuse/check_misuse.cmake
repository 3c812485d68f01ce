# SPDX-License-Identifier: MIT
# cmake -DCOMPILE=<command> -DEIGEN=<directory> -DHEADERS=<precompiled> -DSOURCE=<file> -P check_misuse.cmake

set(compile ${COMPILE} -isystem "${EIGEN}" -fsyntax-only -include "${HEADERS}")
set(ENV{LC_ALL} C) # the messages in English, with plain quotes

file(STRINGS "${SOURCE}" expectations REGEX "^// expect: ")
if(NOT expectations)
  message(FATAL_ERROR "${SOURCE} has no line '// expect: <regular expression>'")
endif()

execute_process(COMMAND ${compile} "${SOURCE}" RESULT_VARIABLE result ERROR_VARIABLE output)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "Without its bad line ${SOURCE} must compile, but:\n${output}")
endif()

execute_process(COMMAND ${compile} -DMISUSE "${SOURCE}" RESULT_VARIABLE result ERROR_VARIABLE output)
if(result EQUAL 0)
  message(FATAL_ERROR "With its bad line ${SOURCE} must not compile, but it does")
endif()
string(REGEX REPLACE "[][;]" " " lines "${output}") # the characters with a meaning in a list
string(REPLACE "\n" ";" lines "${lines}")
foreach(expectation IN LISTS expectations)
  string(REGEX REPLACE "^// expect: " "" expectation "${expectation}")
  set(found ${lines})
  list(FILTER found INCLUDE REGEX "${expectation}")
  if(NOT found)
    message(FATAL_ERROR "${SOURCE} is refused, but no line matches '${expectation}':\n${output}")
  endif()
endforeach()
