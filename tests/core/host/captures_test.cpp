// SPDX-License-Identifier: MIT
// Recorded bytes of real devices, where they are available: every point compared with an
// independently decoded table, and the revolutions of a real motor.
#include <gtest/gtest.h>

#include <array>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "g4lidar/core/correction.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/recording/bulk_decoder.hpp"
#include "support/reference_points.hpp"
#include "support/scan_cutter.hpp"

namespace g4lidar {
namespace {

const std::filesystem::path captures = G4LIDAR_SOURCE_DIR "/../shared/captures";
const std::filesystem::path family = G4LIDAR_SOURCE_DIR "/../shared/family";

/// A point of the table.
struct row {
  std::size_t packet_offset;
  unsigned ct, samples, i, raw;
  double range_mm, first_level_deg, angle_deg;
};

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<row> rows_of(const std::string& name) {
  std::ifstream file(captures / name);
  std::vector<row> rows;
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    row r{};
    const int read =
        std::sscanf(line.c_str(), "%zu,%u,%u,%u,%u,%lf,%lf,%lf", &r.packet_offset, &r.ct,
                    &r.samples, &r.i, &r.raw, &r.range_mm, &r.first_level_deg, &r.angle_deg);
    EXPECT_EQ(read, 8) << line;
    rows.push_back(r);
  }
  return rows;
}

class CapturedFiles : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(captures)) {
      GTEST_SKIP() << "The recorded bytes are not at hand: there is no directory shared/captures "
                      "beside the project. They belong to third parties and are not part of it.";
    }
  }
};

class Captures : public CapturedFiles, public testing::WithParamInterface<std::string> {};

template <class Form>
void expect_the_table(const std::string& name, const Form& form) {
  const std::vector<std::uint8_t> data = bytes_of(captures / (name + ".bin"));
  const std::vector<row> rows = rows_of(name + ".points.csv");
  ASSERT_FALSE(data.empty());
  ASSERT_FALSE(rows.empty());
  stream_parser parser;
  bytes input(data);
  std::size_t next = 0;
  while (const auto found = parser.next(input)) {
    const auto* const packet = std::get_if<packet_view>(&*found);
    if (packet == nullptr) continue;
    std::array<point, max_samples> out;
    const decoded got = decode(*packet, form, 0, out);
    ASSERT_FALSE(got.suspect);
    const auto offset = static_cast<std::size_t>(packet->data().data() - data.data());
    for (std::size_t i = 0; i < got.points.size(); ++i) {
      ASSERT_LT(next, rows.size());
      const row& expected = rows[next++];
      const point& p = got.points[i];
      ASSERT_EQ(offset, expected.packet_offset);
      ASSERT_EQ(packet->ct(), expected.ct);
      ASSERT_EQ(got.points.size(), expected.samples);
      ASSERT_EQ(i, expected.i);
      ASSERT_EQ(packet->sample(i), expected.raw);
      // The table has the quarters of a millimetre also where the sample is only flags.
      const bool no_return = reference::is_no_return(expected.raw);
      ASSERT_EQ(static_cast<double>(p.range_mm), no_return ? 0.0 : expected.range_mm);
      ASSERT_GE(p.angle_deg, 0.0F);
      ASSERT_LT(p.angle_deg, 360.0F);
      // The table has no correction for a sample of 0, and that of a range for 1 to 3.
      const double wanted_deg =
          no_return ? expected.first_level_deg - 7.9905963 : expected.angle_deg;
      ASSERT_LT(reference::apart_deg(static_cast<double>(p.angle_deg), wanted_deg), 0.001)
          << name << ", packet at " << offset << ", sample " << i;
      ASSERT_LT(
          reference::apart_deg(static_cast<double>(raw_angle_deg(p)), expected.first_level_deg),
          0.001);
      ASSERT_EQ(p.is_no_return(), no_return);
    }
  }
  EXPECT_EQ(next, rows.size());
}

TEST_P(Captures, EveryPointAgreesWithTheTable) {
  expect_the_table(GetParam(), exact_correction{});
  expect_the_table(GetParam(), compact_correction{});
  expect_the_table(GetParam(), *std::make_unique<table_correction>());
}

INSTANTIATE_TEST_SUITE_P(OfRealDevices, Captures,
                         testing::Values("x4_scan1", "x4_stream", "x2_packet"),
                         [](const auto& name) { return name.param; });

/// A point of the family's golden vectors; its angle is not corrected if it has no range.
struct family_row {
  double angle_deg, range_mm;
  unsigned flags;
};

std::vector<family_row> family_rows_of(const std::string& name) {
  std::ifstream file(family / (name + ".csv"));
  std::vector<family_row> rows;
  std::string line;
  std::getline(file, line);  // the header
  while (std::getline(file, line)) {
    family_row r{};
    const int read =
        std::sscanf(line.c_str(), "%*u,%*u,%lf,%lf,%*u,%u", &r.angle_deg, &r.range_mm, &r.flags);
    EXPECT_EQ(read, 3) << line;
    rows.push_back(r);
  }
  return rows;
}

std::vector<std::uint8_t> bytes_of_hex(const std::string& name) {
  std::ifstream file(family / (name + ".hex"));
  std::vector<std::uint8_t> all;
  std::string digits;
  for (char c = 0; file.get(c);) {
    if (std::isxdigit(static_cast<unsigned char>(c)) == 0) continue;
    digits += c;
    if (digits.size() < 2) continue;
    all.push_back(static_cast<std::uint8_t>(std::stoi(digits, nullptr, 16)));
    digits.clear();
  }
  return all;
}

class FamilyVectors : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(family)) {
      GTEST_SKIP() << "The golden vectors of the family are not at hand: there is no directory "
                      "shared/family beside the project.";
    }
  }
};

// The vectors give ranges without the two bits of flags; a G4's keep them as quarters.
TEST_P(FamilyVectors, SamplesOfFlagsAreNoReturns) {
  const std::vector<family_row> rows = family_rows_of(GetParam());
  const std::vector<std::uint8_t> data = bytes_of_hex(GetParam());
  ASSERT_FALSE(rows.empty());
  const auto expect_rows = [&](std::span<const point> points) {
    ASSERT_EQ(points.size(), rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const family_row& expected = rows[i];
      const point& p = points[i];
      SCOPED_TRACE(i);
      EXPECT_EQ(p.is_no_return(), expected.range_mm == 0.0);
      if (expected.range_mm == 0.0) {
        EXPECT_EQ(p.range_mm, 0.0F);
        continue;
      }
      EXPECT_EQ(static_cast<double>(p.range_mm), expected.range_mm + expected.flags / 4.0);
      EXPECT_LT(reference::apart_deg(static_cast<double>(p.angle_deg), expected.angle_deg),
                expected.flags == 0 ? 0.001 : 0.08);
    }
  };
  for (const instruction_set set : {instruction_set::portable, best_instruction_set()}) {
    bulk_decoder decoder(set);
    bytes input(data);
    std::vector<point> points(rows.size() + max_samples);
    expect_rows(decoder.decode(input, points));
    EXPECT_EQ(decoder.counts().skipped_bytes(), 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(OfTwoByteSamples, FamilyVectors,
                         testing::Values("tri2-flags-synth", "tri2-real-usv"),
                         [](const auto& name) {
                           return name.param == "tri2-real-usv" ? "Real" : "WithFlags";
                         });

/// Parses and counts; passes all packets to `cutter`.
stream_counter counts_of(const std::vector<std::uint8_t>& data, test::scan_cutter& cutter) {
  stream_parser parser;
  stream_counter counts;
  const auto take = [&](const event& found) {
    counts.add(found);
    if (const auto* packet = std::get_if<packet_view>(&found)) {
      if (counts.crc.last() == ct_check::result::mismatch) cutter.crc_mismatch();
      cutter.feed(*packet);
    }
    if (const auto* gone = std::get_if<skipped>(&found)) cutter.add(*gone);
  };
  parser.feed(data, take);
  while (const auto found = parser.finish()) take(*found);
  EXPECT_EQ(counts.parsed_bytes + counts.skipped_bytes(), data.size());
  cutter.finish();
  return counts;
}
stream_counter counts_of(const std::string& name, test::scan_cutter& cutter) {
  return counts_of(bytes_of(captures / name), cutter);
}

class FamilyStream : public FamilyVectors {};

// One revolution of 22 packets of 47 bytes and the CRC of its CT bytes, repeated; the last packet
// of the fifth is missing.
TEST_P(FamilyStream, CrcOfTheRevolutions_ShowsALostPacket) {
  const std::vector<std::uint8_t> whole = bytes_of(family / GetParam());
  ASSERT_GT(whole.size(), 12U);
  constexpr std::uint8_t crc = 0x93;
  ASSERT_EQ(whole[whole.size() - 13], crc);
  const auto revolution_end = whole.end() - 12;  // the next zero packet
  std::vector<std::uint8_t> data;
  for (int i = 0; i < 6; ++i) {
    data.insert(data.end(), whole.begin(), revolution_end);
    if (i != 4) continue;
    const bytes bytes_now(data);
    std::size_t start = data.size() - 3;
    while (load_u16(bytes_now, start) != 0x55AA) --start;
    data.erase(data.begin() + static_cast<std::ptrdiff_t>(start), data.end() - 1);
  }
  data.insert(data.end(), revolution_end, whole.end());
  test::scan_cutter cutter(4000);
  const stream_counter counts = counts_of(data, cutter);
  EXPECT_EQ(counts.crc_matches, 3U);  // the third, the fourth and the last
  EXPECT_EQ(counts.crc_mismatches, 1U);
  ASSERT_EQ(cutter.scans().size(), 7U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(cutter.scans()[i].view.has(scan_flags::crc_mismatch), i == 4) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(OfCtInformation, FamilyStream, testing::Values("ct-info-synth.bin"),
                         [](const auto&) { return "Synthetic"; });

TEST_F(CapturedFiles, X4ScanHasItsPacketsPointsAndRevolutions) {
  test::scan_cutter cutter(4000);
  const stream_counts counts = counts_of("x4_scan1.bin", cutter);
  EXPECT_EQ(counts.packets, 455U);
  EXPECT_EQ(counts.points, 16'721U);
  EXPECT_EQ(counts.suspect, 0U);
  EXPECT_EQ(counts.responses, 1U);
  EXPECT_EQ(counts.skipped(skip_reason::truncated), 75U);
  EXPECT_EQ(counts.crc_matches + counts.crc_mismatches, 0U) << "this device sends no CRC";
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
  // 28 zero packets: a first piece, 27 whole revolutions, and a last piece.
  ASSERT_EQ(cutter.scans().size(), 29U);
  EXPECT_EQ(cutter.scans().front().view.flags, scan_flags::start_missing);
  EXPECT_TRUE(cutter.scans().back().view.has(scan_flags::end_missing));
  for (std::size_t i = 1; i + 1 < cutter.scans().size(); ++i) {
    const scan& revolution = cutter.scans()[i].view;
    EXPECT_TRUE(revolution.is_whole()) << "revolution " << i;
    // The limits of one degree over and ten degrees under a turn were derived from this.
    EXPECT_NEAR(revolution.turned_deg, 360.0F, 0.5F) << "revolution " << i;
    EXPECT_EQ(revolution.revolution, i);
  }
}

TEST_F(CapturedFiles, X4StreamPassesZeroOnce) {
  test::scan_cutter cutter(4000);
  const stream_counts counts = counts_of("x4_stream.bin", cutter);
  EXPECT_EQ(counts.packets, 21U);
  EXPECT_EQ(counts.suspect, 0U);
  EXPECT_EQ(counts.points, rows_of("x4_stream.points.csv").size());
  EXPECT_EQ(cutter.scans().size(), 2U);
  EXPECT_EQ(cutter.came_out(), cutter.put_in());
}

TEST_F(CapturedFiles, X2PacketWithUpperBitsInCt_IsNoZeroPacket) {
  test::scan_cutter cutter(100);
  EXPECT_EQ(counts_of("x2_packet.bin", cutter).points, 40U);
  ASSERT_EQ(cutter.scans().size(), 1U);
  EXPECT_TRUE(cutter.scans()[0].view.has(scan_flags::start_missing));
  EXPECT_EQ(cutter.scans()[0].view.reported_frequency_chz, 0);
}

TEST_F(CapturedFiles, VendorsZeroPacket_IsOnePointWithoutReturn) {
  test::scan_cutter cutter(100);
  EXPECT_EQ(counts_of("zero_packet.bin", cutter).packets, 1U);
  ASSERT_EQ(cutter.put_in().size(), 1U);
  const point& only = cutter.put_in()[0];
  EXPECT_TRUE(only.is_no_return());
  EXPECT_TRUE(only.is_revolution_start());
  EXPECT_FLOAT_EQ(only.angle_deg, 348.640625F - 7.9905963F);
  EXPECT_NEAR(raw_angle_deg(only), 348.640625F, 1e-4F);
}

}  // namespace
}  // namespace g4lidar
