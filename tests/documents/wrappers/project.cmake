# SPDX-License-Identifier: MIT
# Round lines of CMake that want a project with an executable `robot`.
cmake_minimum_required(VERSION 3.22)
project(consumer LANGUAGES CXX)
add_executable(robot main.cpp)
@fragment@
