// SPDX-License-Identifier: MIT
// Packs and unpacks chunks, where zstd is there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "g4lidar/bytes.hpp"

namespace g4lidar::mcap {

/// How large packed bytes can be. *Pure.*
[[nodiscard]] std::size_t packed_bound(std::size_t size) noexcept;

/// *Allocates on open.*
class packer {
 public:
  packer();
  ~packer();
  packer(const packer&) = delete;
  packer& operator=(const packer&) = delete;

  /// Packs to `out`, which has room for packed_bound(); how much was written, 0 where it failed.
  [[nodiscard]] std::size_t pack(bytes data, std::span<std::uint8_t> out) noexcept;

 private:
  struct state;
  std::unique_ptr<state> state_;
};

/// Grows with what comes out of it, and not with what is claimed.
class unpacker {
 public:
  unpacker();
  ~unpacker();
  unpacker(const unpacker&) = delete;
  unpacker& operator=(const unpacker&) = delete;

  /// Unpacks into `out`. False where that is not exactly `size` bytes, or where there is no zstd.
  [[nodiscard]] bool unpack(bytes packed, std::size_t size, std::vector<std::uint8_t>& out);

 private:
  struct state;
  std::unique_ptr<state> state_;
};

}  // namespace g4lidar::mcap
