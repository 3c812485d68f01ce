// SPDX-License-Identifier: MIT
// The headers of requests and of answers, and the connections that have sent no request.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include <libwebsockets.h>

namespace g4_tool {

/// A header of the request; nothing where it has none.
[[nodiscard]] std::optional<std::string> header(lws* wsi, lws_token_indexes which);

/// Writes the status line and the headers of an answer with `size` bytes. False if it is to be closed.
[[nodiscard]] bool write_head(lws* wsi, unsigned status, const std::string& type, std::size_t size);

/// Connections that have not sent a whole request yet, the oldest one first. *Single thread.*
class waiting_connections {
 public:
  /// Where there are too many, the oldest one is ended: half a request must not keep out other clients.
  void add(lws* wsi);
  void remove(lws* wsi);

 private:
  using clock = std::chrono::steady_clock;
  struct entry {
    lws* wsi;
    clock::time_point since;
  };
  std::deque<entry> all_;
};

}  // namespace g4_tool
