// SPDX-License-Identifier: MIT
// Serves HTTP/1.1 with small answers, and hands over requests of WebSockets, in a thread of its own.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <thread>

#include "http_request.hpp"
#include "listener.hpp"
#include "outbox.hpp"

namespace g4_tool {

/// The answer to a request.
struct http_answer {
  static constexpr unsigned is_socket = 101;

  /// is_socket: the connection is handed over, and `owned` is the request for its new owner.
  unsigned status;
  std::string_view type = "text/plain";
  shared_bytes owned{};
  std::string_view content{};  ///< Instead of `owned`: static bytes.
};

/// The callbacks of a server, called in its thread.
struct http_actions {
  std::function<http_answer(const http_request&)> answer;
  /// Takes over a connection; `first` precedes the bytes that its socket receives.
  std::function<void(socket_fd socket, std::string first)> hand_over;
};

/// Answers each request when its head is complete, within limits of size and time, and never reads a body. The number
/// of connections is bounded: a further one replaces the one that has made no progress for the longest time.
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
  /// False if the connection has ended.
  bool serve(connection& each, bool is_ready) noexcept;
  bool read(connection& each);
  bool write(connection& each);
  bool start_answer(connection& each);
  [[nodiscard]] clock::time_point may_accept_at() const;

  const socket_fd listening_;
  const socket_fd wake_;
  const http_actions actions_;
  std::list<connection> connections_;  // by their last progress, the oldest first
  clock::time_point accepts_at_{};     // in the future if the system had no sockets
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace g4_tool
