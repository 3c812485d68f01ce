# SPDX-License-Identifier: MIT
vcpkg_download_distfile(archive URLS "@DOWNLOADS@/libg4lidar-@TEXT_VERSION@.tar.gz"
                        FILENAME "libg4lidar-@TEXT_VERSION@.tar.gz" SHA512 "@SHA512@"
)
vcpkg_extract_source_archive(source ARCHIVE "${archive}")
vcpkg_cmake_configure(
  SOURCE_PATH "${source}"
  OPTIONS -DG4LIDAR_BUILD_C=OFF -DG4LIDAR_BUILD_TESTS=OFF -DG4LIDAR_BUILD_TOOLS=OFF -DG4LIDAR_BUILD_FUZZ=OFF
          -DG4LIDAR_BUILD_EXAMPLES=OFF
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/g4lidar)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${source}/LICENSE")
