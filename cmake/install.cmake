# SPDX-License-Identifier: MIT
# cmake --install: headers, libraries, the CMake package g4lidar with its components, and the
# pkg-config files g4lidar-core.pc, g4lidar.pc, g4lidar-sim.pc, g4lidar-eigen.pc and g4lidar-c.pc. The C interface
# is also a CMake package of its own, g4lidar-c: its users need none of the others.

include(CMakePackageConfigHelpers)

set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/g4lidar")

# Each component has its own export file, so that it does not need the dependencies of another one.
# install_component(<component> <target> [<package>])
function(install_component component target)
  set(directory "${package_dir}")
  if(ARGC GREATER 2)
    set(directory "${CMAKE_INSTALL_LIBDIR}/cmake/${ARGV2}")
  endif()
  if(CMAKE_VERSION VERSION_LESS 3.23)
    set(headers)
  else()
    set(headers FILE_SET HEADERS)
  endif()
  install(
    TARGETS ${target}
    EXPORT g4lidar-${component}
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}"
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}"
    ${headers}
  )
  install(
    EXPORT g4lidar-${component}
    NAMESPACE g4lidar::
    DESTINATION "${directory}"
  )
endfunction()

install_component(core g4lidar_core)
if(TARGET g4lidar_eigen)
  install_component(eigen g4lidar_eigen)
endif()
if(G4LIDAR_HOSTED)
  install_component(library g4lidar)
endif()
if(TARGET g4lidar_sim)
  install_component(sim g4lidar_sim)
endif()
if(TARGET g4lidar_c)
  install_component(c g4lidar_c g4lidar-c)
endif()

if(CMAKE_VERSION VERSION_LESS 3.23)
  install(
    DIRECTORY "${PROJECT_SOURCE_DIR}/include/g4lidar"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
    FILES_MATCHING
    PATTERN "*.hpp"
  )
  if(TARGET g4lidar_c)
    install(FILES "${PROJECT_SOURCE_DIR}/include/g4lidar.h" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
    install(
      DIRECTORY "${PROJECT_SOURCE_DIR}/include/g4lidar/c"
      DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/g4lidar"
      FILES_MATCHING
      PATTERN "*.h"
    )
  endif()
endif()

write_basic_package_version_file(
  "${PROJECT_BINARY_DIR}/cmake/g4lidar-config-version.cmake"
  COMPATIBILITY SameMinorVersion # until 1.0 a minor version may break the interface
)
if(G4LIDAR_HOSTED AND G4LIDAR_DEVICE)
  set(has_device TRUE)
else()
  set(has_device FALSE)
endif()
configure_file(
  "${PROJECT_SOURCE_DIR}/cmake/g4lidar-config.cmake.in"
  "${PROJECT_BINARY_DIR}/cmake/g4lidar-config.cmake" @ONLY
)
install(FILES "${PROJECT_BINARY_DIR}/cmake/g4lidar-config.cmake"
              "${PROJECT_BINARY_DIR}/cmake/g4lidar-config-version.cmake"
        DESTINATION "${package_dir}"
)
if(TARGET g4lidar_c)
  set(c_package "${PROJECT_BINARY_DIR}/cmake/g4lidar-c")
  configure_file("${PROJECT_SOURCE_DIR}/cmake/g4lidar-c-config.cmake" "${c_package}-config.cmake" COPYONLY)
  configure_file("${PROJECT_BINARY_DIR}/cmake/g4lidar-config-version.cmake" "${c_package}-config-version.cmake" COPYONLY)
  install(FILES "${c_package}-config.cmake" "${c_package}-config-version.cmake"
          DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/g4lidar-c"
  )
endif()

# udev reads rules below /usr and /usr/local.
if(G4LIDAR_INSTALL_UDEV_RULE)
  install(FILES "${PROJECT_SOURCE_DIR}/packaging/udev/72-g4lidar.rules"
                "${PROJECT_SOURCE_DIR}/packaging/udev/91-g4lidar-no-brltty.rules"
          DESTINATION lib/udev/rules.d
  )
endif()

# systemd also reads units below both.
if(G4LIDAR_INSTALL_SYSTEMD_UNIT)
  set(g4_dump "${CMAKE_INSTALL_FULL_BINDIR}/g4-dump")
  set(unit "g4lidar-record@.service")
  configure_file(
    "${PROJECT_SOURCE_DIR}/packaging/systemd/${unit}.in"
    "${PROJECT_BINARY_DIR}/packaging/systemd/${unit}" @ONLY
  )
  install(FILES "${PROJECT_BINARY_DIR}/packaging/systemd/${unit}" DESTINATION lib/systemd/system)
  if(TARGET g4-ros2)
    set(g4_ros2 "${CMAKE_INSTALL_FULL_BINDIR}/g4-ros2")
    set(unit "g4lidar-ros2@.service")
    configure_file(
      "${PROJECT_SOURCE_DIR}/packaging/systemd/${unit}.in"
      "${PROJECT_BINARY_DIR}/packaging/systemd/${unit}" @ONLY
    )
    install(FILES "${PROJECT_BINARY_DIR}/packaging/systemd/${unit}"
            DESTINATION lib/systemd/system
    )
  endif()
endif()

# ---- pkg-config --------------------------------------------------------------------------------
# Written during the installation, because the prefix is known only then: cmake --install --prefix
# may set another one.
cmake_path(APPEND pc_libdir "\${prefix}" "${CMAKE_INSTALL_LIBDIR}")
cmake_path(APPEND pc_includedir "\${prefix}" "${CMAKE_INSTALL_INCLUDEDIR}")
# A program that links a static library also links its dependencies.
set(pc_device_libs)
set(pc_private_libs)
if(has_device)
  set(pc_system_libs "-lz -ldl -pthread")
  if(G4LIDAR_ZSTD)
    string(APPEND pc_system_libs " -lzstd")
  endif()
  if(BUILD_SHARED_LIBS)
    set(pc_private_libs "${pc_system_libs}")
  else()
    set(pc_device_libs " ${pc_system_libs}")
  endif()
endif()
set(CMAKE_INSTALL_PREFIX_LATER "@CMAKE_INSTALL_PREFIX@")
set(pc_names g4lidar-core)
if(TARGET g4lidar_eigen)
  list(APPEND pc_names g4lidar-eigen)
endif()
if(G4LIDAR_HOSTED)
  list(APPEND pc_names g4lidar)
endif()
if(TARGET g4lidar_sim)
  list(APPEND pc_names g4lidar-sim)
endif()
if(TARGET g4lidar_c)
  list(APPEND pc_names g4lidar-c)
endif()
foreach(name IN LISTS pc_names)
  set(pc_file "${PROJECT_BINARY_DIR}/packaging/${name}.pc")
  configure_file("${PROJECT_SOURCE_DIR}/packaging/${name}.pc.in" "${pc_file}.in" @ONLY)
  install(CODE "configure_file([==[${pc_file}.in]==] [==[${pc_file}]==] @ONLY)")
  install(FILES "${pc_file}" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig")
endforeach()
