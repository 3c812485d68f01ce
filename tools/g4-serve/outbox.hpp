// SPDX-License-Identifier: MIT
// The waiting messages of one client, bounded however slowly the client reads.
#pragma once

#include <algorithm>
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

/// The payload of a message, shared by many clients.
using shared_bytes = std::shared_ptr<const std::vector<std::uint8_t>>;

[[nodiscard]] inline shared_bytes share(std::string_view text) {
  return std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end());
}
[[nodiscard]] inline shared_bytes share(std::vector<std::uint8_t> data) {
  return std::make_shared<const std::vector<std::uint8_t>>(std::move(data));
}

/// A message to one client: a prefix of its own, then the shared payload.
struct outgoing {
  bool is_text = true;
  shared_bytes payload{};
  std::array<std::uint8_t, 13> prefix{};
  std::size_t prefix_size = 0;

  [[nodiscard]] std::size_t size() const noexcept { return prefix_size + payload->size(); }
};

/// A short queue of messages, and slots that store only the newest message. So a client that never reads uses a
/// constant amount of memory. *Single thread.*
class outbox {
 public:
  static constexpr std::size_t slot_count = 4;
  static constexpr std::size_t longest_queue = 16;

  /// Appends to the queue, which is sent before the slots. False if it is full: the message is dropped.
  bool add(outgoing message) {
    if (queue_.size() >= longest_queue) return false;
    queue_.push_back(std::move(message));
    return true;
  }
  /// Stores a message in a slot and replaces an unsent one there. Slots are sent in turn. Returns the number
  /// of messages of the slot that were replaced since the last one was sent.
  std::size_t replace(std::size_t slot, outgoing message) {
    newest& into = slots_.at(slot);
    if (into.message) ++into.replaced;
    into.message = std::move(message);
    return into.replaced;
  }
  void clear(std::size_t slot) { slots_.at(slot) = {}; }

  /// The next message; nothing if none waits.
  [[nodiscard]] std::optional<outgoing> take() {
    if (!queue_.empty()) {
      std::optional<outgoing> first(std::move(queue_.front()));
      queue_.pop_front();
      return first;
    }
    for (std::size_t i = 0; i < slot_count; ++i) {
      const std::size_t slot = std::exchange(turn_, (turn_ + 1) % slot_count);
      if (slots_[slot].message) return std::exchange(slots_[slot], {}).message;
    }
    return std::nullopt;
  }
  [[nodiscard]] bool is_empty() const noexcept {
    return queue_.empty() && std::ranges::none_of(slots_, [](const newest& each) {
             return each.message.has_value();
           });
  }

 private:
  struct newest {
    std::optional<outgoing> message{};
    std::size_t replaced = 0;
  };
  std::deque<outgoing> queue_;
  std::array<newest, slot_count> slots_;
  std::size_t turn_ = 0;
};

}  // namespace g4_tool
