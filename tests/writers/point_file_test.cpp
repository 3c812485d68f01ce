// SPDX-License-Identifier: MIT
// All points in one file: each byte of small files, written by hand after the specifications of the formats. Files
// with many points are read by NumPy and plyfile in scripts/ci/foreign-readers.
#include <gmock/gmock.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "export/point_file.hpp"

namespace g4lidar {
namespace {

using namespace g4_tool;
using testing::HasSubstr;
using testing::StartsWith;

std::vector<point> three_points() {
  point first;
  first.angle_deg = 90.0F;
  first.range_mm = 2000.0F;
  first.time_ns = 0x0102030405060708;
  first.revolution = 7;
  first.flags = point_flags::revolution_start;
  point none;
  none.angle_deg = 100.0F;
  none.time_ns = -1;
  none.revolution = 7;
  none.flags = point_flags::no_return;
  point last;
  last.angle_deg = 180.0F;
  last.range_mm = 500.5F;
  last.time_ns = 1'500'000'000;
  last.revolution = 8;
  return {first, none, last};
}

/// The file of these points, written in pieces of `step`.
std::string file(point_file_format format, const std::vector<point>& points, std::size_t step = 1,
                 frame to = frame::robot) {
  std::string all;
  callback_sink sink([&](std::string_view text) { all += text; });
  const auto writer = make_point_file_writer(format, to);
  writer->begin(sink);
  for (std::size_t i = 0; i < points.size(); i += step) {
    writer->write_points(std::span(points).subspan(i, std::min(step, points.size() - i)), sink);
  }
  writer->end(sink);
  sink.flush();
  const std::string begin = writer->first_bytes();
  return begin + all.substr(begin.size());
}

constexpr std::size_t npy_header_size = 256;
constexpr std::string_view npy_points{
    "\x00\x00\xb4\x42\x00\x00\xfa\x44\x08\x07\x06\x05\x04\x03\x02\x01\x07\x00\x00\x00\x04\x00\x00"
    "\x00"
    "\x00\x00\xc8\x42\x00\x00\x00\x00\xff\xff\xff\xff\xff\xff\xff\xff\x07\x00\x00\x00\x01\x00\x00"
    "\x00"
    "\x00\x00\x34\x43\x00\x40\xfa\x43\x00\x2f\x68\x59\x00\x00\x00\x00\x08\x00\x00\x00\x00\x00\x00"
    "\x00",
    72};

TEST(PointFile, Npy_HasEveryByteOfTheSpecification) {
  const std::string npy = file(point_file_format::npy, three_points());
  ASSERT_EQ(npy.size(), npy_header_size + 72);
  EXPECT_EQ(npy.substr(0, 10), std::string("\x93NUMPY\x01\x00\xf6\x00", 10));
  const std::string header = npy.substr(10, npy_header_size - 10);
  EXPECT_THAT(
      header,
      StartsWith("{'descr': [('angle_deg', '<f4'), ('range_mm', '<f4'), ('time_ns', '<i8'), "
                 "('revolution', '<u4'), ('flags', '|u1'), "
                 "('sample_flags', '|u1'), ('intensity', '<u2')], 'fortran_order': False, 'shape': "
                 "(3,)} "));
  EXPECT_EQ(header.back(), '\n');
  EXPECT_EQ(npy.substr(npy_header_size), npy_points);
  EXPECT_EQ(file(point_file_format::npy, three_points(), 3), npy) << "in one piece";
}

TEST(PointFile, NoPoint_IsAnEmptyArrayAndNoVertex) {
  EXPECT_THAT(file(point_file_format::npy, {}), HasSubstr("'shape': (0,)"));
  EXPECT_THAT(file(point_file_format::ply, {}), HasSubstr("\nelement vertex 0 "));
  EXPECT_EQ(file(point_file_format::xyz, {}), "");
}

/// The number of `size` bytes at `at`, the lowest byte first.
std::uint64_t number_at(const std::string& text, std::size_t at, std::size_t size) {
  std::uint64_t number = 0;
  for (std::size_t i = size; i > 0; --i)
    number = number << 8U | static_cast<std::uint8_t>(text.at(at + i - 1));
  return number;
}

/// The sum of ZIP, bit by bit.
std::uint32_t sum_of(std::string_view text) {
  std::uint32_t sum = 0xFFFFFFFFU;
  for (const char byte : text) {
    sum ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1U) ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~sum;
}

void expect_zip_of(const std::string& npz, const std::string& npy) {
  constexpr std::size_t local_size = 30 + 10 + 20;
  ASSERT_GT(npz.size(), local_size + npy.size());
  EXPECT_EQ(npz.substr(0, 4), "PK\x03\x04");
  EXPECT_EQ(number_at(npz, 8, 2), 0U) << "stored";
  EXPECT_EQ(number_at(npz, 14, 4), sum_of(npy));
  EXPECT_EQ(number_at(npz, 26, 2), 10U);
  EXPECT_EQ(number_at(npz, 28, 2), 20U);
  EXPECT_EQ(npz.substr(30, 10), "points.npy");
  EXPECT_EQ(number_at(npz, 44, 8), npy.size());
  EXPECT_EQ(number_at(npz, 52, 8), npy.size());
  EXPECT_EQ(npz.substr(local_size, npy.size()), npy);
  const std::size_t directory = local_size + npy.size();
  EXPECT_EQ(npz.substr(directory, 4), "PK\x01\x02");
  EXPECT_EQ(number_at(npz, directory + 16, 4), sum_of(npy));
  EXPECT_EQ(number_at(npz, directory + 42, 4), 0U) << "the entry is at the begin of the file";
  const std::size_t end_64 = directory + 46 + 10 + 20;
  EXPECT_EQ(npz.substr(end_64, 4), "PK\x06\x06");
  EXPECT_EQ(number_at(npz, end_64 + 4, 8), 44U);
  EXPECT_EQ(number_at(npz, end_64 + 40, 8), end_64 - directory);
  EXPECT_EQ(number_at(npz, end_64 + 48, 8), directory);
  EXPECT_EQ(npz.substr(end_64 + 56, 4), "PK\x06\x07");
  EXPECT_EQ(number_at(npz, end_64 + 64, 8), end_64);
  EXPECT_EQ(npz.substr(end_64 + 76, 4), "PK\x05\x06");
  EXPECT_EQ(npz.size(), end_64 + 76 + 22);
}

TEST(PointFile, Npz_HoldsTheArrayWithItsSum) {
  std::vector<point> many;
  for (int i = 0; i < 5000; ++i) many.push_back(three_points()[static_cast<std::size_t>(i % 3)]);
  for (const auto& points : {std::vector<point>{}, three_points(), many}) {
    expect_zip_of(file(point_file_format::npz, points, 1000), file(point_file_format::npy, points));
  }
}

TEST(PointFile, Ply_HasTheReturnsAsVertices) {
  const std::string ply = file(point_file_format::ply, three_points());
  const std::string end = "end_header\n";
  const std::size_t header = ply.find(end);
  ASSERT_NE(header, std::string::npos);
  EXPECT_THAT(ply, StartsWith("ply\nformat binary_little_endian 1.0\nelement vertex 2 "));
  const std::string vertices = ply.substr(header + end.size());
  ASSERT_EQ(vertices.size(), 2U * 32);
  // Left of the robot: y is 2 m. All fields but x, which is 0 except for rounding.
  EXPECT_EQ(vertices.substr(4, 16),
            std::string("\x00\x00\x00\x40\x00\x00\x00\x00\x00\x00\x00\x40\x00\x00\xb4\x42", 16));
  EXPECT_EQ(number_at(vertices, 28, 4), 7U);
  // Ahead of it: x is 0.5005 m, and the time 1.5 s.
  EXPECT_EQ(number_at(vertices, 32, 4), 0x3f0020c5U);
  EXPECT_EQ(number_at(vertices, 52, 8), 0x3ff8000000000000U);
}

TEST(PointFile, Xyz_HasALineForEachReturnInMetres) {
  const std::string xyz = file(point_file_format::xyz, three_points(), 2, frame::vendor);
  EXPECT_THAT(xyz, testing::ContainsRegex("^[-e.0-9]+ 2 0\n-0.5005 [-e.0-9]+ 0\n$"));
}

}  // namespace
}  // namespace g4lidar
