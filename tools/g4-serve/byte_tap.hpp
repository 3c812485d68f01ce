// SPDX-License-Identifier: MIT
// Keeps what the driver reads, for clients that record it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "g4lidar/recording/raw_bytes.hpp"
#include "g4lidar/transport/forwarding.hpp"

namespace g4_tool {

/// Bytes since the last take(). Bounded: what does not fit is dropped. *Single thread*: the station's.
class byte_tap {
 public:
  /// Many times those of the longest revolution.
  static constexpr std::size_t most_bytes = 65'536;

  byte_tap() { kept_.reserve(most_bytes); }

  /// Observes the reads of `inner`. This outlives the result.
  [[nodiscard]] std::unique_ptr<g4lidar::transport> observe(
      std::unique_ptr<g4lidar::transport> inner) {
    return std::make_unique<observed>(std::move(inner), *this);
  }
  /// Whether bytes are kept from now on.
  void want(bool wants) noexcept {
    wants_ = wants;
    if (!wants) kept_.clear();
  }
  /// When the last kept byte had arrived, by the clock of the transport.
  [[nodiscard]] std::int64_t arrival_ns() const noexcept { return arrival_ns_; }
  /// The kept bytes as a message of recordings, which are forgotten then; empty if there are none.
  [[nodiscard]] std::vector<std::uint8_t> take() {
    std::vector<std::uint8_t> message;
    if (!kept_.empty()) g4lidar::put_recorded_bytes(kept_, arrival_ns_, message);
    kept_.clear();
    return message;
  }

 private:
  class observed final : public g4lidar::forwarding_transport {
   public:
    observed(std::unique_ptr<g4lidar::transport> inner, byte_tap& to)
        : forwarding_transport(std::move(inner)), to_(to) {}

    [[nodiscard]] g4lidar::result<g4lidar::received> read(
        std::span<std::uint8_t> out, std::int64_t deadline_ns) noexcept override {
      auto got = inner().read(out, deadline_ns);
      if (got) to_.keep(out.first(got->count), got->arrival_ns);
      return got;
    }

   private:
    byte_tap& to_;
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
