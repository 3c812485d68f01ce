// SPDX-License-Identifier: MIT
// The web server: HTTP for the page, WebSockets for pages and Foxglove.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "client_registry.hpp"
#include "host_guard.hpp"
#include "http_server.hpp"
#include "socket_server.hpp"

namespace g4_tool {

/// Serves the files of the page, /status.json, and the clients of a client registry.
class web_server {
 public:
  /// Listens. `port` 0: any free port. `clients` outlives this. Throws a failure if it cannot listen.
  web_server(const std::string& address, std::uint16_t port, std::vector<std::string> origins,
             client_registry& clients);

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// "http://127.0.0.1:8765/"; with 0.0.0.0 and :: one for each name and address of this machine.
  [[nodiscard]] std::vector<std::string> urls() const;
  /// Sends the messages that wait in the client registry. *Any thread.*
  void wake() noexcept { sockets_.wake(); }

 private:
  [[nodiscard]] http_answer answer(const http_request& request);
  [[nodiscard]] http_answer answer_to_handshake(const http_request& request) const;
  [[nodiscard]] bool is_allowed(const http_request& request);

  std::string address_;
  host_guard guard_;
  client_registry& clients_;
  std::set<std::string> refused_{};  // the logged refusals
  socket_server sockets_;
  std::uint16_t port_ = 0;
  std::optional<http_server> http_;  // destroyed first
};

}  // namespace g4_tool
