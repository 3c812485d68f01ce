// SPDX-License-Identifier: MIT
// The model of raw bytes and of recordings.
#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "c_handles.hpp"
#include "support/family_reference.hpp"

namespace {

using namespace g4lidar_c_test;

class CModel : public testing::Test {
 protected:
  CModel() {
    std::ofstream(raw_, std::ios::binary)
        .write(reinterpret_cast<const char*>(data_.data()),
               static_cast<std::streamsize>(data_.size()));
  }
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
  std::string raw_ = scratch_.path("raw.bin");
  std::string recorded_ = scratch_.path("walk.mcap");
  g4lidar_error why_{};
};

TEST_F(CModel, RawBytesShowTheirModel) {
  EXPECT_EQ(intensity_of(raw_, nullptr), 101);
  EXPECT_EQ(intensity_of(raw_, "t-mini-pro"), 101);
  EXPECT_EQ(intensity_of(raw_, "x44"), -1 - G4LIDAR_BAD_OPTION);
  EXPECT_NE(std::string(why_.message).find("'x44'"), std::string::npos) << why_.message;
  EXPECT_NE(std::string(why_.advice).find("g4, g4-pro, "), std::string::npos) << why_.advice;
  EXPECT_NE(std::string(why_.advice).find("tx20."), std::string::npos) << why_.advice;
}

TEST_F(CModel, IsNamedInAnySpelling) {
  for (const char* const label : {"T-mini Pro", "TminiPro", "YDLIDAR T_MINI PRO"}) {
    EXPECT_EQ(intensity_of(raw_, label), 101) << label;
    EXPECT_EQ(intensity_of(raw_ + "?model=" + label, nullptr), 101) << label;
  }
  for (const std::string label : {"GS2", "LD19", "coin-d4", "RPLIDAR A1"}) {
    EXPECT_EQ(intensity_of(raw_, label.c_str()), -1 - G4LIDAR_BAD_OPTION);
    EXPECT_NE(std::string(why_.message).find("'" + label + "' is not supported: "),
              std::string::npos)
        << why_.message;
  }
}

TEST_F(CModel, WhatIsListenedToGetsNoByte) {
  g4lidar_options options = defaults();
  EXPECT_FALSE(options.listen_only || options.leave_dtr);
  options.device = "sim:?model=t-mini&fault=scanning";
  options.listen_only = options.leave_dtr = true;
  g4lidar_lidar* made = nullptr;
  ASSERT_EQ(g4lidar_open_with(&options, &made, &why_), G4LIDAR_OK) << why_.message;
  const lidar it(made);
  EXPECT_EQ(g4lidar_start(made, &why_), G4LIDAR_OK) << why_.message;
  const g4lidar_scan* scan = nullptr;
  EXPECT_EQ(g4lidar_wait_scan(made, 10'000, &scan, &why_), G4LIDAR_OK) << why_.message;
  options.device = raw_.c_str();
  options.listen_only = false;
  g4lidar_lidar* none = nullptr;
  EXPECT_EQ(g4lidar_open_with(&options, &none, &why_), G4LIDAR_BAD_OPTION);
  EXPECT_NE(std::string(why_.message).find("leave_dtr"), std::string::npos) << why_.message;
}

TEST_F(CModel, TheNameThatIsMeantIsStated) {
  g4lidar_lidar* made = nullptr;
  EXPECT_EQ(g4lidar_open("ttyUSB0", &made, &why_), G4LIDAR_BAD_OPTION);
  EXPECT_NE(std::string(why_.message).find("did you mean /dev/ttyUSB0?"), std::string::npos)
      << why_.message;
}

TEST_F(CModel, AllPortsAreForLidarsOnly) {
  g4lidar_options options = defaults();
  EXPECT_FALSE(options.probe_all_ports);
  options.device = raw_.c_str();
  options.probe_all_ports = true;
  g4lidar_lidar* made = nullptr;
  EXPECT_EQ(g4lidar_open_with(&options, &made, &why_), G4LIDAR_BAD_OPTION);
  EXPECT_NE(std::string(why_.message).find("probe_all_ports"), std::string::npos) << why_.message;
}

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

// The zero packet of each revolution is at 0 degrees.
TEST_F(CModel, TheOffsetOfZeroIsGiven) {
  const auto sample = [](unsigned, unsigned, unsigned) { return reference::wire_sample{0, 1000}; };
  const auto tg = reference::revolutions_of(reference::wire_format_of("tg15"), 6, 30, 1, sample);
  std::ofstream(raw_, std::ios::binary)
      .write(reinterpret_cast<const char*>(tg.data.data()),
             static_cast<std::streamsize>(tg.data.size()));
  g4lidar_options options = defaults();
  options.device = raw_.c_str();
  options.model = "tg15";
  for (const bool is_given : {false, true}) {
    options.has_zero_angle = is_given;
    options.zero_angle_cdeg = 12'300;
    g4lidar_lidar* made = nullptr;
    ASSERT_EQ(g4lidar_open_with(&options, &made, &why_), G4LIDAR_OK) << why_.message;
    const lidar it(made);
    ASSERT_EQ(g4lidar_start(made, &why_), G4LIDAR_OK) << why_.message;
    const g4lidar_scan* scan = nullptr;
    ASSERT_EQ(g4lidar_try_scan(made, 1000, &scan, &why_), G4LIDAR_OK) << why_.message;
    EXPECT_NEAR(scan->points[0].angle_deg, is_given ? 123.0F : 0.0F, 0.01F);
    bool is_reported = false;
    g4lidar_event event;
    while (g4lidar_next_event(made, &event) == G4LIDAR_OK) {
      is_reported = is_reported || event.kind == G4LIDAR_EVENT_NO_ZERO_ANGLE;
    }
    EXPECT_EQ(is_reported, !is_given);
  }
  options.zero_angle_cdeg = 36'001;
  g4lidar_lidar* made = nullptr;
  EXPECT_EQ(g4lidar_open_with(&options, &made, &why_), G4LIDAR_BAD_OPTION);
  options.zero_angle_cdeg = 0;
  options.model = "g4";
  EXPECT_EQ(g4lidar_open_with(&options, &made, &why_), G4LIDAR_NOT_SUPPORTED);
}

}  // namespace
