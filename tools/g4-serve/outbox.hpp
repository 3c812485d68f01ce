// SPDX-License-Identifier: MIT
// What waits for one client: bounded, whatever the client reads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace g4_tool {

/// The payload of a message; many clients share it.
using shared_bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

[[nodiscard]] inline shared_bytes share(std::string_view text) {
  return std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end());
}
[[nodiscard]] inline shared_bytes share(std::vector<std::uint8_t> data) {
  return std::make_shared<const std::vector<std::uint8_t>>(std::move(data));
}

/// One message to one client: its own prefix, then the shared payload.
struct outgoing {
  bool is_text = true;
  shared_bytes payload{};
  std::array<std::uint8_t, 13> prefix{};
  std::size_t prefix_size = 0;

  [[nodiscard]] std::size_t size() const noexcept { return prefix_size + payload->size(); }
};

/// Messages that wait until the client reads: a few in their order, and in each slot the newest one, which
/// replaces an older one. So a client that never reads costs a constant amount of memory. *Single thread.*
class outbox {
 public:
  static constexpr std::size_t slot_count = 4;
  static constexpr std::size_t longest_queue = 16;

  /// To be sent before all that is not in the queue yet. False, and dropped, if the queue is full.
  bool add(outgoing message) {
    if (queue_.size() >= longest_queue) return false;
    queue_.push_back(std::move(message));
    return true;
  }
  /// To be sent once, unless it is replaced before. Slots take turns.
  void replace(std::size_t slot, outgoing message) {
    if (slots_.at(slot)) ++replaced_;
    slots_[slot] = std::move(message);
  }
  void clear(std::size_t slot) { slots_.at(slot).reset(); }

  /// The next message; nothing if none waits.
  [[nodiscard]] std::optional<outgoing> take() {
    if (!queue_.empty()) {
      std::optional<outgoing> first(std::move(queue_.front()));
      queue_.pop_front();
      return first;
    }
    for (std::size_t i = 0; i < slot_count; ++i) {
      const std::size_t slot = std::exchange(turn_, (turn_ + 1) % slot_count);
      if (slots_[slot]) return std::exchange(slots_[slot], std::nullopt);
    }
    return std::nullopt;
  }
  [[nodiscard]] bool is_empty() const noexcept {
    for (const auto& slot : slots_) {
      if (slot) return false;
    }
    return queue_.empty();
  }
  /// How many messages were never sent because a newer one came.
  [[nodiscard]] std::uint64_t replaced() const noexcept { return replaced_; }

 private:
  std::deque<outgoing> queue_;
  std::array<std::optional<outgoing>, slot_count> slots_;
  std::size_t turn_ = 0;
  std::uint64_t replaced_ = 0;
};

}  // namespace g4_tool
