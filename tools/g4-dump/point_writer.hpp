// SPDX-License-Identifier: MIT
// Points as text: what all formats have in common, and which there are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "g4lidar/point.hpp"
#include "g4lidar/scan.hpp"
#include "output.hpp"

namespace g4_dump {

enum class text_format : std::uint8_t { csv, jsonl, text };

/// What of the points is written, and how.
struct point_style {
  text_format format = text_format::csv;
  bool scans = false;       ///< A record for each revolution, not for each point.
  bool valid_only = false;  ///< Without the points from which nothing came back.
  std::uint32_t rate_hz = 9000;

  [[nodiscard]] bool leaves_out(const g4lidar::point& p) const noexcept {
    return valid_only && p.is_no_return();
  }
};

/// Writes records to an output. It takes packets or revolutions, one of the two.
class point_writer {
 public:
  point_writer() = default;
  point_writer(const point_writer&) = delete;
  point_writer& operator=(const point_writer&) = delete;
  virtual ~point_writer() = default;

  [[nodiscard]] virtual bool takes_scans() const noexcept = 0;
  /// What stands before the first record. Called once, when the first packet has come.
  virtual void begin(output&) {}
  /// The points of one packet.
  virtual void write_points(std::span<const g4lidar::point>, output&) {}
  /// A revolution, or a piece of one. Its points' times are as the style's rate makes them.
  virtual void write_scan(const g4lidar::scan&, output&) {}
};

[[nodiscard]] std::unique_ptr<point_writer> make_csv_writer(const point_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_jsonl_writer(const point_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_text_writer(const point_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_point_writer(const point_style& style);

}  // namespace g4_dump
