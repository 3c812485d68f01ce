// SPDX-License-Identifier: MIT
#include "point_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <string_view>

#include "cloud_point.hpp"
#include "value_text.hpp"

namespace g4_tool {
namespace {

/// `number`, the lowest of `size` bytes first.
std::string little_endian(std::uint64_t number, std::size_t size) {
  std::string text(size, '\0');
  for (char& byte : text) {
    byte = static_cast<char>(number & 0xFFU);
    number >>= 8U;
  }
  return text;
}

/// `text` and blanks up to `size` characters, which is enough for any number in it.
std::string padded(std::string text, std::size_t size) {
  text.resize(size, ' ');
  return text;
}

// ---- NumPy -------------------------------------------------------------------------------------

/// A point of the array has the layout of point.
constexpr std::size_t npy_point_size = 24;
static_assert(sizeof(point) == npy_point_size);

/// The header of an array of `count` points, format version 1.0: always 256 bytes.
std::string npy_header(std::uint64_t count) {
  constexpr std::size_t size = 256;
  const std::string begin = std::string("\x93NUMPY\x01\x00", 8) + little_endian(size - 10, 2);
  const std::string fields =
      "{'descr': [('angle_deg', '<f4'), ('range_mm', '<f4'), ('time_ns', '<i8'), ('revolution', "
      "'<u4'), ('flags', '|u1'), ('sample_flags', '|u1'), ('intensity', '<u2')], "
      "'fortran_order': False, 'shape': (" +
      std::to_string(count) + ",)}";
  return padded(begin + fields, size - 1) + '\n';
}

char* put_npy_point(char* out, const point& p) noexcept {
  out = put_little_endian(out, p.angle_deg);
  out = put_little_endian(out, p.range_mm);
  out = put_little_endian(out, p.time_ns);
  out = put_little_endian(out, p.revolution);
  out = put_little_endian(out, p.flags);
  out = put_little_endian(out, p.sample_flags);
  return put_little_endian(out, p.intensity);
}

class npy_writer : public point_file_writer {
 public:
  void begin(text_sink& out) override { out.write(first_bytes()); }

  void write_points(std::span<const point> points, text_sink& out) override {
    while (!points.empty()) {
      const auto some = points.first(std::min(points.size(), text_sink::max_room / npy_point_size));
      const std::size_t size = some.size() * npy_point_size;
      char* const room = out.room(size);
      char* at = room;
      for (const point& p : some) at = put_npy_point(at, p);
      wrote({room, size});
      out.wrote(at);
      count_ += some.size();
      points = points.subspan(some.size());
    }
  }

  void end(text_sink&) override {}
  [[nodiscard]] std::string first_bytes() const override { return npy_header(count_); }

 protected:
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  /// These bytes of points were written.
  virtual void wrote(std::string_view) {}

  std::uint64_t count_ = 0;
};

// ---- ZIP ---------------------------------------------------------------------------------------

/// The CRC-32 of what had the sum `before`, and then `data`.
std::uint32_t crc32_of(std::string_view data, std::uint32_t before = 0) noexcept {
  // Without an address zlib begins anew.
  if (data.empty()) return before;
  const auto* const first = reinterpret_cast<const Bytef*>(data.data());
  return static_cast<std::uint32_t>(::crc32_z(before, first, data.size()));
}

/// A ZIP file with one stored entry, with 64-bit sizes as NumPy writes them.
class npz_writer final : public npy_writer {
 public:
  void end(text_sink& out) override {
    const std::string directory = "PK\x01\x02" + std::string("\x2d\x03", 2) + entry() +
                                  little_endian(20, 2) + std::string(14, '\0') + std::string(name) +
                                  sizes();
    const std::uint64_t offset =
        npy_writer::first_bytes().size() + local_header().size() + points_size();
    out.write(directory);
    out.write("PK\x06\x06" + little_endian(44, 8) + little_endian(45, 2) + little_endian(45, 2) +
              std::string(8, '\0') + little_endian(1, 8) + little_endian(1, 8) +
              little_endian(directory.size(), 8) + little_endian(offset, 8));
    out.write("PK\x06\x07" + std::string(4, '\0') + little_endian(offset + directory.size(), 8) +
              little_endian(1, 4));
    out.write("PK\x05\x06" + std::string(4, '\0') + little_endian(1, 2) + little_endian(1, 2) +
              std::string(8, '\xff') + std::string(2, '\0'));
  }

  [[nodiscard]] std::string first_bytes() const override {
    return local_header() + npy_writer::first_bytes();
  }

 private:
  static constexpr std::string_view name = "points.npy";

  void wrote(std::string_view text) override { sum_ = crc32_of(text, sum_); }

  [[nodiscard]] std::uint64_t points_size() const noexcept { return count() * npy_point_size; }

  /// The sizes of the entry, as an extra field of 20 bytes.
  [[nodiscard]] std::string sizes() const {
    const std::uint64_t size = npy_writer::first_bytes().size() + points_size();
    return little_endian(1, 2) + little_endian(16, 2) + little_endian(size, 8) +
           little_endian(size, 8);
  }

  /// What both headers of the entry contain: version 4.5, no flags, stored, 1980-01-01, sum, sizes in the extra field,
  /// length of the name.
  [[nodiscard]] std::string entry() const {
    const std::uint32_t header = crc32_of(npy_writer::first_bytes());
    const auto sum = static_cast<std::uint32_t>(
        ::crc32_combine(header, sum_, static_cast<z_off_t>(points_size())));
    return little_endian(45, 2) + std::string(4, '\0') + little_endian(0, 2) +
           little_endian(0x21, 2) + little_endian(sum, 4) + std::string(8, '\xff') +
           little_endian(name.size(), 2);
  }

  [[nodiscard]] std::string local_header() const {
    return "PK\x03\x04" + entry() + little_endian(20, 2) + std::string(name) + sizes();
  }

  std::uint32_t sum_ = 0;  // of the points
};

// ---- PLY and plain coordinates -------------------------------------------------------------------

class ply_writer final : public point_file_writer {
 public:
  ply_writer(frame to, const model& model)
      : to_(to), turn_deg_(model.turn_deg), has_intensity_(has_intensity(model)) {}

  void begin(text_sink& out) override { out.write(first_bytes()); }

  void write_points(std::span<const point> points, text_sink& out) override {
    constexpr std::size_t vertex_size = 6 * sizeof(float) + sizeof(double) + sizeof(std::uint32_t);
    for (const point& p : points) {
      if (p.is_no_return()) continue;
      const cloud_point v = in_cloud(p, to_, turn_deg_);
      char* at = out.room(vertex_size);
      for (const float field : {v.x_m, v.y_m, 0.0F, v.range_m, v.angle_deg}) {
        at = put_little_endian(at, field);
      }
      at = put_little_endian(at, static_cast<double>(p.time_ns) * 1e-9);
      at = put_little_endian(at, p.revolution);
      if (has_intensity_) at = put_little_endian(at, static_cast<float>(p.intensity));
      out.wrote(at);
      ++count_;
    }
  }

  void end(text_sink&) override {}

  [[nodiscard]] std::string first_bytes() const override {
    return "ply\nformat binary_little_endian 1.0\nelement vertex " +
           padded(std::to_string(count_), 20) +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty float range_m\n"
           "property float angle_deg\nproperty double time_s\nproperty uint revolution\n" +
           (has_intensity_ ? "property float intensity\n" : "") + "end_header\n";
  }

 private:
  frame to_;
  std::uint16_t turn_deg_;
  bool has_intensity_;
  std::uint64_t count_ = 0;
};

class xyz_writer final : public point_file_writer {
 public:
  xyz_writer(frame to, std::uint16_t turn_deg) : to_(to), turn_deg_(turn_deg) {}

  void write_points(std::span<const point> points, text_sink& out) override {
    for (const point& p : points) {
      if (p.is_no_return()) continue;
      const cloud_point v = in_cloud(p, to_, turn_deg_);
      out.write(shortest(v.x_m) + " " + shortest(v.y_m) + " 0\n");
    }
  }

  void end(text_sink&) override {}
  [[nodiscard]] std::string first_bytes() const override { return {}; }

 private:
  frame to_;
  std::uint16_t turn_deg_;
};

}  // namespace

std::unique_ptr<point_file_writer> make_point_file_writer(point_file_format format, frame to,
                                                          const model& model) {
  switch (format) {
    case point_file_format::npy:
      return std::make_unique<npy_writer>();
    case point_file_format::npz:
      return std::make_unique<npz_writer>();
    case point_file_format::ply:
      return std::make_unique<ply_writer>(to, model);
    case point_file_format::xyz:
      break;
  }
  return std::make_unique<xyz_writer>(to, model.turn_deg);
}

}  // namespace g4_tool
