// SPDX-License-Identifier: MIT
#include "socket_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>
#include <memory>
#include <utility>

#include "cli/logger.hpp"
#include "http_request.hpp"
#include "web_socket.hpp"

namespace g4_tool {
namespace {

constexpr unsigned close_seconds = 5;
/// Its limit of descriptors: the sockets, those handed over when it was almost full, and its own.
constexpr unsigned most_descriptors = socket_server::most_sockets + 100;
constexpr std::uint16_t ping_after_seconds = 15;
constexpr std::uint16_t hang_up_after_seconds = 30;
constexpr std::size_t page_index = 1;  // of the protocols

constexpr std::array subprotocols_of_ours{page_subprotocol, foxglove_subprotocols[0],
                                          foxglove_subprotocols[1]};

void log_line(int /*level*/, const char* line) {
  // Each adoption is logged as an error.
  if (std::string_view(line).find("adopt_socket_readbuf") != std::string_view::npos) return;
  try {
    logger::verbose(std::string("libwebsockets: ") + line);
  } catch (const std::exception&) {
    logger::write("out of memory\n");
  }
}

}  // namespace

/// The callbacks of libwebsockets, all in its thread.
class socket_server::callbacks {
 public:
  /// For the server, and for connections before their upgrade to a WebSocket.
  static int server(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* /*in*/,
                    std::size_t /*length*/) {
    switch (reason) {
      case LWS_CALLBACK_WSI_CREATE:
        ++of(wsi).sockets_;
        return 0;
      case LWS_CALLBACK_WSI_DESTROY:  // also of WebSockets
        --of(wsi).sockets_;
        return 0;
      case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        if (of(wsi).has_news_.exchange(false)) {
          of(wsi).clients_.for_each_ready(
              [](void* socket) { lws_callback_on_writable(static_cast<lws*>(socket)); });
        }
        return 0;
      case LWS_CALLBACK_HTTP:  // adopted connections request WebSockets only
      case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return -1;
      default:
        return 0;
    }
  }

  static int socket(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                    std::size_t length) {
    auto** const open = static_cast<web_socket**>(user);
    if (reason == LWS_CALLBACK_ESTABLISHED) {
      return guarded([&] { return begin(of(wsi), wsi, *open); });
    }
    if (open == nullptr || *open == nullptr) return is_for_open(reason) ? -1 : 0;
    switch (reason) {
      case LWS_CALLBACK_TIMER:
        return guarded([&] { return (*open)->check_timer(); });
      case LWS_CALLBACK_RECEIVE:
        return guarded([&] {
          return (*open)->receive({static_cast<const char*>(in), in == nullptr ? 0 : length});
        });
      case LWS_CALLBACK_SERVER_WRITEABLE:
        return guarded([&] { return (*open)->write(of(wsi).scratch_); });
      case LWS_CALLBACK_WS_PEER_INITIATED_CLOSE:
        (*open)->end();
        return 0;
      case LWS_CALLBACK_CLOSED:
        delete std::exchange(*open, nullptr);
        return 0;
      default:
        return 0;
    }
  }

 private:
  static socket_server& of(lws* wsi) {
    return *static_cast<socket_server*>(lws_context_user(lws_get_context(wsi)));
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
  static int begin(socket_server& server, lws* wsi, web_socket*& open) {
    const bool is_page = lws_get_protocol(wsi)->id == page_index;
    const auto kind = is_page ? client_kind::page : client_kind::foxglove;
    open = std::make_unique<web_socket>(server.clients_, kind, wsi).release();
    return 0;
  }
  /// Whether the callback needs a web_socket; it is missing if begin() had no memory for it.
  static bool is_for_open(lws_callback_reasons reason) {
    return reason == LWS_CALLBACK_TIMER || reason == LWS_CALLBACK_RECEIVE ||
           reason == LWS_CALLBACK_SERVER_WRITEABLE;
  }
};

socket_server::socket_server(client_registry& clients) : clients_(clients) {
  lws_set_log_level(LLL_ERR | LLL_WARN, log_line);
  constexpr std::size_t rx = 4096;
  static const std::array<lws_protocols, 5> protocols{{
      {"http", callbacks::server, 0, 0, 0, nullptr, 0},
      {subprotocols_of_ours[0], callbacks::socket, sizeof(web_socket*), rx, page_index, nullptr, 0},
      {subprotocols_of_ours[1], callbacks::socket, sizeof(web_socket*), rx, 2, nullptr, 0},
      {subprotocols_of_ours[2], callbacks::socket, sizeof(web_socket*), rx, 3, nullptr, 0},
      {nullptr, nullptr, 0, 0, 0, nullptr, 0},
  }};
  static const lws_retry_bo_t validity{.retry_ms_table = nullptr,
                                       .retry_ms_table_count = 0,
                                       .conceal_count = 0,
                                       .secs_since_valid_ping = ping_after_seconds,
                                       .secs_since_valid_hangup = hang_up_after_seconds,
                                       .jitter_percent = 0};
  lws_context_creation_info info{};
  info.port = CONTEXT_PORT_NO_LISTEN_SERVER;
  info.protocols = protocols.data();
  info.user = this;
  info.gid = static_cast<decltype(info.gid)>(-1);  // as this process
  info.uid = static_cast<decltype(info.uid)>(-1);
  info.options = LWS_SERVER_OPTION_SKIP_SERVER_CANONICAL_NAME;
  info.timeout_secs = close_seconds;
  info.fd_limit_per_thread = most_descriptors;
  info.server_string = "g4-serve";
  info.retry_and_idle_policy = &validity;
  errno = 0;
  context_ = lws_create_context(&info);
  const int why = errno;
  host_ = context_ == nullptr ? nullptr : lws_get_vhost_by_name(context_, "default");
  if (host_ == nullptr) {
    if (context_ != nullptr) lws_context_destroy(context_);
    throw refused_by_system("libwebsockets cannot start", why);
  }
  thread_ = std::thread([this] { run(); });
}

socket_server::~socket_server() {
  stops_ = true;
  lws_cancel_service(context_);
  thread_.join();
  lws_context_destroy(context_);
}

std::string_view socket_server::choose(std::string_view subprotocols) {
  const auto found = std::ranges::find_if(
      subprotocols_of_ours, [&](const char* each) { return has_element(subprotocols, each); });
  return found == subprotocols_of_ours.end() ? std::string_view() : *found;
}

void socket_server::adopt(socket_fd socket, std::string first) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({std::move(socket), std::move(first)});
  }
  lws_cancel_service(context_);
}

void socket_server::adopt_all() {
  std::vector<adoption> all;
  {
    const std::lock_guard lock(mutex_);
    all.swap(waiting_);
  }
  for (adoption& each : all) {
    // It closes the socket if it fails.
    lws_adopt_socket_vhost_readbuf(host_, each.socket.release(), each.first.data(),
                                   each.first.size());
  }
}

void socket_server::run() noexcept {
  while (!stops_ && lws_service(context_, 0) >= 0) adopt_all();
}

void socket_server::wake() noexcept {
  if (!has_news_.exchange(true)) lws_cancel_service(context_);
}

}  // namespace g4_tool
