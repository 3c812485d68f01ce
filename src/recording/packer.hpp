// SPDX-License-Identifier: MIT
// Compresses and uncompresses chunks, if zstd is available.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "g4lidar/core/bytes.hpp"

namespace g4lidar::mcap {

/// The maximum size of compressed bytes. *Pure.*
[[nodiscard]] std::size_t packed_bound(std::size_t size) noexcept;

/// The state of zstd; null without zstd.
using zstd_context = std::unique_ptr<void, void (*)(void*)>;

/// *Allocates on open.*
class packer {
 public:
  packer();
  /// Compresses to `out`, which has room for packed_bound(); returns the size, 0 on failure.
  [[nodiscard]] std::size_t pack(bytes data, std::span<std::uint8_t> out) noexcept;

 private:
  zstd_context context_;
};

/// Grows with the actual output, and not with the claimed size.
class unpacker {
 public:
  unpacker();
  /// Uncompresses to `out`. False if the result is not exactly `size` bytes, or without zstd.
  [[nodiscard]] bool unpack(bytes packed, std::size_t size, std::vector<std::uint8_t>& out);

 private:
  zstd_context context_;
};

}  // namespace g4lidar::mcap
