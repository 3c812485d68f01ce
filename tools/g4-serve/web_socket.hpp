// SPDX-License-Identifier: MIT
// A WebSocket after its handshake.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <libwebsockets.h>

#include "client_registry.hpp"

namespace g4_tool {

/// Becomes a client of the client registry, if a place is free or becomes free within a second, because clients that
/// have just ended may still be counted. Otherwise it is closed with the reason. libwebsockets calls it until the
/// connection is destroyed, also after a callback has requested to close. Functions return the value for the callback of
/// libwebsockets: not 0 to close. *Single thread*: that of libwebsockets.
class web_socket {
 public:
  web_socket(client_registry& clients, client_kind kind, lws* wsi);
  web_socket(const web_socket&) = delete;
  web_socket& operator=(const web_socket&) = delete;
  ~web_socket() { end(); }

  [[nodiscard]] int receive(std::string_view piece);
  /// `scratch`: any memory.
  [[nodiscard]] int write(std::vector<std::uint8_t>& scratch);
  /// Handles the timer, which the constructor sets.
  [[nodiscard]] int check_timer();
  /// Disconnects it from the client registry.
  void end();

 private:
  bool has_place();
  int close(lws_close_status why, std::string_view words);
  int refuse();

  client_registry& clients_;
  client_kind kind_;
  lws* wsi_;
  client_registry::client* client_ = nullptr;
  std::string received_;  // the begin of an incomplete message
  int waits_ = 0;         // for a place
  bool may_send_ = false;
  bool has_ended_ = false;
};

}  // namespace g4_tool
