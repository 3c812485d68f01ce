// SPDX-License-Identifier: MIT
#include "pcd_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "digits.hpp"
#include "g4lidar/angle.hpp"
#include "g4lidar/bytes.hpp"
#include "values.hpp"

namespace g4_dump {
namespace {

/// A point of the cloud, as it lies in a binary file but for the order of the bytes.
struct cloud_point {
  float x_m;
  float y_m;
  float range_m;
  float angle_deg;
  std::int64_t time_ns;
};

cloud_point in_cloud(const g4lidar::point& p, g4lidar::frame frame) noexcept {
  const g4lidar::sine_cosine way = g4lidar::sine_cosine_deg(p.angle_deg);
  const float range_m = p.range_mm / 1000.0F;
  const bool is_signed = frame == g4lidar::frame::robot && p.angle_deg >= 180.0F;
  return {range_m * way.cosine, range_m * way.sine, range_m,
          is_signed ? p.angle_deg - 360.0F : p.angle_deg, p.time_ns};
}

template <class Word>
char* put_little(char* at, Word word) noexcept {
  for (std::size_t i = 0; i < sizeof word; ++i) {
    *at++ = static_cast<char>(static_cast<unsigned char>(word & 0xFFU));
    word = static_cast<Word>(word >> 8U);
  }
  return at;
}

char* put_binary(char* at, const cloud_point& p) noexcept {
  for (const float field : {p.x_m, p.y_m, 0.0F, p.range_m, p.angle_deg}) {
    at = put_little(at, std::bit_cast<std::uint32_t>(field));
  }
  return put_little(at, static_cast<std::uint64_t>(p.time_ns));
}

char* put_ascii(char* at, const cloud_point& p) {
  return fmt::format_to(at, "{} {} 0 {} {} {}\n", p.x_m, p.y_m, p.range_m, p.angle_deg, p.time_ns);
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

void write_pcd(std::span<const g4lidar::point> points, g4lidar::frame frame, pcd_data data,
               output& out) {
  const auto count = std::count_if(points.begin(), points.end(),
                                   [](const g4lidar::point& p) { return !p.is_no_return(); });
  const bool is_binary = data == pcd_data::binary;
  out.write(
      fmt::format("# .PCD v0.7 - Point Cloud Data file format\n"
                  "VERSION 0.7\n"
                  "FIELDS x y z range_m angle_deg time_ns\n"
                  "SIZE 4 4 4 4 4 8\n"
                  "TYPE F F F F F I\n"
                  "COUNT 1 1 1 1 1 1\n"
                  "WIDTH {0}\n"
                  "HEIGHT 1\n"
                  "VIEWPOINT 0 0 0 1 0 0 0\n"
                  "POINTS {0}\n"
                  "DATA {1}\n",
                  count, is_binary ? "binary" : "ascii"));
  for (const g4lidar::point& p : points) {
    if (p.is_no_return()) continue;
    const cloud_point shown = in_cloud(p, frame);
    char* const at = out.room(256);
    out.wrote(is_binary ? put_binary(at, shown) : put_ascii(at, shown));
  }
}

std::optional<numbered_files> numbered_files::from(const std::string& name) {
  numbered_files files;
  std::error_code unknown;
  if (name.ends_with('/') || std::filesystem::is_directory(name, unknown)) {
    files.before_ = name + (name.ends_with('/') ? "scan-" : "/scan-");
    files.width_ = 6;
    files.after_ = ".pcd";
    return files;
  }
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return std::nullopt;
  std::size_t end = percent + 1;
  while (end < name.size() && is_digit(name[end])) ++end;
  const std::string width = name.substr(percent + 1, end - percent - 1);
  const bool has_end = end < name.size() && (name[end] == 'd' || name[end] == 'u');
  if (!has_end || name.find('%', end) != std::string::npos ||
      (!width.empty() && width.front() != '0')) {
    throw bad_value(fmt::format("'{}' has no single number such as %d or %04d", name));
  }
  files.before_ = name.substr(0, percent);
  if (!width.empty()) files.width_ = number_of(width, 0, 20);
  files.after_ = name.substr(end + 1);
  return files;
}

std::string numbered_files::name_of(std::uint64_t number) const {
  return fmt::format("{}{:0{}}{}", before_, number, width_, after_);
}

namespace {

class pcd_writer final : public point_writer {
 public:
  pcd_writer(g4lidar::frame frame, pcd_data data, const std::optional<numbered_files>& files)
      : frame_(frame), data_(data), files_(files) {}

  [[nodiscard]] bool takes_scans() const noexcept override { return true; }

  void write_scan(const shown_scan& shown, output& out) override {
    if (!files_) return write_pcd(shown.scan.points, frame_, data_, out);
    output file(files_->name_of(number_++));
    write_pcd(shown.scan.points, frame_, data_, file);
    file.commit();
  }

 private:
  g4lidar::frame frame_;
  pcd_data data_;
  std::optional<numbered_files> files_;
  std::uint64_t number_ = 0;
};

}  // namespace

std::unique_ptr<point_writer> make_pcd_writer(g4lidar::frame frame, pcd_data data,
                                              const std::optional<numbered_files>& files) {
  return std::make_unique<pcd_writer>(frame, data, files);
}

}  // namespace g4_dump
