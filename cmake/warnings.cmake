# SPDX-License-Identifier: MIT
# The warnings for this project. The top level includes it only if the project is not a
# subdirectory, and after the dependencies, so that it affects neither consumers nor dependencies.

add_compile_options(
  -Wall
  -Wextra
  -Wpedantic
  -Wshadow
  -Wconversion
  -Wsign-conversion
  -Wdouble-promotion
  -Wold-style-cast
  -Wnon-virtual-dtor
  -Woverloaded-virtual
  -Wcast-align
  -Wcast-qual
  -Wformat=2
  -Wimplicit-fallthrough
  -Wundef
  -Wvla
)

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-Wduplicated-cond -Wduplicated-branches -Wlogical-op)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^arm")
    add_compile_options(-Wno-psabi) # remarks about argument passing of g++ 7
  endif()
elseif(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options(-Wextra-semi -Wunreachable-code -Wshadow-all -Wno-shadow-field-in-constructor)
endif()

if(G4LIDAR_WERROR)
  add_compile_options(-Werror)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # g++ 12 wrongly reports such errors in optimised std::vector and std::string.
    add_compile_options(
      -Wno-error=array-bounds -Wno-error=stringop-overflow -Wno-error=stringop-overread
      -Wno-error=restrict -Wno-error=maybe-uninitialized
    )
  endif()
endif()
