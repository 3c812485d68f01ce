// SPDX-License-Identifier: MIT
// Recognises devices that send frames of another protocol: lidars of other makers, other products of this maker,
// receivers of satellite positions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar {

/// Who sends frames of one kind. Valid forever.
struct other_maker {
  std::string_view product;  ///< "an LD06, LD14, LD19 or STL of LDROBOT"
  std::string_view driver;   ///< The usual driver: "ldlidar_stl_ros2"; empty: it is no lidar.
  std::string_view frames;   ///< How it was recognised: "54 2C, 47 bytes, the CRC is right"
};

/// All kinds that are recognised.
[[nodiscard]] std::span<const other_maker> other_makers() noexcept;

/// "an LD06, LD14, LD19 or STL of LDROBOT; its driver is ldlidar_stl_ros2". *Allocates.*
[[nodiscard]] std::string with_driver(const other_maker& of);

/// *Single thread, never allocates.* A maker is recognised after five frames of its kind in a row, each behind the
/// other, if they have a checksum; after fifty if they have none. The greeting of a COIN-D4, and an answer that only an RPLIDAR
/// sends, are sufficient once.
class maker_recogniser {
 public:
  /// Adds bytes of the stream, in order.
  void take(bytes input) noexcept;
  /// The input has ended: a frame at its end counts, too.
  void finish() noexcept;

  /// The first maker that was recognised; null: none yet. Valid forever.
  [[nodiscard]] const other_maker* found() const noexcept { return found_; }

  /// Whether the last frames are a fifth of what is enough to recognise a maker.
  [[nodiscard]] bool is_likely() const noexcept;

 private:
  /// At least the size of the longest frame.
  static constexpr std::size_t longest = 512;
  static constexpr std::size_t most_kinds = 16;

  /// Frames of one kind in a row, up to the byte at which the next one must begin.
  struct run {
    std::uint64_t end = 0;
    unsigned frames = 0;
  };

  void look(std::size_t until) noexcept;

  std::array<std::uint8_t, 2 * longest> held_{};
  std::size_t size_ = 0;
  std::uint64_t begin_ = 0;  // of held_, in the stream
  std::array<run, most_kinds> runs_{};
  const other_maker* found_ = nullptr;
};

}  // namespace g4lidar
