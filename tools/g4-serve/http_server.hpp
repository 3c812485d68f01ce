// SPDX-License-Identifier: MIT
// HTTP/1.1 for small answers, and the requests of WebSockets, in a thread of its own.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <thread>

#include "http_request.hpp"
#include "listener.hpp"
#include "outbox.hpp"

namespace g4_tool {

/// What a request is answered with.
struct http_answer {
  static constexpr unsigned is_socket = 101;

  unsigned
      status;  ///< is_socket: the connection is handed over, and `owned` is the request for its new owner.
  std::string_view type = "text/plain";
  shared_bytes owned{};
  std::string_view content{};  ///< Instead of `owned`: bytes that are valid forever.
};

/// What a server asks of its owner, in its thread.
struct http_actions {
  std::function<http_answer(const http_request&)> answer;
  /// Hands over a connection, and the bytes that are to be read before those of its socket.
  std::function<void(socket_fd socket, std::string first)> hand_over;
};

/// A request is answered when its head is complete, within limits of size and time. It never reads a body. Connections
/// are bounded: where there are too many, the one that has made no progress for the longest time is ended.
class http_server {
 public:
  http_server(socket_fd listening, http_actions actions);
  http_server(const http_server&) = delete;
  http_server& operator=(const http_server&) = delete;
  ~http_server();

 private:
  struct connection;
  using clock = std::chrono::steady_clock;

  void run() noexcept;
  void accept_all() noexcept;
  /// False if the connection is over.
  bool serve(connection& each, bool is_ready) noexcept;
  bool read(connection& each);
  bool write(connection& each);
  bool start_answer(connection& each);
  [[nodiscard]] clock::time_point may_accept_at() const;

  const socket_fd listening_;
  const socket_fd wake_;
  const http_actions actions_;
  std::list<connection> connections_;  // the one without progress for the longest time first
  clock::time_point accepts_at_{};     // later, where the system has no sockets
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace g4_tool
