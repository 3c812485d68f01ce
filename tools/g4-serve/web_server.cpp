// SPDX-License-Identifier: MIT
#include "web_server.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <cerrno>
#include <exception>
#include <thread>

#include "beast.hpp"
#include "host_guard.hpp"
#include "http_answers.hpp"
#include "http_connection.hpp"
#include "listener.hpp"
#include "web_socket.hpp"

namespace g4_tool {

using namespace std::chrono_literals;

/// The thread of the server, and its connections.
class web_server::loop {
 public:
  loop(socket_fd listening, host_guard guard, client_registry& clients)
      : clients_(clients), answers_(std::move(guard), clients) {
    static_cast<void>(tries([&] { listening_.assign(asio::ip::tcp::v6(), listening.get()); }));
    static_cast<void>(listening.release());
    wait_for_connections();
    thread_ = std::thread([this] { run(); });
  }
  loop(const loop&) = delete;
  loop& operator=(const loop&) = delete;
  ~loop() {
    io_.stop();
    thread_.join();
  }

  void wake() noexcept {
    if (has_news_.exchange(true)) return;
    if (!tries([this] { asio::post(io_, [this] { send_news(); }); })) has_news_ = false;
  }

 private:
  static constexpr std::size_t most_connections = 60;
  /// A connection is not replaced earlier, because its request may be unread.
  static constexpr auto least_age = 200ms;
  /// Of WebSockets, including those that are being closed.
  static constexpr std::size_t most_sockets = 256;

  using clock = std::chrono::steady_clock;

  /// False without memory.
  template <class Function>
  static bool tries(Function function) noexcept {
    try {
      function();
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }

  void run() noexcept {
    // Without memory the operation ends that needed it, and with it its connection.
    while (!io_.stopped()) {
      tries([this] {
        if (!waits_) wait_for_connections();
        io_.run();
      });
    }
  }

  void send_news() {
    has_news_ = false;
    ready_.clear();
    clients_.for_each_ready(
        [this](void* socket) { ready_.push_back(static_cast<web_socket*>(socket)); });
    for (web_socket* const each : ready_) each->write();
  }

  // ---- new connections ----

  [[nodiscard]] clock::time_point may_accept_at() const {
    if (connections_.size() < most_connections) return accepts_at_;
    return std::max(accepts_at_, connections_.front()->last_progress() + least_age);
  }

  void wait_for_connections() {
    listening_.async_wait(listening_.wait_read, [this](error_code) {
      waits_ = false;
      // The timer ends after what has come until now was read.
      pause_.expires_at(std::max(may_accept_at(), clock::now()));
      pause_.async_wait([this](error_code) {
        waits_ = false;
        accept_all(pause_.expiry());
        wait_for_connections();
      });
      waits_ = true;
    });
    waits_ = true;
  }

  /// `now`: when all that had come was read.
  void accept_all(clock::time_point now) {
    while (may_accept_at() <= now) {
      socket_fd socket(::accept4(listening_.native_handle(), nullptr, nullptr, SOCK_CLOEXEC));
      const bool is_full = connections_.size() >= most_connections;
      // No sockets are left: end one connection and try again later.
      const bool has_none = socket.get() < 0 && (errno == EMFILE || errno == ENFILE ||
                                                 errno == ENOBUFS || errno == ENOMEM);
      if (has_none) accepts_at_ = clock::now() + least_age;
      if ((has_none && !connections_.empty()) || (socket.get() >= 0 && is_full)) {
        connections_.front()->end();
      }
      if (socket.get() < 0) return;
      static_cast<void>(tries([&] { start(std::move(socket)); }));
    }
  }

  void start(socket_fd socket) {
    const int on = 1;
    static_cast<void>(::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on)));
    tcp_stream::socket_type made(io_, asio::ip::tcp::v6(), socket.get());
    static_cast<void>(socket.release());
    std::make_shared<http_connection>(std::move(made), connections_, callbacks_)->read_request();
  }

  http_answer answer(const http_request& request) {
    http_answer made = answers_.answer(request);
    if (made.status == http_answer::is_socket && sockets_ >= most_sockets) {
      return {.status = 503, .content = "There are too many connections. Try again later.\n"};
    }
    return made;
  }

  void hand_over(tcp_stream stream, const http_request& request, std::string_view rest) {
    const std::string_view subprotocol = http_answers::subprotocol_for(request);
    const auto made = std::make_shared<web_socket>(std::move(stream), clients_, sockets_);
    made->accept(http_answers::handshake_for(request).append(rest), subprotocol);
  }

  client_registry& clients_;
  http_answers answers_;
  const http_connection::callbacks callbacks_{
      .answer = [this](const http_request& each) { return answer(each); },
      .hand_over = [this](tcp_stream stream, const http_request& request,
                          std::string_view rest) { hand_over(std::move(stream), request, rest); }};
  http_connection::list connections_;
  std::size_t sockets_ = 0;
  std::vector<web_socket*> ready_;  // while send_news() uses it
  clock::time_point accepts_at_{};  // in the future if the system had no sockets
  bool waits_ = false;              // for connections
  std::atomic<bool> has_news_ = false;
  asio::io_context io_{1};  // destroys the connections
  asio::executor_work_guard<executor> works_{io_.get_executor()};
  asio::basic_socket_acceptor<asio::ip::tcp, executor> listening_{io_};
  deadline pause_{io_};
  std::thread thread_;
};

web_server::web_server(const std::string& address, std::uint16_t port,
                       std::vector<std::string> origins, client_registry& clients)
    : address_(address) {
  socket_fd listening = listen_at(address, port);
  port_ = port_of(listening);
  try {
    loop_ = std::make_unique<loop>(std::move(listening), host_guard(address, std::move(origins)),
                                   clients);
  } catch (const boost::system::system_error& refused) {
    throw refused_by_system("the server cannot start", refused.code().value());
  }
}

web_server::~web_server() = default;

std::vector<std::string> web_server::urls() const {
  std::vector<std::string> all;
  for (const std::string& host : hosts_of(address_)) {
    all.push_back(fmt::format("http://{}:{}/", host, port_));
  }
  return all;
}

void web_server::wake() noexcept { loop_->wake(); }

}  // namespace g4_tool
