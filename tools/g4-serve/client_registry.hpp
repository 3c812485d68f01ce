// SPDX-License-Identifier: MIT
// The clients, their waiting messages, and the handling of their requests, without sockets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foxglove_protocol.hpp"
#include "outbox.hpp"
#include "page_protocol.hpp"

namespace g4_tool {

/// The protocol of a client.
enum class client_kind : std::uint8_t { page, foxglove };

/// How requests of clients reach the lidar. All may be called in any thread, without a lock.
struct lidar_actions {
  /// Changes a setting, and calls `done` later, in any thread, with the error; empty if there is none.
  std::function<void(const set_request&, std::function<void(const std::string&)> done)> set;
  std::function<void(const play_request&)> play;
  /// The same as `set`, for a recording.
  std::function<void(const record_request&, std::function<void(const std::string&)> done)> record{};
};

/// *Any thread.* Its memory is bounded by the number of clients.
class client_registry {
 public:
  /// A client, from connect() to disconnect(). Only its connection touches it.
  struct client;

  /// `wake` is called, in any thread, after messages were put into outboxes. `session`: see
  /// server_info_text().
  client_registry(std::string_view session, bool allows_set, lidar_actions actions,
                  std::function<void()> wake);
  client_registry(const client_registry&) = delete;
  client_registry& operator=(const client_registry&) = delete;
  ~client_registry();

  // ---- for the connections --------------------------------------------------------------------

  /// `socket`: passed to the callback of for_each_ready(). Null if there are `most_clients`.
  static constexpr std::size_t most_clients = 128;
  [[nodiscard]] client* connect(client_kind kind, void* socket);
  void disconnect(client* gone);
  /// Handles a text of a client. False if it violates the protocol: then close the connection.
  [[nodiscard]] bool receive(client& peer, std::string_view text);
  /// The next message for it; nothing if none waits.
  [[nodiscard]] std::optional<outgoing> take(client& receiver);
  [[nodiscard]] bool has_more(const client& receiver) const;
  /// Calls `use` with the socket of each client that has waiting messages.
  void for_each_ready(const std::function<void(void*)>& use);
  /// The last status as JSON, for HTTP.
  [[nodiscard]] shared_bytes status() const;

  // ---- for the publisher ----------------------------------------------------------------------

  /// The messages that at least one client receives.
  struct wanted_messages {
    bool page = false;
    std::array<bool, channel_count> channels{};
    [[nodiscard]] bool wants(channel target) const noexcept {
      return channels[static_cast<std::size_t>(target)];
    }
  };
  [[nodiscard]] wanted_messages wanted() const;

  /// Sets the first message for new pages and, if `sends`, sends it to the present ones.
  void send_hello(const std::string& hello, bool sends);
  void settings(const std::string& text);
  void status(const std::string& text);
  void event(const std::string& text);
  /// Sends a binary message to all pages.
  void page_scan(std::vector<std::uint8_t> message);
  void publish(channel target, std::int64_t stamp_ns, std::vector<std::uint8_t> message);

  [[nodiscard]] std::size_t client_count() const;

 private:
  /// Calls `put` with each client, under the lock, and then wake().
  void put_messages(const std::function<void(client&)>& put);
  void to_pages(std::size_t slot, bool is_text, const shared_bytes& payload);
  void answer(std::uint64_t id, std::string_view op, const std::string& message);
  /// Calls `act` unless the last such request of the client is not done yet.
  void take_slow(client& peer, const std::string& op,
                 const std::function<void(std::function<void(const std::string&)>)>& act);
  [[nodiscard]] bool receive_page(client& peer, std::string_view text);
  [[nodiscard]] bool receive_foxglove(client& peer, std::string_view text);
  /// Returns the error; empty if there is none.
  [[nodiscard]] static std::string subscribe(client& peer, const subscribe_request::entry& wanted);

  const bool allows_set_;
  const lidar_actions actions_;
  const std::function<void()> wake_;
  const shared_bytes server_info_;
  const shared_bytes advertise_;
  mutable std::mutex mutex_;  // protects the following members
  std::list<client> clients_;
  std::uint64_t last_id_ = 0;
  shared_bytes hello_;
  shared_bytes status_;
};

}  // namespace g4_tool
