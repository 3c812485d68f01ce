// SPDX-License-Identifier: MIT
// The web server: HTTP for the page, WebSockets for pages and Foxglove, in a thread of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "client_registry.hpp"

namespace g4_tool {

/// Serves the files of the page, /status.json, and the clients of a client registry. The number of connections is
/// bounded: a further one replaces the one that has made no progress for the longest time.
class web_server {
 public:
  /// Listens. `port` 0: any free port. `clients` outlives this. Throws a failure if it cannot listen.
  web_server(const std::string& address, std::uint16_t port, std::vector<std::string> origins,
             client_registry& clients);
  ~web_server();

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// "http://127.0.0.1:8765/"; with 0.0.0.0 and :: one for each name and address of this machine.
  [[nodiscard]] std::vector<std::string> urls() const;
  /// Sends the messages that wait in the client registry. *Any thread.*
  void wake() noexcept;

 private:
  class loop;

  std::string address_;
  std::uint16_t port_ = 0;
  std::unique_ptr<loop> loop_;
};

}  // namespace g4_tool
