// SPDX-License-Identifier: MIT
// The golden vectors of the family, which are not part of the project: packets of every layout with
// their points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/core/ct_information.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "support/reference_points.hpp"

namespace g4lidar {
namespace {

const std::filesystem::path family = G4LIDAR_SOURCE_DIR "/../shared/family";

struct vector_file {
  std::string name;
  std::string model;
};

struct row {
  double angle_deg, range_mm;
  unsigned intensity, flags;
};

std::vector<row> rows_of(const std::string& name) {
  std::ifstream file(family / (name + ".csv"));
  std::vector<row> rows;
  std::string text;
  std::getline(file, text);  // the header
  while (std::getline(file, text)) {
    row r{};
    const int read = std::sscanf(text.c_str(), "%*u,%*u,%lf,%lf,%u,%u", &r.angle_deg, &r.range_mm,
                                 &r.intensity, &r.flags);
    EXPECT_EQ(read, 4) << text;
    rows.push_back(r);
  }
  return rows;
}

/// The packets, one a line.
std::vector<std::vector<std::uint8_t>> packets_of(const std::string& name) {
  std::ifstream file(family / (name + ".hex"));
  std::vector<std::vector<std::uint8_t>> packets;
  for (std::string text; std::getline(file, text);) {
    std::erase_if(text, [](unsigned char c) { return std::isxdigit(c) == 0; });
    if (text.empty()) continue;
    packets.emplace_back();
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
      packets.back().push_back(
          static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
    }
  }
  return packets;
}

class Family : public testing::TestWithParam<vector_file> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(family)) {
      GTEST_SKIP() << "The golden vectors of the family are not at hand: there is no directory "
                      "shared/family beside the project.";
    }
    for (const auto& packet : packets_of(GetParam().name)) {
      data_.insert(data_.end(), packet.begin(), packet.end());
    }
    ASSERT_FALSE(data_.empty());
  }

  const model& model_ = *model_named(GetParam().model);
  std::vector<std::uint8_t> data_;
};

TEST_P(Family, EveryPointIsThatOfTheVector) {
  const std::vector<row> rows = rows_of(GetParam().name);
  ASSERT_FALSE(rows.empty());
  for (const instruction_set set : {instruction_set::portable, best_instruction_set()}) {
    bulk_decoder decoder(model_, set);
    bytes input(data_);
    std::vector<point> memory(rows.size() + max_samples);
    const std::span<point> points = decoder.decode(input, memory);
    ASSERT_EQ(points.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      SCOPED_TRACE(i);
      const row& wanted = rows[i];
      const point& p = points[i];
      EXPECT_EQ(static_cast<double>(p.range_mm), wanted.range_mm);
      EXPECT_EQ(p.is_no_return(), wanted.range_mm == 0.0);
      EXPECT_EQ(p.intensity, wanted.intensity);
      EXPECT_EQ(p.sample_flags, wanted.flags);
      if (wanted.range_mm == 0.0) continue;  // its angle is not corrected there
      EXPECT_LT(reference::apart_deg(static_cast<double>(p.angle_deg), wanted.angle_deg), 0.001);
    }
    EXPECT_EQ(decoder.counts().skipped_bytes(), 0U);
    EXPECT_EQ(decoder.held(), 0U);
  }
}

TEST_P(Family, PiecesOfEverySizeGiveThePackets) {
  const auto packets = packets_of(GetParam().name);
  for (std::size_t piece = 1; piece <= data_.size(); ++piece) {
    stream_parser parser(model_.samples);
    std::size_t next = 0;
    for (std::size_t from = 0; from < data_.size(); from += piece) {
      bytes input = bytes(data_).subspan(from).first(std::min(piece, data_.size() - from));
      while (const auto found = parser.next(input)) {
        const auto* const packet = std::get_if<packet_view>(&*found);
        ASSERT_NE(packet, nullptr);
        ASSERT_LT(next, packets.size());
        ASSERT_TRUE(std::ranges::equal(packet->data(), packets[next++])) << piece;
      }
    }
    ASSERT_EQ(next, packets.size()) << piece;
  }
}

// The information was written by another program; ct-info-synth.txt has its contents.
TEST(FamilyInformation, TheRevolutionIdentifiesItsLidar) {
  std::ifstream file(family / "ct-info-synth.bin", std::ios::binary);
  if (!file) GTEST_SKIP() << "There is no directory shared/family beside the project.";
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::uint8_t> data(text.begin(), text.end());
  stream_parser parser(model_named("x4-pro")->samples);
  ct_information_reader reader;
  int believed = 0;
  bytes input(data);
  while (const auto found = parser.next(input)) {
    if (const auto* packet = std::get_if<packet_view>(&*found)) {
      believed += reader.add(*packet) ? 1 : 0;
    } else if (const auto* gone = std::get_if<skipped>(&*found)) {
      reader.add(*gone);
    }
  }
  EXPECT_EQ(believed, 1);
  ASSERT_TRUE(reader.last());
  EXPECT_EQ(reader.last()->customer, 0x24);
  EXPECT_EQ(reader.last()->faults, ct_faults::sensor);
  EXPECT_EQ(reader.last()->hardware, 2);
  EXPECT_EQ(reader.last()->firmware_major, 1);
  EXPECT_EQ(reader.last()->firmware_minor, 7);
  EXPECT_EQ(reader.last()->id_low_bits, 4);
  const auto& digits = reader.last()->serial_digits;
  EXPECT_EQ(std::string(digits.begin(), digits.end()), "2023031500012345");
}

// The replies of devices, with what stands beside them in the file.
TEST(FamilyReplies, AreReadAsTheyAreDescribed) {
  std::ifstream file(family / "replies.txt");
  if (!file) GTEST_SKIP() << "There is no directory shared/family beside the project.";
  int lines = 0;
  for (std::string text; std::getline(file, text);) {
    if (text.starts_with('#')) continue;
    SCOPED_TRACE(text);
    ++lines;
    std::vector<std::uint8_t> data;
    const std::size_t hex = text.find(" | ");
    const std::string words = text.substr(hex, text.rfind(" | ") - hex);
    for (std::size_t i = 0; i + 1 < hex; i += 2) {
      data.push_back(static_cast<std::uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
    }
    const bool is_angle = words.find("reply to 93") != std::string::npos;
    const auto reply = response_view::from(data, is_angle);
    ASSERT_TRUE(reply);
    unsigned id = 0;
    unsigned major = 0;
    unsigned minor = 0;
    unsigned hardware = 0;
    std::string serial(17, ' ');
    const std::size_t known = words.find(": id ");
    if (known != std::string::npos) {
      ASSERT_EQ(std::sscanf(words.c_str() + known, ": id %u, %u.%u, %u, %16[0-9]", &id, &major,
                            &minor, &hardware, serial.data()),
                5);
      const auto info = reply->as_device_info();
      ASSERT_TRUE(info);
      EXPECT_EQ(info->model, id);
      EXPECT_EQ(info->firmware_major, major);
      EXPECT_EQ(info->firmware_minor, minor);
      EXPECT_EQ(info->hardware, hardware);
      EXPECT_EQ(info->serial_number(), serial.substr(0, 16));
    } else if (words.find("health good") != std::string::npos) {
      EXPECT_EQ(reply->as_health(), (health{health_status::ok, 0}));
    } else if (words.find("scan header") != std::string::npos) {
      EXPECT_EQ(reply->kind(), response_kind::scan_started);
    } else if (words.find("1-byte") != std::string::npos) {
      EXPECT_EQ(reply->as_byte(), 0);
    } else if (is_angle) {
      EXPECT_EQ(reply->as_angle(), 722);
    } else {
      EXPECT_NE(words.find("10.00 Hz"), std::string::npos);
      EXPECT_EQ(reply->as_frequency_chz(), 1000);
    }
  }
  EXPECT_EQ(lines, 11);
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryLayout, Family,
    testing::Values(vector_file{"tri2-real-usv", "x4"}, vector_file{"tri2-flags-synth", "x4-pro"},
                    vector_file{"tri2-half-synth", "g6"}, vector_file{"tri3-i10-synth", "g2"},
                    vector_file{"tri3-i8f2-synth", "s4b"}, vector_file{"scl3-synth", "scl"},
                    vector_file{"tof3-tmini-synth", "t-mini"},
                    vector_file{"coin-d4-real", "t-mini-pro"}, vector_file{"tof2-mm-synth", "tg30"},
                    vector_file{"tof2-real-tg15", "tg15"},
                    vector_file{"tof4-sh-synth", "t-mini-plus-sh"}),
    [](const auto& each) {
      std::string name = each.param.name;
      std::ranges::replace(name, '-', '_');
      return name;
    });

}  // namespace
}  // namespace g4lidar
