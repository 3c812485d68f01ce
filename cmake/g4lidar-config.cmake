# SPDX-License-Identifier: MIT
# find_package(g4lidar [COMPONENTS core library eigen sim])
#
#   core     g4lidar::core      the headers of floors 0 to 5, freestanding
#   library  g4lidar::g4lidar   the compiled library, with the core
#   eigen    g4lidar::eigen     the core with Eigen; finds Eigen3
#   sim      g4lidar::sim       the simulated G4, with the core
#
# Without COMPONENTS: all of them that are installed; eigen only where Eigen3 is found.

cmake_policy(PUSH)
cmake_policy(VERSION 3.22)

if(g4lidar_FIND_COMPONENTS)
  set(_g4lidar_wanted ${g4lidar_FIND_COMPONENTS})
else()
  set(_g4lidar_wanted library eigen sim)
endif()
list(PREPEND _g4lidar_wanted core) # every other component stands on it
list(REMOVE_DUPLICATES _g4lidar_wanted)

foreach(_g4lidar_component IN LISTS _g4lidar_wanted)
  set(g4lidar_${_g4lidar_component}_FOUND FALSE)
  set(_g4lidar_targets "${CMAKE_CURRENT_LIST_DIR}/g4lidar-${_g4lidar_component}.cmake")
  if(NOT EXISTS "${_g4lidar_targets}")
    if(g4lidar_FIND_REQUIRED_${_g4lidar_component} OR _g4lidar_component STREQUAL "core")
      set(g4lidar_FOUND FALSE)
      set(g4lidar_NOT_FOUND_MESSAGE
          "the component '${_g4lidar_component}' is not installed (there are: core, library, eigen, sim)"
      )
    endif()
    continue()
  endif()
  if(_g4lidar_component STREQUAL "eigen" AND NOT TARGET Eigen3::Eigen)
    find_package(Eigen3 3.3 QUIET NO_MODULE)
    if(NOT TARGET Eigen3::Eigen)
      if(g4lidar_FIND_REQUIRED_eigen)
        set(g4lidar_FOUND FALSE)
        set(g4lidar_NOT_FOUND_MESSAGE "the component 'eigen' needs Eigen 3.3 or later (Eigen3)")
      endif()
      continue()
    endif()
  endif()
  include("${_g4lidar_targets}")
  set(g4lidar_${_g4lidar_component}_FOUND TRUE)
endforeach()

unset(_g4lidar_wanted)
unset(_g4lidar_component)
unset(_g4lidar_targets)
cmake_policy(POP)
