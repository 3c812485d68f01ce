# SPDX-License-Identifier: MIT
# cmake -DSCRIPT=<check_symbols.cmake> -DSCRATCH=<directory> -P check_symbols_test.cmake
#
# Test of the check itself: listings with one wrong symbol each must be refused for that symbol.

cmake_minimum_required(VERSION 3.22)

# expect(<message> <processor> <symbol>...): the result for an object that needs these symbols.
function(expect message processor)
  set(listing)
  foreach(i RANGE 1 12)
    string(APPEND listing "function_${i} T 0 8\n")
  endforeach()
  foreach(symbol IN LISTS ARGN)
    string(APPEND listing "${symbol} U         \n")
  endforeach()
  # "nm -P <object>" prints the object.
  file(WRITE "${SCRATCH}/object" "${listing}")
  file(WRITE "${SCRATCH}/nm" "#!/bin/sh\nexec cat \"$2\"\n")
  file(CHMOD "${SCRATCH}/nm" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DNM=${SCRATCH}/nm" "-DOBJECT=${SCRATCH}/object"
            "-DPROCESSOR=${processor}" -P "${SCRIPT}"
    OUTPUT_VARIABLE output ERROR_VARIABLE output
  )
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(NOT output MATCHES "${message}")
    message(FATAL_ERROR "${ARGN} on ${processor}: expected '${message}', but:\n${output}")
  endif()
endfunction()

expect("12 functions of the core; external symbols: memcpy, memset" x86_64 memcpy memset)
expect("The core needs these external symbols: malloc" x86_64 memcpy malloc)
expect("The core needs these external symbols: _Znwm" x86_64 _Znwm)
expect("The core needs these external symbols: atan" x86_64 atan)
expect("The core needs these external symbols: __assert_fail" x86_64 __assert_fail)
expect("The core needs these external symbols: __cxa_throw" x86_64 __cxa_throw)
expect("The core needs these external symbols: __atomic_load_8" arm __atomic_load_8)
expect("The core needs these external symbols: __aeabi_dadd" x86_64 __aeabi_dadd)
expect("external symbols: __aeabi_dadd, __aeabi_ldivmod, __aeabi_f2lz" arm __aeabi_dadd __aeabi_ldivmod __aeabi_f2lz)
expect("The core needs these external symbols: __aeabi_atexit" arm __aeabi_atexit)
expect("The core needs these external symbols: __aeabi_unwind_cpp_pr0" arm __aeabi_unwind_cpp_pr0)
