// SPDX-License-Identifier: MIT
// The WebSocket protocol of Foxglove, as far as a server needs it that only publishes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "g4lidar/message/ros_messages.hpp"
#include "outbox.hpp"

namespace g4_tool {

/// In the order in which they are preferred. Both have the same messages here.
inline constexpr std::array<const char*, 2> foxglove_subprotocols{"foxglove.sdk.v1",
                                                                  "foxglove.websocket.v1"};

/// What is published. Their ids count from 1.
enum class channel : std::uint8_t { scan, points, diagnostics, from_device };
inline constexpr std::size_t channel_count = 4;
/// The channel of an id.
[[nodiscard]] constexpr std::optional<channel> channel_of(std::uint32_t id) noexcept {
  if (id < 1 || id > channel_count) return std::nullopt;
  return static_cast<channel>(id - 1);
}

/// The first two messages to each client. `session`: differs for each run of the server.
[[nodiscard]] std::string server_info_text(std::string_view session);
[[nodiscard]] std::string advertise_text();
/// A message for people. `level`: 0 information, 1 warning, 2 error.
[[nodiscard]] std::string foxglove_status_text(int level, std::string_view message);

/// The binary message of data for one subscription.
[[nodiscard]] outgoing message_data(std::uint32_t subscription, std::int64_t stamp_ns,
                                    const shared_bytes& payload);

struct subscribe_request {
  struct entry {
    std::uint32_t id;  ///< Chosen by the client.
    std::uint32_t channel_id;
  };
  std::vector<entry> entries;
};
struct unsubscribe_request {
  std::vector<std::uint32_t> ids;
};
/// What this server does not offer.
struct other_request {
  std::string op;
};
using foxglove_request = std::variant<subscribe_request, unsubscribe_request, other_request>;

/// Nothing for a text that is no request of the protocol: the client is to be closed.
[[nodiscard]] std::optional<foxglove_request> parse_foxglove_request(std::string_view text);

}  // namespace g4_tool
