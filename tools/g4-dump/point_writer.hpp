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
#include "point_style.hpp"

namespace g4_dump {

/// A revolution as it is to be written, and what is known of it whichever of its points are left.
struct shown_scan {
  g4lidar::scan scan;        ///< With the points that are written.
  std::int64_t time_ns = 0;  ///< Of its first point, whether that is written or not.
  double measured_hz = 0.0;  ///< Of the rotation; 0 where it cannot be told.
};

/// Writes records to an output. It takes packets or revolutions, one of the two.
class point_writer {
 public:
  point_writer() = default;
  point_writer(const point_writer&) = delete;
  point_writer& operator=(const point_writer&) = delete;
  virtual ~point_writer() = default;

  /// The most points that write_points() is given at once.
  static constexpr std::size_t max_points = 512;

  [[nodiscard]] virtual bool takes_scans() const noexcept = 0;
  /// What stands before the first record. Called once, when the first packet has come.
  virtual void begin(output&) {}
  /// The points of one packet, or of several.
  virtual void write_points(std::span<const g4lidar::point>, output&) {}
  /// A revolution, or a piece of one.
  virtual void write_scan(const shown_scan&, output&) {}
};

[[nodiscard]] std::unique_ptr<point_writer> make_csv_writer(const point_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_jsonl_writer(const point_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_text_writer(const point_style& style);
[[nodiscard]] std::unique_ptr<point_writer> make_point_writer(const point_style& style);

}  // namespace g4_dump
