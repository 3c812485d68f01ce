# SPDX-License-Identifier: MIT
# cmake -DSCRIPT=<check_exports.cmake> -DSCRATCH=<directory> -P check_exports_test.cmake
#
# Test of the check itself: a library that exports more, less or foreign symbols is refused.

cmake_minimum_required(VERSION 3.22)
set(expected "g4lidar::lidar::name() const" "g4lidar::list_ports()" "typeinfo for g4lidar::transport")
list(JOIN expected "\n" text)
file(WRITE "${SCRATCH}/list.txt" "${text}\n")
# "nm --dynamic --demangle --defined-only <library>" prints the library.
file(WRITE "${SCRATCH}/nm" "#!/bin/sh\nexec cat \"$4\"\n")
file(CHMOD "${SCRATCH}/nm" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)

# expect(<message> <symbol>...): the result for a library that exports these.
function(expect message)
  set(listing)
  foreach(symbol IN LISTS ARGN)
    string(APPEND listing "0000000000001000 T ${symbol}\n")
  endforeach()
  file(WRITE "${SCRATCH}/library" "${listing}")
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DNM=${SCRATCH}/nm" "-DLIBRARY=${SCRATCH}/library"
            "-DLIST=${SCRATCH}/list.txt" -P "${SCRIPT}"
    OUTPUT_VARIABLE output ERROR_VARIABLE output
  )
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(NOT output MATCHES "${message}")
    message(FATAL_ERROR "${ARGN}: expected '${message}', but:\n${output}")
  endif()
endfunction()

expect("3 symbols, all of them in the list" ${expected})
expect("3 symbols, all of them in the list" ${expected} "g4lidar::list_ports()"
       "typeinfo name for g4lidar::transport" "vtable for std::thread::_State_impl<g4lidar::x>"
       "void std::vector<g4lidar::x>::_M_realloc_insert<g4lidar::x>(g4lidar::x&&)"
       "g4lidar::x* std::__find_if<g4lidar::x*>(g4lidar::x*, g4lidar::x*)" "tl::expected<int, int>::value()"
)
expect("exported, but not in the list: g4lidar::find_holders\\(\\)" ${expected} "g4lidar::find_holders()")
expect("in the list, but not exported: g4lidar::list_ports\\(\\)" "g4lidar::lidar::name() const")
expect("outside namespace g4lidar: helper\\(std::string\\)" ${expected} "helper(std::string)")
expect("outside namespace g4lidar: udev_new" ${expected} "udev_new")
