// SPDX-License-Identifier: MIT
// Decodes many bytes to points at the full speed of the processor: for recordings and pipes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "g4lidar/cartesian.hpp"
#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/decode.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/core/stream_counter.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/point.hpp"

namespace g4lidar {

/// The instructions that a bulk_decoder uses.
enum class instruction_set : std::uint8_t {
  portable,  ///< Plain C++, as the compiler translates it.
  avx2,      ///< AVX2, on x86-64.
};

/// The best instruction set of this processor. *Pure*: the result is constant while a program runs.
/// Not `constexpr`, because the compiler does not know the processor.
[[nodiscard]] G4LIDAR_API instruction_set best_instruction_set() noexcept;

/// The name of an instruction set, for people. Valid forever. *Pure*.
[[nodiscard]] G4LIDAR_API const char* name_of(instruction_set set) noexcept;

/// Bytes to points: a stream_parser, the count of revolutions, and the arithmetic, which is
/// selected for the processor at run time. *Single thread, never allocates.* Times are 0, not
/// known.
///
/// The points are those of decode() with any correction form: angles are within 4e-5 degrees of the
/// exact ones, everything else is identical. Every instruction set gives the same bits. What the bytes state of the
/// firmware and of the offset of zero holds from there on; see reply_watch.
class G4LIDAR_API bulk_decoder {
 public:
  /// Uses `wanted` if this processor has it, else `portable`.
  explicit bulk_decoder(instruction_set wanted = best_instruction_set()) noexcept;
  /// For packets of this model, which is valid as long as this.
  explicit bulk_decoder(const model& model,
                        instruction_set wanted = best_instruction_set()) noexcept;

  /// Takes bytes from the front of `input`, writes their points to the front of `out` and returns
  /// what was written. Stops when all of `input` is taken (then `input` is empty), or before a
  /// packet whose points do not fit. With room for max_samples points each call takes at least one
  /// byte. Memory of `out` behind the returned points may be overwritten.
  [[nodiscard]] std::span<point> decode(bytes& input, std::span<point> out) noexcept;

  /// The same, but writes the positions of the points in frame `to` of the model, within 1e-6 of the range of
  /// the exact ones; both coordinates are NaN for a point without return. Calls for points and for
  /// positions may alternate in one stream.
  [[nodiscard]] std::span<xy_point> decode_xy(bytes& input, frame to,
                                              std::span<xy_point> out) noexcept;

  /// Call this when no more bytes follow: returns the points of the valid packets among the held
  /// bytes, as stream_parser::finish() finds them. With room for max_samples points one call is
  /// enough; with less, call it until held() is 0. The next byte begins a new stream; revolutions
  /// and counts continue.
  [[nodiscard]] std::span<point> finish(std::span<point> out) noexcept;
  /// The same for positions in frame `to`.
  [[nodiscard]] std::span<xy_point> finish_xy(frame to, std::span<xy_point> out) noexcept;

  /// Counts of everything found so far. Bytes given = bytes of packets and responses + bytes skipped +
  /// held().
  [[nodiscard]] const stream_counts& counts() const noexcept { return counts_; }
  /// Bytes of an unfinished packet or response.
  [[nodiscard]] std::size_t held() const noexcept { return parser_.held(); }
  /// What is added to each angle, of a model that has such an offset: what the bytes state, or what is set here with
  /// zero_offset::stated_by::user.
  [[nodiscard]] zero_offset& zero() noexcept { return zero_; }
  /// The same.
  [[nodiscard]] const zero_offset& zero() const noexcept { return zero_; }
  /// The instruction set in use.
  [[nodiscard]] instruction_set in_use() const noexcept { return set_; }

 private:
  void learn(const response_view& heard) noexcept;
  template <class Source, class Point, class Convert>
  std::optional<std::size_t> step(const Source& source, const Convert& convert,
                                  std::span<Point, max_samples> out) noexcept;
  template <class Source, class Point, class Convert>
  std::span<Point> run(const Source& source, const Convert& convert, std::span<Point> out) noexcept;

  stream_parser parser_;
  revolution_counter revolutions_;
  stream_counter counts_;
  const model* named_;  // whatever the firmware
  const model* which_;
  reply_watch replies_;
  zero_offset zero_;
  instruction_set set_;
};

}  // namespace g4lidar
