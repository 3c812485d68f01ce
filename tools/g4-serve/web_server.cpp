// SPDX-License-Identifier: MIT
#include "web_server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "cli/logger.hpp"
#include "page_files.hpp"

namespace g4_tool {
namespace {

/// Further refusals are not logged.
constexpr std::size_t most_refusals = 20;

constexpr std::string_view forbidden =
    "This name or this origin is not allowed: see --address and --allow-origin of g4-serve.\n";

/// 16 bytes in base64 (RFC 6455, 4.1).
bool is_socket_key(std::string_view text) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  return text.size() == 24 && text.ends_with("==") &&
         text.substr(0, 22).find_first_not_of(digits) == std::string_view::npos;
}

}  // namespace

web_server::web_server(const std::string& address, std::uint16_t port,
                       std::vector<std::string> origins, client_registry& clients)
    : address_(address), guard_(address, std::move(origins)), clients_(clients), sockets_(clients) {
  socket_fd listening = listen_at(address, port);
  port_ = port_of(listening);
  http_.emplace(std::move(listening),
                http_actions{.answer = [this](const http_request& each) { return answer(each); },
                             .hand_over =
                                 [this](socket_fd socket, std::string first) {
                                   sockets_.adopt(std::move(socket), std::move(first));
                                 }});
}

std::vector<std::string> web_server::urls() const {
  std::vector<std::string> all;
  for (const std::string& host : hosts_of(address_)) {
    all.push_back(fmt::format("http://{}:{}/", host, port_));
  }
  return all;
}

bool web_server::is_allowed(const http_request& request) {
  const std::string why = guard_.objection(request.host, request.origin);
  const bool is_new = refused_.size() < most_refusals && !why.empty();
  if (is_new && refused_.insert(why).second) logger::info(why + ".\n");
  return why.empty();
}

http_answer web_server::answer(const http_request& request) {
  if (!is_allowed(request)) return {.status = 403, .content = forbidden};
  if (request.method != "GET" && request.method != "HEAD") {
    return {.status = 405, .content = "GET and HEAD only.\n"};
  }
  if (request.wants_socket()) return answer_to_handshake(request);
  if (request.path == "/status.json") {
    return {.status = 200, .type = "application/json", .owned = clients_.status()};
  }
  const auto files = page_files();
  const auto file = std::ranges::find(files, request.path, &page_file::path);
  if (file == files.end()) return {.status = 404, .content = "Not found.\n"};
  return {.status = 200, .type = file->type, .content = file->content};
}

http_answer web_server::answer_to_handshake(const http_request& request) const {
  if (request.socket_version != "13") {
    return {.status = 426, .content = "The version of WebSockets here is 13.\n"};
  }
  if (request.method != "GET" || request.is_old || request.has_body ||
      !is_socket_key(request.socket_key)) {
    return {.status = 400, .content = "This is no handshake of a WebSocket.\n"};
  }
  const std::string_view subprotocol = socket_server::choose(request.subprotocols);
  if (subprotocol.empty()) {
    return {.status = 400,
            .content =
                "A WebSocket needs one of the subprotocols g4lidar.page.v1, foxglove.sdk.v1 "
                "and foxglove.websocket.v1.\n"};
  }
  if (sockets_.is_full()) {
    return {.status = 503, .content = "There are too many connections. Try again later.\n"};
  }
  return {.status = http_answer::is_socket,
          .owned = share(fmt::format("GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n"
                                     "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                                     "Sec-WebSocket-Key: {}\r\nSec-WebSocket-Protocol: {}\r\n\r\n",
                                     request.socket_key, subprotocol))};
}

}  // namespace g4_tool
