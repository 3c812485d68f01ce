// SPDX-License-Identifier: MIT
#include "c_handles.hpp"

#include <cstdlib>
#include <filesystem>

namespace g4lidar_c_test {

scratch::scratch()
    : directory_((std::filesystem::temp_directory_path() / "g4lidar-c-XXXXXX").native()) {
  EXPECT_NE(::mkdtemp(directory_.data()), nullptr);
}

scratch::~scratch() { std::filesystem::remove_all(directory_); }

}  // namespace g4lidar_c_test
