// SPDX-License-Identifier: MIT
// The model of raw bytes and of recordings.
#include <cstdint>
#include <string>
#include <vector>

#include "c_handles.hpp"
#include "support/family_reference.hpp"

namespace {

using namespace g4lidar_c_test;

class CModel : public testing::Test {
 protected:
  /// The intensity of the second point, or -1 - the code of the error.
  int intensity_of(const std::string& source, const char* model) {
    g4lidar_options options = defaults();
    options.device = source.c_str();
    options.model = model;
    g4lidar_lidar* made = nullptr;
    const int code = g4lidar_open_with(&options, &made, &why_);
    const lidar it(made);
    if (code != G4LIDAR_OK) return -1 - code;
    EXPECT_EQ(g4lidar_start(made, &why_), G4LIDAR_OK) << why_.message;
    const g4lidar_scan* scan = nullptr;
    EXPECT_EQ(g4lidar_try_scan(made, 1000, &scan, &why_), G4LIDAR_OK) << why_.message;
    return scan == nullptr ? -1 : scan->points[1].intensity;
  }

  scratch scratch_;
  const std::vector<std::uint8_t> data_ = reference::t_mini_stream(6);
  std::string recorded_ = scratch_.path("walk.mcap");
  g4lidar_error why_{};
};

TEST_F(CModel, RecordingsStateIt) {
  g4lidar_recorder_options wanted;
  g4lidar_recorder_options_init(&wanted, sizeof wanted);
  wanted.model = "x44";
  g4lidar_recorder* made = nullptr;
  EXPECT_EQ(g4lidar_recorder_create(recorded_.c_str(), &wanted, &made, nullptr),
            G4LIDAR_BAD_OPTION);
  wanted.model = "t-mini-pro";
  ASSERT_EQ(g4lidar_recorder_create(recorded_.c_str(), &wanted, &made, nullptr), G4LIDAR_OK);
  const recorder into(made);
  EXPECT_EQ(g4lidar_recorder_bytes(made, false, data_.data(), data_.size(), 1'000'000'000),
            G4LIDAR_OK);
  EXPECT_EQ(g4lidar_recorder_close(made, nullptr), G4LIDAR_OK);
  g4lidar_reader* found = nullptr;
  ASSERT_EQ(g4lidar_reader_open(recorded_.c_str(), &found, nullptr), G4LIDAR_OK);
  EXPECT_STREQ(g4lidar_reader_info(found)->model, "t-mini-pro");
  g4lidar_reader_free(found);
  EXPECT_EQ(intensity_of(recorded_, nullptr), 101);
  EXPECT_EQ(intensity_of(recorded_, "x4"), -1 - G4LIDAR_OTHER_DEVICE);
  EXPECT_NE(std::string(why_.message).find("t-mini-pro"), std::string::npos) << why_.message;
}

}  // namespace
