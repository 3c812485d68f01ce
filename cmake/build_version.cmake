# SPDX-License-Identifier: MIT
# g4lidar_build_version(<target>): gives it a source that has the version of this build. Each build writes it, but only
# if the version has changed: a commit compiles this one source again. It is not united with others.

# As a script: cmake -DTO=<file> -P build_version.cmake
if(CMAKE_SCRIPT_MODE_FILE)
  cmake_minimum_required(VERSION 3.22)
  execute_process(
    COMMAND sh "${CMAKE_CURRENT_LIST_DIR}/version.sh"
    OUTPUT_VARIABLE line OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY
  )
  string(REPLACE " " ";" words "${line}")
  list(GET words 0 text)
  list(GET words 2 date)
  if(text MATCHES "~dev" AND NOT date STREQUAL "-")
    string(APPEND text " (${date})")
  endif()
  set(declaration "const char build_version[]")
  file(CONFIGURE OUTPUT "${TO}" @ONLY
       CONTENT "namespace g4_tool {\nextern @declaration@;\n@declaration@ = \"@text@\";\n}\n"
  )
  return()
endif()

set(G4LIDAR_BUILD_VERSION_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

function(g4lidar_build_version target)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/build_version.cpp")
  add_custom_target(
    ${target}_version
    COMMAND "${CMAKE_COMMAND}" "-DTO=${source}" -P "${G4LIDAR_BUILD_VERSION_SCRIPT}"
    BYPRODUCTS "${source}"
    VERBATIM
  )
  target_sources(${target} PRIVATE "${source}")
  add_dependencies(${target} ${target}_version)
endfunction()
