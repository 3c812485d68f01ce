// SPDX-License-Identifier: MIT
// Serves the WebSockets of the clients with libwebsockets, in a thread of its own.
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

/// Adopts connections with a request that this program has written itself. So no byte of a client reaches the HTTP of
/// libwebsockets, which also has an upgrade to HTTP/2.
class socket_server {
 public:
  /// The largest number of connections, including those that are being closed.
  static constexpr std::size_t most_sockets = 256;

  /// `clients` outlives this. Throws a failure.
  explicit socket_server(client_registry& clients);
  socket_server(const socket_server&) = delete;
  socket_server& operator=(const socket_server&) = delete;
  ~socket_server();

  /// The subprotocol to use, from the list of a client; empty if none is supported.
  [[nodiscard]] static std::string_view choose(std::string_view subprotocols);
  [[nodiscard]] bool is_full() const noexcept { return sockets_ >= most_sockets; }
  /// `first`: a whole request, and the bytes that followed the client's own request. *Any thread.*
  void adopt(socket_fd socket, std::string first);
  /// Sends the messages that wait in the client registry. *Any thread.*
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
