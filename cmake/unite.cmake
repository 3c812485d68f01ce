# SPDX-License-Identifier: MIT
# Fewer and larger translation units. With G4LIDAR_UNITE=OFF each source is compiled alone, as in the
# nightly: only this shows that it includes what it uses.
# - g4lidar_unite_directories: library and tools, by CMake's unity builds. Sources of the same directory have no
#   conflicting names. The numbers of sources keep a compiler below 700 MB (g++ 12 with -O1), but for Beast.
# - g4lidar_unite: tests. Each source gets an unnamed namespace of its own, so that names may
#   conflict.

# As a script: cmake -DTO=<file> -P unite.cmake -- <source>...
if(CMAKE_SCRIPT_MODE_FILE AND TO)
  set(united)
  set(is_source OFF)
  foreach(index RANGE ${CMAKE_ARGC})
    set(argument "${CMAKE_ARGV${index}}")
    if(is_source AND argument)
      cmake_path(GET argument STEM stem)
      file(READ "${argument}" text)
      string(REGEX REPLACE "\nnamespace {\n" "\nnamespace of_${stem} { namespace {\n" text "${text}")
      string(REGEX REPLACE "\n}  // namespace\n" "\n} }  // namespace\n" text "${text}")
      string(APPEND united "#line 1 \"${argument}\"\n${text}")
    elseif(argument STREQUAL "--")
      set(is_source ON)
    endif()
  endforeach()
  file(WRITE "${TO}" "${united}")
  return()
endif()

# g4lidar_unite_directories(<target> <maximum> <source>...): if G4LIDAR_UNITE is on, CMake combines the sources of a
# directory that the target has, except the named ones; those of a directory of src with those of its directories. Sets
# <target>_compiled to what is compiled: options of single sources are given to these files.
function(g4lidar_unite_directories target most)
  get_target_property(sources ${target} SOURCES)
  list(FILTER sources INCLUDE REGEX "\\.cpp$")
  list(TRANSFORM sources PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" REGEX "^[^/]")
  set(compiled ${sources})
  if(G4LIDAR_UNITE)
    list(TRANSFORM ARGN PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" OUTPUT_VARIABLE compiled)
    list(REMOVE_ITEM sources ${compiled})
    foreach(source IN LISTS sources)
      cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE group)
      string(REGEX REPLACE "^(src/|.+/)([^/]+)/.*" "\\2" group "${group}")
      list(APPEND in_${group} "${source}")
      list(LENGTH in_${group} count)
      math(EXPR batch "(${count} - 1) / ${most}")
      set_source_files_properties("${source}" PROPERTIES UNITY_GROUP ${group}_${batch})
      list(APPEND compiled "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/Unity/unity_${group}_${batch}_cxx.cxx")
    endforeach()
    list(REMOVE_DUPLICATES compiled)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  endif()
  set(${target}_compiled ${compiled} PARENT_SCOPE)
endfunction()

set(G4LIDAR_UNITE_SCRIPT "${CMAKE_CURRENT_LIST_FILE}")

# g4lidar_unite(<target> <maximum> <source>...): adds the sources to the target, combined if
# G4LIDAR_UNITE is on. A source with its own macros stays alone, also one with more than its unnamed
# namespace.
function(g4lidar_unite target most)
  set(sources)
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source)
    file(READ "${source}" text)
    if(G4LIDAR_UNITE AND NOT text MATCHES "\n#define" AND NOT text MATCHES "\nnamespace {\n.*\nnamespace {\n" AND text MATCHES
                                                           "\n}  // namespace\n(}  // namespace [a-z0-9_:]+\n)*$"
    )
      list(APPEND sources "${source}")
    else()
      target_sources(${target} PRIVATE "${source}")
    endif()
  endforeach()
  list(LENGTH sources count)
  if(count EQUAL 0)
    return()
  endif()
  # Batches of nearly the same size.
  math(EXPR batches "(${count} + ${most} - 1) / ${most}")
  math(EXPR most "(${count} + ${batches} - 1) / ${batches}")
  set(directories)
  foreach(source IN LISTS sources)
    cmake_path(GET source PARENT_PATH directory)
    list(APPEND directories "${directory}")
  endforeach()
  list(REMOVE_DUPLICATES directories)
  target_include_directories(${target} PRIVATE ${directories}) # for headers in the directory of a source
  foreach(batch RANGE 1 ${batches})
    math(EXPR first "(${batch} - 1) * ${most}")
    list(SUBLIST sources ${first} ${most} batch_sources)
    set(united "${CMAKE_CURRENT_BINARY_DIR}/united/${target}_${batch}.cpp")
    add_custom_command(
      OUTPUT "${united}"
      COMMAND "${CMAKE_COMMAND}" "-DTO=${united}" -P "${G4LIDAR_UNITE_SCRIPT}" -- ${batch_sources}
      DEPENDS ${batch_sources} "${G4LIDAR_UNITE_SCRIPT}"
      COMMENT "Uniting the sources of ${target}, ${batch} of ${batches}"
      VERBATIM
    )
    target_sources(${target} PRIVATE "${united}")
  endforeach()
endfunction()
