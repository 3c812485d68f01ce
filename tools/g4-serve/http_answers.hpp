// SPDX-License-Identifier: MIT
// What the server answers to a request. For web_server.cpp alone.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/beast/http/rfc7230.hpp>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "beast.hpp"
#include "cli/logger.hpp"
#include "cli/suggestion.hpp"
#include "client_registry.hpp"
#include "host_guard.hpp"
#include "http_connection.hpp"
#include "page_files.hpp"

namespace g4_tool {

/// *Single thread.*
class http_answers {
 public:
  http_answers(host_guard guard, client_registry& clients)
      : guard_(std::move(guard)), clients_(clients) {}

  [[nodiscard]] http_answer answer(const http_request& request) {
    using enum http::field;
    const auto where = parse_target(request);
    const auto is_repeated = [&](http::field name) { return request.count(name) > 1; };
    if (!where || std::ranges::any_of(std::array{host, origin, sec_websocket_key}, is_repeated)) {
      return {.status = 400, .content = "This is no request of HTTP/1.1.\n"};
    }
    if (!is_allowed(where->host, value_of(request, origin))) {
      return {.status = 403,
              .content =
                  "This name or this origin is not allowed: see --address and "
                  "--allow-origin of g4-serve.\n"};
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return {.status = 405, .content = "GET and HEAD only.\n"};
    }
    if (has_element(request, upgrade, "websocket") && has_element(request, connection, "upgrade")) {
      return answer_to_handshake(request, where->path);
    }
    return answer_with_file(*where);
  }

  /// The subprotocol to use; empty if the client offers none that is supported.
  [[nodiscard]] static std::string_view subprotocol_for(const http_request& request) {
    constexpr std::array ours{page_subprotocol, foxglove_subprotocols[0], foxglove_subprotocols[1]};
    const auto found = std::ranges::find_if(ours, [&](const char* each) {
      return has_element(request, http::field::sec_websocket_protocol, each);
    });
    return found == ours.end() ? std::string_view() : *found;
  }

  /// The request for Beast's handshake, which joins no headers.
  [[nodiscard]] static std::string handshake_for(const http_request& request) {
    return fmt::format(
        "GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {}\r\n\r\n",
        value_of(request, http::field::sec_websocket_key).value_or(""));
  }

 private:
  struct target {
    std::optional<std::string> host;
    std::string path;  // without the query
  };

  static std::optional<std::string> value_of(const http_request& request, http::field name) {
    const auto found = request.find(name);
    if (found == request.end()) return std::nullopt;
    return std::string(found->value());
  }

  /// Whether a list of elements has this one. The list may be in several lines. Case does not matter.
  static bool has_element(const http_request& request, http::field name, std::string_view element) {
    const auto lines = request.equal_range(name);
    return std::any_of(lines.first, lines.second, [&](const auto& line) {
      return http::token_list(line.value()).exists(std::string(element));
    });
  }

  /// Of a path, or of an absolute URL (RFC 9112, 3.2.2: its host is the one that counts).
  static std::optional<target> parse_target(const http_request& request) {
    const std::string text(request.target());
    target made{value_of(request, http::field::host), text.substr(0, text.find('?'))};
    constexpr std::string_view scheme = "http://";
    if (lowered(std::string_view(text).substr(0, scheme.size())) == scheme) {
      const std::size_t end = std::min(text.find_first_of("/?", scheme.size()), text.size());
      made.host = text.substr(scheme.size(), end - scheme.size());
      made.path = '/' + made.path.substr(std::min(end + 1, made.path.size()));
    }
    if (!made.path.starts_with('/')) return std::nullopt;
    return made;
  }

  bool is_allowed(const std::optional<std::string>& host,
                  const std::optional<std::string>& origin) {
    constexpr std::size_t most_refusals = 20;  // further ones are not logged
    const std::string why = guard_.objection(host, origin);
    const bool is_new = refused_.size() < most_refusals && !why.empty();
    if (is_new && refused_.insert(why).second) logger::info(why + ".\n");
    return why.empty();
  }

  http_answer answer_with_file(const target& where) {
    // Scripts and styles of the page's own files only, so that texts of others cannot run as scripts.
    std::string policy = fmt::format(
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
        "connect-src 'self' ws://{}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        where.host.value_or(""));
    if (where.path == "/status.json") {
      return {.status = 200,
              .type = "application/json",
              .owned = clients_.status(),
              .policy = std::move(policy)};
    }
    const auto files = page_files();
    const auto file = std::ranges::find(files, where.path, &page_file::path);
    if (file == files.end()) return {.status = 404, .content = "Not found.\n"};
    return {
        .status = 200, .type = file->type, .content = file->content, .policy = std::move(policy)};
  }

  static http_answer answer_to_handshake(const http_request& request, std::string_view path) {
    if (path != "/") return {.status = 404, .content = "The WebSocket is at / only.\n"};
    if (!has_element(request, http::field::sec_websocket_version, "13")) {
      return {.status = 426, .content = "The version of WebSockets here is 13.\n"};
    }
    const bool has_body =
        request.chunked() || value_of(request, http::field::content_length).value_or("0") != "0";
    if (request.method() != http::verb::get || request.version() != 11 || has_body ||
        !is_socket_key(value_of(request, http::field::sec_websocket_key).value_or(""))) {
      return {.status = 400, .content = "This is no handshake of a WebSocket.\n"};
    }
    if (subprotocol_for(request).empty()) {
      return {.status = 400,
              .content =
                  "A WebSocket needs one of the subprotocols g4lidar.page.v1, foxglove.sdk.v1 "
                  "and foxglove.websocket.v1.\n"};
    }
    return {.status = http_answer::is_socket};
  }

  /// Whether it is 16 bytes in base64 (RFC 6455, 4.1).
  static bool is_socket_key(std::string_view text) {
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    return text.size() == 24 && text.ends_with("==") &&
           text.substr(0, 22).find_first_not_of(digits) == std::string_view::npos;
  }

  host_guard guard_;
  client_registry& clients_;
  std::set<std::string> refused_{};  // the logged refusals
};

}  // namespace g4_tool
