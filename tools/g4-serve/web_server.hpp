// SPDX-License-Identifier: MIT
// The sockets: HTTP for the page, WebSockets for pages and Foxglove, in a thread of their own.
#pragma once

#include <atomic>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "host_guard.hpp"
#include "http_head.hpp"
#include "hub.hpp"
#include "outbox.hpp"

namespace g4_tool {

/// Listens from its construction on. Serves the files of the page, /status.json, and the clients of a hub.
class web_server {
 public:
  /// `port` 0: any that is free. `clients` outlives this. Throws a failure where it cannot listen, and
  /// names the reason.
  web_server(const std::string& address, std::uint16_t port, std::vector<std::string> origins,
             hub& clients);
  web_server(const web_server&) = delete;
  web_server& operator=(const web_server&) = delete;
  ~web_server();

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  /// "http://127.0.0.1:8765/"; with 0.0.0.0 and :: one for each name and address of this machine.
  [[nodiscard]] std::vector<std::string> urls() const;
  /// Messages wait in the hub. *Any thread*, also after the destructor has begun.
  void wake() noexcept;

 private:
  struct connection;
  struct reply;
  class callbacks;

  void run() noexcept;

  std::string address_;
  std::uint16_t port_;
  host_guard guard_;
  hub& clients_;
  // Of the thread:
  std::vector<std::uint8_t> scratch_;
  std::set<std::string> refused_;  // what was logged
  waiting_connections waiting_;
  lws_context* context_ = nullptr;
  std::atomic<bool> has_news_ = false;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace g4_tool
