// SPDX-License-Identifier: MIT
// Parses the head of an HTTP/1 request, as far as a server without uploads needs it (RFC 9112).
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace g4_tool {

/// Views into the text that was parsed.
struct http_request {
  std::string_view method;
  std::string_view path;  ///< Without the query.
  std::optional<std::string> host{};
  std::optional<std::string> origin{};
  std::string_view upgrade{};
  std::string_view connection{};
  std::string_view socket_key{};
  std::string_view socket_version{};
  std::string_view subprotocols{};
  bool has_body = false;
  bool is_old = false;  ///< HTTP/1.0.

  /// Whether it requests a WebSocket. Other upgrades, such as h2c, are ignored, as RFC 9110 (7.8) allows.
  [[nodiscard]] bool wants_socket() const;
  /// Whether another request may follow on this connection.
  [[nodiscard]] bool keeps_open() const;
};

/// The size of the head in `text`, with its empty line; 0 if its end is missing.
[[nodiscard]] std::size_t head_size(std::string_view text);
/// `head`: including its empty line; it outlives the result. Nothing if it is malformed, not HTTP/1.0 or 1.1, or
/// repeats one of the headers of http_request.
[[nodiscard]] std::optional<http_request> parse_head(std::string_view head);
/// Whether a comma-separated list has this element. Case does not matter.
[[nodiscard]] bool has_element(std::string_view list, std::string_view element);

}  // namespace g4_tool
