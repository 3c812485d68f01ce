// SPDX-License-Identifier: MIT
// A WebSocket whose handshake is done.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <libwebsockets.h>

#include "client_registry.hpp"

namespace g4_tool {

/// A client of the client registry, if a place is free or becomes free within a second: clients that have ended may still be
/// counted when the next ones come. Otherwise it is closed with the reason. libwebsockets delivers what arrives until
/// the connection is destroyed, also after a callback has refused it.
/// Functions return what a callback of libwebsockets does: not 0 to close. *Single thread*: the one of libwebsockets.
class web_socket {
 public:
  web_socket(client_registry& clients, client_kind kind, lws* wsi);
  web_socket(const web_socket&) = delete;
  web_socket& operator=(const web_socket&) = delete;
  ~web_socket() { end(); }

  [[nodiscard]] int receive(std::string_view piece);
  /// `scratch`: any memory.
  [[nodiscard]] int write(std::vector<std::uint8_t>& scratch);
  /// The timer, which the constructor sets, has elapsed.
  [[nodiscard]] int check_timer();
  /// From now on it is no client of the client registry.
  void end();

 private:
  bool has_place();
  int close(lws_close_status why, std::string_view words);
  int refuse();

  client_registry& clients_;
  client_kind kind_;
  lws* wsi_;
  client_registry::client* client_ = nullptr;
  std::string received_;  // of a message whose end has not come
  int waits_ = 0;         // for a place
  bool is_due_ = false;   // messages may be sent
  bool has_ended_ = false;
};

}  // namespace g4_tool
