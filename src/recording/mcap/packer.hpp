// SPDX-License-Identifier: MIT
// Compresses and uncompresses chunks, if zstd is available.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar::mcap {

/// The state of zstd; null without zstd.
using zstd_context = std::unique_ptr<void, void (*)(void*)>;

/// *Allocates on open.*
class packer {
 public:
  /// For data of at most `usual_size` bytes it allocates only here.
  explicit packer(std::size_t usual_size);
  /// The compressed bytes, valid until the next call; empty on failure. Throws only std::bad_alloc.
  [[nodiscard]] bytes pack(bytes data);

 private:
  zstd_context context_;
  std::vector<std::uint8_t> packed_;
};

/// Grows with the actual output, and not with the claimed size.
class unpacker {
 public:
  unpacker();
  /// Uncompresses to `out`, in pieces: `take` gets all that there is after each, and returns whether
  /// to go on. False if it does not, if the result is not exactly `size` bytes, or without zstd.
  [[nodiscard]] bool unpack(bytes packed, std::size_t size, std::vector<std::uint8_t>& out,
                            const std::function<bool(bytes)>& take);

 private:
  zstd_context context_;
};

}  // namespace g4lidar::mcap
