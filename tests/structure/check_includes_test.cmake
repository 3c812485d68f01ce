# SPDX-License-Identifier: MIT
# cmake -DSCRIPT=<check_includes.cmake> -DSCRATCH=<directory> -P check_includes_test.cmake
#
# Test of the check itself: small header trees with one error each must be refused for that error.

cmake_minimum_required(VERSION 3.22)
file(WRITE "${SCRATCH}/layers.txt" "0 ground earth\n1 wall\n2 roof error\n")

function(tree name) # <file> <text>...: the sound tree with these files instead
  file(REMOVE_RECURSE "${SCRATCH}/${name}")
  foreach(header ground earth)
    file(WRITE "${SCRATCH}/${name}/${header}.hpp" "#include <cstdint>\n")
  endforeach()
  file(WRITE "${SCRATCH}/${name}/wall.hpp" "#include \"g4lidar/ground.hpp\"\n")
  file(WRITE "${SCRATCH}/${name}/error.hpp" "")
  file(WRITE "${SCRATCH}/${name}/roof.hpp" "#include <g4lidar/wall.hpp>\n")
  file(WRITE "${SCRATCH}/${name}/sim/world.hpp" "#include \"g4lidar/wall.hpp\"\n")
  while(ARGN)
    list(POP_FRONT ARGN file text)
    file(WRITE "${SCRATCH}/${name}/${file}" "${text}\n")
  endwhile()
endfunction()

function(expect name message)
  execute_process(
    COMMAND "${CMAKE_COMMAND}" "-DHEADERS=${SCRATCH}/${name}" "-DLAYERS=${SCRATCH}/layers.txt" -P "${SCRIPT}"
    OUTPUT_VARIABLE output ERROR_VARIABLE output
  )
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(NOT output MATCHES "${message}")
    message(FATAL_ERROR "${name}: expected '${message}', but:\n${output}")
  endif()
endfunction()

tree(sound)
expect(sound "6 headers, 3 includes among them, each downward")
tree(upward wall.hpp "#include \"g4lidar/roof.hpp\"")
expect(upward "wall.hpp .layer 1. includes roof.hpp .layer 2., which is not below it")
expect(upward "a circle of includes")
tree(sideways ground.hpp "  #  include <g4lidar/earth.hpp>")
expect(sideways "ground.hpp .layer 0. includes earth.hpp .layer 0.")
tree(neighbour earth.hpp "#include \"g4lidar/ground.hpp\"")
expect(neighbour "each downward")
tree(homeless shed.hpp "")
expect(homeless "shed.hpp has no layer")
tree(sim_above sim/world.hpp "#include \"g4lidar/roof.hpp\"")
expect(sim_above "the simulator may use layers 0 and 1 only")
tree(sim_door sim/virtual_port.hpp "#include \"g4lidar/error.hpp\"" error.hpp "")
expect(sim_door "each downward")
tree(sim_no_door sim/world.hpp "#include \"g4lidar/error.hpp\"" error.hpp "")
expect(sim_no_door "includes error.hpp of layer 2")
tree(sim_door_too_far sim/pty_port.hpp "#include \"g4lidar/roof.hpp\"")
expect(sim_door_too_far "includes roof.hpp of layer 2")
tree(sim_circle sim/world.hpp "#include \"g4lidar/sim/ray.hpp\"" sim/ray.hpp "#include \"g4lidar/sim/world.hpp\"")
expect(sim_circle "a circle of includes among or above: sim/ray, sim/world")
tree(eigen wall.hpp "#include <Eigen/Core>")
expect(eigen "only eigen.hpp may")
tree(relative wall.hpp "#include \"ground.hpp\"")
expect(relative "write \"g4lidar/")
