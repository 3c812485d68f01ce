// SPDX-License-Identifier: MIT
#include "web_server.hpp"

#include <fmt/format.h>
#include <libwebsockets.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "client_json.hpp"
#include "http_head.hpp"
#include "listen_check.hpp"
#include "page_files.hpp"

namespace g4_tool {

/// A WebSocket.
struct web_server::connection {
  hub::client* client;
  std::string received;  // of a message whose end has not come
  bool is_due = false;   // messages may be sent
};

/// What is left to be sent of the answer to a request.
struct web_server::reply {
  shared_bytes owned;
  std::string_view rest;
};

namespace {

// What a connection may cost: time for its requests, and bytes of them.
constexpr unsigned request_seconds = 5;
constexpr unsigned short longest_headers = 4096;
constexpr unsigned handles = 200;
constexpr unsigned header_seconds = 2;
/// Others are not logged.
constexpr std::size_t most_refusals = 20;
constexpr std::uint16_t ping_after_seconds = 15;
constexpr std::uint16_t hang_up_after_seconds = 30;

constexpr const char* forbidden =
    "This name or this origin is not allowed: see --address and --allow-origin of g4-serve.\n";

constexpr std::size_t page_index = 1;  // of the protocols
/// Clients in JavaScript may begin to listen some time after the handshake.
constexpr lws_usec_t greeting_after_us = 50'000;

void log_line(int /*level*/, const char* line) {
  try {
    logger::verbose(std::string("libwebsockets: ") + line);
  } catch (const std::exception&) {
    logger::write("out of memory\n");
  }
}

}  // namespace

/// What libwebsockets calls, all in its thread.
class web_server::callbacks {
 public:
  static int http(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t length) {
    web_server& server = of(wsi);
    auto** const left = static_cast<reply**>(user);
    switch (reason) {
      case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
        return guarded([&] { return server.waiting_.add(wsi), 0; });
      case LWS_CALLBACK_FILTER_HTTP_CONNECTION:
      case LWS_CALLBACK_WSI_DESTROY:
        server.waiting_.remove(wsi);
        return 0;
      case LWS_CALLBACK_HTTP:
        return guarded([&] { return answer(server, wsi, *left, text_of(in, length)); });
      case LWS_CALLBACK_HTTP_WRITEABLE:
        return guarded([&] { return send(server, wsi, *left); });
      case LWS_CALLBACK_HTTP_BODY:  // nobody wants it
      case LWS_CALLBACK_HTTP_BODY_COMPLETION:
      case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:  // a WebSocket without a protocol of ours
        return -1;
      case LWS_CALLBACK_CLOSED_HTTP:
      case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
        if (left != nullptr) delete std::exchange(*left, nullptr);
        return 0;
      case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        if (server.has_news_.exchange(false)) {
          server.clients_.for_each_ready(
              [](void* socket) { lws_callback_on_writable(static_cast<lws*>(socket)); });
        }
        return 0;
      default:
        return 0;
    }
  }

  static int socket(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                    std::size_t length) {
    web_server& server = of(wsi);
    auto*& open = *static_cast<connection**>(user);
    switch (reason) {
      case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        server.waiting_.remove(wsi);
        return guarded([&] { return is_allowed(server, wsi) ? 0 : refuse(wsi); });
      case LWS_CALLBACK_ESTABLISHED:
        return guarded([&] { return begin(server, wsi, open); });
      case LWS_CALLBACK_TIMER:
        open->is_due = true;
        return lws_callback_on_writable(wsi) < 0 ? -1 : 0;
      case LWS_CALLBACK_RECEIVE:
        return guarded([&] { return receive(server, wsi, *open, text_of(in, length)); });
      case LWS_CALLBACK_SERVER_WRITEABLE:
        return guarded([&] { return write(server, wsi, *open); });
      case LWS_CALLBACK_CLOSED:
        if (open != nullptr) {
          server.clients_.disconnect(open->client);
          delete std::exchange(open, nullptr);
        }
        return 0;
      default:
        return 0;
    }
  }

 private:
  static web_server& of(lws* wsi) {
    return *static_cast<web_server*>(lws_context_user(lws_get_context(wsi)));
  }
  static std::string_view text_of(const void* in, std::size_t length) {
    return {static_cast<const char*>(in), in == nullptr ? 0 : length};
  }
  /// Without memory the connection is closed.
  template <class Function>
  static int guarded(Function function) noexcept {
    try {
      return function();
    } catch (const std::exception&) {
      return -1;
    }
  }
  static bool is_allowed(web_server& server, lws* wsi) {
    const std::string why =
        server.guard_.objection(header(wsi, WSI_TOKEN_HOST), header(wsi, WSI_TOKEN_ORIGIN));
    const bool is_new = server.refused_.size() < most_refusals && !why.empty();
    if (is_new && server.refused_.insert(why).second) logger::info(why + ".\n");
    return why.empty();
  }

  // ---- HTTP -----------------------------------------------------------------------------------

  static int answer(web_server& server, lws* wsi, reply*& left, std::string_view path) {
    if (!is_allowed(server, wsi)) {
      return respond(server, wsi, left, HTTP_STATUS_FORBIDDEN, "text/plain", share(forbidden));
    }
    if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) == 0 && !is_head(wsi)) {
      return respond(server, wsi, left, HTTP_STATUS_METHOD_NOT_ALLOWED, "text/plain",
                     share("GET and HEAD only.\n"));
    }
    if (path == "/status.json") {
      return respond(server, wsi, left, HTTP_STATUS_OK, "application/json",
                     server.clients_.status());
    }
    const auto files = page_files();
    const auto file = std::ranges::find(files, path, &page_file::path);
    if (file == files.end()) {
      return respond(server, wsi, left, HTTP_STATUS_NOT_FOUND, "text/plain", share("Not found.\n"));
    }
    return respond(server, wsi, left, HTTP_STATUS_OK, file->type, nullptr, file->content);
  }

  static bool is_head(lws* wsi) { return lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0; }

  /// The answer to a handshake.
  static int refuse(lws* wsi) {
    lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, forbidden);
    return -1;
  }

  /// The header; the rest follows in send().
  static int respond(web_server& server, lws* wsi, reply*& left, unsigned status,
                     std::string_view type, const shared_bytes& owned,
                     std::string_view content = {}) {
    if (owned) content = {reinterpret_cast<const char*>(owned->data()), owned->size()};
    const bool is_all = is_head(wsi);
    if (!write_head(wsi, status, std::string(type), content.size())) return -1;
    if (is_all) return finish(server, wsi);
    delete std::exchange(left, new reply{owned, content});
    lws_callback_on_writable(wsi);
    return 0;
  }

  static int finish(web_server& server, lws* wsi) {
    if (lws_http_transaction_completed(wsi) != 0) return -1;
    server.waiting_.add(wsi);
    return 0;
  }

  static int send(web_server& server, lws* wsi, reply*& left) {
    if (left == nullptr) return 0;
    constexpr std::size_t longest = 16'384;
    const std::string_view piece = left->rest.substr(0, longest);
    left->rest.remove_prefix(piece.size());
    unsigned char* const begin = room(server, piece.size());
    std::ranges::copy(piece, begin);
    const bool is_last = left->rest.empty();
    if (lws_write(wsi, begin, piece.size(), is_last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0) {
      return -1;
    }
    if (!is_last) {
      lws_callback_on_writable(wsi);
      return 0;
    }
    delete std::exchange(left, nullptr);
    return finish(server, wsi);
  }

  // ---- WebSockets -----------------------------------------------------------------------------

  static int begin(web_server& server, lws* wsi, connection*& open) {
    const bool is_page = lws_get_protocol(wsi)->id == page_index;
    auto made = std::make_unique<connection>();
    made->client =
        server.clients_.connect(is_page ? client_kind::page : client_kind::foxglove, wsi);
    if (made->client == nullptr) return close(wsi, LWS_CLOSE_STATUS_UNEXPECTED_CONDITION, "full");
    open = made.release();
    lws_set_timer_usecs(wsi, greeting_after_us);
    return 0;
  }

  static int receive(web_server& server, lws* wsi, connection& open, std::string_view piece) {
    if (lws_frame_is_binary(wsi) != 0) {
      return close(wsi, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, "texts only");
    }
    if (open.received.size() + piece.size() > longest_request) {
      return close(wsi, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "too long");
    }
    open.received += piece;
    if (lws_is_final_fragment(wsi) == 0 || lws_remaining_packet_payload(wsi) > 0) return 0;
    const std::string text = std::exchange(open.received, {});
    if (!server.clients_.receive(*open.client, text)) {
      return close(wsi, LWS_CLOSE_STATUS_PROTOCOL_ERR, "not a request");
    }
    if (server.clients_.has_more(*open.client)) lws_callback_on_writable(wsi);
    return 0;
  }

  static int write(web_server& server, lws* wsi, const connection& open) {
    const auto message = open.is_due ? server.clients_.take(*open.client) : std::nullopt;
    if (!message) return 0;
    unsigned char* const begin = room(server, message->size());
    const auto after = std::copy_n(message->prefix.begin(), message->prefix_size, begin);
    std::ranges::copy(*message->payload, after);
    const auto kind = message->is_text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY;
    if (lws_write(wsi, begin, message->size(), kind) < 0) return -1;
    if (server.clients_.has_more(*open.client)) lws_callback_on_writable(wsi);
    return 0;
  }

  static int close(lws* wsi, lws_close_status why, std::string_view words) {
    std::array<unsigned char, 32> text{};
    std::ranges::copy(words.substr(0, text.size()), text.begin());
    lws_close_reason(wsi, why, text.data(), words.size());
    return -1;
  }

  /// Memory for a message, behind the bytes that libwebsockets wants before it.
  static unsigned char* room(web_server& server, std::size_t size) {
    if (server.scratch_.size() < LWS_PRE + size) server.scratch_.resize(LWS_PRE + size);
    return server.scratch_.data() + LWS_PRE;
  }
};

web_server::web_server(const std::string& address, std::uint16_t port,
                       std::vector<std::string> origins, hub& clients)
    : address_(address), port_(port), guard_(address, std::move(origins)), clients_(clients) {
  check_listening(address, port);
  lws_set_log_level(LLL_ERR | LLL_WARN, log_line);
  constexpr std::size_t rx = 4096;
  static const std::array<lws_protocols, 5> protocols{{
      {"http", callbacks::http, sizeof(reply*), 0, 0, nullptr, 0},
      {page_subprotocol, callbacks::socket, sizeof(connection*), rx, page_index, nullptr, 0},
      {foxglove_subprotocols[0], callbacks::socket, sizeof(connection*), rx, 2, nullptr, 0},
      {foxglove_subprotocols[1], callbacks::socket, sizeof(connection*), rx, 3, nullptr, 0},
      {nullptr, nullptr, 0, 0, 0, nullptr, 0},
  }};
  static const lws_retry_bo_t patience{.retry_ms_table = nullptr,
                                       .retry_ms_table_count = 0,
                                       .conceal_count = 0,
                                       .secs_since_valid_ping = ping_after_seconds,
                                       .secs_since_valid_hangup = hang_up_after_seconds,
                                       .jitter_percent = 0};
  lws_context_creation_info info{};
  info.port = port;
  info.iface = address_.c_str();
  info.protocols = protocols.data();
  info.user = this;
  info.gid = -1;  // as this process
  info.uid = -1;
  info.options =
      LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_SKIP_SERVER_CANONICAL_NAME;
  if (address.find(':') == std::string::npos) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  info.max_http_header_data = longest_headers;
  info.max_http_header_pool = handles;
  info.timeout_secs_ah_idle = header_seconds;
  info.timeout_secs = request_seconds;
  info.keepalive_timeout = static_cast<int>(request_seconds);
  info.fd_limit_per_thread = handles;
  info.server_string = "g4-serve";
  info.retry_and_idle_policy = &patience;
  context_ = lws_create_context(&info);
  lws_vhost* const host =
      context_ == nullptr ? nullptr : lws_get_vhost_by_name(context_, "default");
  const int listening = host == nullptr ? 0 : lws_get_vhost_listen_port(host);
  if (listening <= 0) {
    if (context_ != nullptr) lws_context_destroy(context_);
    throw failure(exit_code::internal,
                  fmt::format("libwebsockets cannot listen at port {} of {}.", port, address));
  }
  port_ = static_cast<std::uint16_t>(listening);
  thread_ = std::thread([this] { run(); });
}

web_server::~web_server() {
  stops_ = true;
  lws_cancel_service(context_);
  thread_.join();
  lws_context_destroy(context_);
}

void web_server::run() noexcept {
  while (!stops_ && lws_service(context_, 0) >= 0) continue;
}

std::vector<std::string> web_server::urls() const {
  std::vector<std::string> all;
  for (const std::string& host : hosts_of(address_)) {
    all.push_back(fmt::format("http://{}:{}/", host, port_));
  }
  return all;
}

void web_server::wake() noexcept {
  if (!has_news_.exchange(true)) lws_cancel_service(context_);
}

}  // namespace g4_tool
