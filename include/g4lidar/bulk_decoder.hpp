// SPDX-License-Identifier: MIT
// Bytes to points in bulk: recordings and pipes read as fast as the processor can, in one object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/bytes.hpp"
#include "g4lidar/cartesian.hpp"
#include "g4lidar/decode.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/stream_counts.hpp"
#include "g4lidar/stream_parser.hpp"

namespace g4lidar {

/// What a bulk_decoder computes with.
enum class instruction_set : std::uint8_t {
  portable,  ///< What the compiler makes of plain C++.
  avx2,      ///< AVX2 and FMA, on x86-64.
};

/// The best of them that this processor has. *Pure*, for the answer never changes while a program
/// runs; not `constexpr`, for the compiler does not know where that will be.
[[nodiscard]] G4LIDAR_API instruction_set best_instruction_set() noexcept;

/// The name of an instruction set, for people; it lives for ever. *Pure*; not `constexpr`, for it is
/// compiled with the rest.
[[nodiscard]] G4LIDAR_API const char* name_of(instruction_set set) noexcept;

/// The whole way from bytes to points: a stream_parser, the count of revolutions and the arithmetic,
/// which is chosen by the processor at run time. *Single thread, never allocates.* Times are left 0,
/// not known.
///
/// The points are those of decode() with any correction form: the angles within 4e-5 degrees of the
/// exact one whatever the instruction set, everything else identical.
class G4LIDAR_API bulk_decoder {
 public:
  /// Computes with `wanted` if this processor has it, else with `portable`.
  explicit bulk_decoder(instruction_set wanted = best_instruction_set()) noexcept;

  /// Takes bytes from the front of `input` and writes their points to the front of `out`; gives what
  /// was written. Stops when all of `input` is taken, or before a packet whose points do not fit:
  /// `input` is empty in the first case only. With room for max_samples points each call takes
  /// something. Behind what was written, `out` may have been written to.
  [[nodiscard]] std::span<point> decode(bytes& input, std::span<point> out) noexcept;

  /// The same with the points' places in frame `to`, within 1e-6 of the range of the exact ones;
  /// both coordinates are NaN where nothing came back. One stream may be decoded by turns to points
  /// and to places.
  [[nodiscard]] std::span<xy_point> decode_xy(bytes& input, frame to,
                                              std::span<xy_point> out) noexcept;

  /// When no more bytes follow: the points of the good packets in what is held, as
  /// stream_parser::finish() finds them. With room for max_samples points one call does it; with
  /// less, call until held() is 0. The next byte begins a new stream, but revolutions and counts go
  /// on.
  [[nodiscard]] std::span<point> finish(std::span<point> out) noexcept;
  /// The same to places in frame `to`, as decode_xy() gives them.
  [[nodiscard]] std::span<xy_point> finish_xy(frame to, std::span<xy_point> out) noexcept;

  /// Everything that was found so far. Bytes given = bytes of frames + bytes skipped + held().
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  /// Bytes of an unfinished frame.
  [[nodiscard]] std::size_t held() const noexcept { return parser_.held(); }
  /// What is computed with.
  [[nodiscard]] instruction_set in_use() const noexcept { return set_; }

 private:
  template <class Source, class Point, class Convert>
  std::optional<std::size_t> step(const Source& source, const Convert& convert,
                                  std::span<Point, max_samples> out) noexcept;
  template <class Source, class Point, class Convert>
  std::span<Point> run(const Source& source, const Convert& convert, std::span<Point> out) noexcept;

  stream_parser parser_;
  revolution_counter revolutions_;
  stream_counts counts_;
  instruction_set set_;
};

}  // namespace g4lidar
