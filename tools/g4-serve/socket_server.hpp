// SPDX-License-Identifier: MIT
// The WebSockets of the clients of a client registry, with libwebsockets, in a thread of its own.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <libwebsockets.h>

#include "client_registry.hpp"
#include "listener.hpp"

namespace g4_tool {

/// It gets connections with the request of a WebSocket that this program has written itself: the HTTP of libwebsockets,
/// which also has an upgrade to HTTP/2, reads no byte of a client.
class socket_server {
 public:
  /// Connections, with those that are being closed.
  static constexpr std::size_t most_sockets = 256;

  /// `clients` outlives this. Throws a failure.
  explicit socket_server(client_registry& clients);
  socket_server(const socket_server&) = delete;
  socket_server& operator=(const socket_server&) = delete;
  ~socket_server();

  /// The one of these subprotocols, a list of a client, that is used; empty: it is none of ours.
  [[nodiscard]] static std::string_view choose(std::string_view subprotocols);
  [[nodiscard]] bool is_full() const noexcept { return sockets_ >= most_sockets; }
  /// `first`: a whole request, and what the client has sent after its own. *Any thread.*
  void adopt(socket_fd socket, std::string first);
  /// Messages wait in the client registry. *Any thread.*
  void wake() noexcept;

 private:
  class callbacks;
  struct adoption {
    socket_fd socket;
    std::string first;
  };

  void run() noexcept;
  void adopt_all();

  client_registry& clients_;
  std::vector<std::uint8_t> scratch_;  // of the thread
  lws_context* context_ = nullptr;
  lws_vhost* host_ = nullptr;
  std::mutex mutex_;  // protects the next member
  std::vector<adoption> waiting_;
  std::atomic<std::size_t> sockets_ = 0;
  std::atomic<bool> has_news_ = false;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace g4_tool
