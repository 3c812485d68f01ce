// SPDX-License-Identifier: MIT
// Stores the bytes that the driver reads, for clients that record them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4_tool {

/// The bytes since the last take(). Bounded: bytes that do not fit are dropped. *Single thread*: that of the lidar.
class byte_tap {
 public:
  /// Many times the bytes of the longest revolution.
  static constexpr std::size_t most_bytes = 65'536;

  byte_tap() { kept_.reserve(most_bytes); }

  /// Observes the reads of `inner`. This outlives the result.
  [[nodiscard]] std::unique_ptr<g4lidar::transport> observe(
      std::unique_ptr<g4lidar::transport> inner) {
    return std::make_unique<observed>(std::move(inner), *this);
  }
  /// Starts or stops storing bytes.
  void want(bool wants) noexcept {
    wants_ = wants;
    if (!wants) kept_.clear();
  }
  /// The arrival of the last stored byte, by the clock of the transport.
  [[nodiscard]] std::int64_t arrival_ns() const noexcept { return arrival_ns_; }
  /// The stored bytes as a message of recordings, and clears them; empty if there are none.
  [[nodiscard]] std::vector<std::uint8_t> take() {
    std::vector<std::uint8_t> message;
    if (!kept_.empty()) g4lidar::put_recorded_bytes(kept_, arrival_ns_, message);
    kept_.clear();
    return message;
  }

 private:
  class observed final : public g4lidar::forwarding_transport {
   public:
    observed(std::unique_ptr<g4lidar::transport> inner, byte_tap& tap)
        : forwarding_transport(std::move(inner)), tap_(tap) {}

    [[nodiscard]] g4lidar::result<g4lidar::received> read(
        std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
      auto got = inner().read(out, deadline_ns);
      if (got) tap_.keep(out.first(got->count), got->arrival_ns);
      return got;
    }

   private:
    byte_tap& tap_;
  };

  void keep(g4lidar::bytes data, std::int64_t arrival_ns) noexcept {
    if (!wants_ || data.empty() || data.size() > most_bytes - kept_.size()) return;
    kept_.insert(kept_.end(), data.begin(), data.end());  // fits into the capacity
    arrival_ns_ = arrival_ns;
  }

  std::vector<std::uint8_t> kept_;
  std::int64_t arrival_ns_ = 0;
  bool wants_ = false;
};

}  // namespace g4_tool
