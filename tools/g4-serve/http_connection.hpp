// SPDX-License-Identifier: MIT
// A connection that speaks HTTP/1 with small answers, until it becomes a WebSocket. For web_server.cpp alone.
#pragma once

#include <fmt/format.h>
#include <sys/socket.h>

#include <array>
#include <boost/beast/core/buffers_suffix.hpp>
#include <boost/beast/core/flat_static_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/status.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "beast.hpp"
#include "outbox.hpp"

namespace g4_tool {

/// The answer to a request.
struct http_answer {
  static constexpr unsigned is_socket = 101;

  /// is_socket: the connection is handed over.
  unsigned status;
  std::string_view type = "text/plain";
  shared_bytes owned{};
  std::string_view content{};  ///< Instead of `owned`: static bytes.
  std::string policy = "default-src 'none'";
};

/// Answers each request when its head is complete, within limits of size and time, and never reads a body. Pending
/// operations own it. *Single thread.*
class http_connection : public std::enable_shared_from_this<http_connection> {
 public:
  using clock = std::chrono::steady_clock;
  using list = std::list<http_connection*>;
  struct callbacks {
    std::function<http_answer(const http_request&)> answer;
    /// Takes over a connection. `rest`: the bytes that followed the request.
    std::function<void(tcp_stream, const http_request&, std::string_view rest)> hand_over;
  };

  /// `all`: where it is until it ends, by the last progress, the oldest first.
  http_connection(tcp_stream::socket_type socket, list& all, const callbacks& handlers)
      : stream_(std::move(socket)),
        all_(all),
        place_(all.insert(all.end(), this)),
        callbacks_(handlers) {}
  http_connection(const http_connection&) = delete;
  http_connection& operator=(const http_connection&) = delete;
  ~http_connection() {
    if (ended_.empty()) all_.erase(place_);
  }

  [[nodiscard]] clock::time_point last_progress() const noexcept { return since_; }
  /// Ends it, and removes it from the list.
  void end() {
    stream_.close();
    ended_.splice(ended_.end(), all_, place_);
  }

  void read_request() {
    skips_line_ = true;
    make_progress(progress_timeout);
    read_head();
  }

 private:
  static constexpr std::size_t longest_head = 4096;
  /// The longest time for a request, and for progress of an answer.
  static constexpr auto progress_timeout = std::chrono::seconds(5);
  /// The longest time in which the client reads the last answer before the connection is closed.
  static constexpr auto linger_timeout = std::chrono::seconds(2);

  void make_progress(std::chrono::seconds timeout) {
    since_ = clock::now();
    if (ended_.empty()) all_.splice(all_.end(), all_, place_);
    stream_.expires_after(timeout);
  }

  [[nodiscard]] std::string_view received() const {
    return {static_cast<const char*>(received_.data().data()), received_.size()};
  }

  void read_head() {
    parser_ = std::make_unique<parser>();
    parser_->header_limit(longest_head);
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // no body is read
    http::async_read_header(
        stream_, received_, *parser_,
        [self = shared_from_this()](error_code why, std::size_t) { self->take_head(why); });
  }

  void take_head(error_code why) {
    // RFC 9112, 2.2: an empty line may precede a request.
    if (why == http::error::bad_method && received().starts_with("\r\n") &&
        std::exchange(skips_line_, false)) {
      received_.consume(2);
      return read_head();
    }
    const bool is_long = why == http::error::header_limit || why == http::error::buffer_overflow;
    if (why && !is_long &&
        (why.category() != make_error_code(http::error::bad_method).category() ||
         why == http::error::end_of_stream || why == http::error::partial_message)) {
      return;
    }
    const http_request& request = parser_->get();
    http_answer answer{.status = is_long ? 431U : 400U};
    if (why) {
      answer.content = is_long ? "The request is too long.\n" : "This is no request of HTTP/1.1.\n";
    } else {
      answer = callbacks_.answer(request);
    }
    if (answer.status == http_answer::is_socket) {
      stream_.expires_never();
      return callbacks_.hand_over(std::move(stream_), request, received());
    }
    keeps_open_ = !why && parser_->keep_alive() && request.version() == 11 && !has_body();
    write_answer(answer, !why && request.method() == http::verb::head);
  }

  [[nodiscard]] bool has_body() const {
    return parser_->chunked() || parser_->content_length().value_or(0) > 0;
  }

  void write_answer(const http_answer& answer, bool is_head) {
    asio::const_buffer content(answer.content.data(), answer.content.size());
    if (answer.owned) content = {answer.owned->data(), answer.owned->size()};
    owned_ = answer.owned;
    head_ = fmt::format(
        "HTTP/1.1 {} {}\r\ncontent-type: {}\r\ncontent-length: {}\r\nserver: g4-serve\r\n"
        "connection: {}\r\n{}{}cache-control: no-store\r\nx-content-type-options: nosniff\r\n"
        "x-frame-options: DENY\r\nreferrer-policy: no-referrer\r\n"
        "cross-origin-opener-policy: same-origin\r\ncross-origin-resource-policy: same-origin\r\n"
        "content-security-policy: {}\r\n\r\n",
        answer.status, std::string(http::obsolete_reason(http::int_to_status(answer.status))),
        answer.type, content.size(), keeps_open_ ? "keep-alive" : "close",
        answer.status == 405 ? "allow: GET, HEAD\r\n" : "",
        answer.status == 426 ? "upgrade: websocket\r\nsec-websocket-version: 13\r\n" : "",
        answer.policy);
    unsent_ = beast::buffers_suffix<buffers>(
        buffers{asio::buffer(head_), is_head ? asio::const_buffer() : content});
    write();
  }

  void write() {
    make_progress(progress_timeout);
    stream_.async_write_some(unsent_,
                             [self = shared_from_this()](error_code why, std::size_t sent) {
                               if (why) return;
                               self->unsent_.consume(sent);
                               const bool has_more = asio::buffer_size(self->unsent_) > 0;
                               has_more ? self->write() : self->finish_answer();
                             });
  }

  void finish_answer() {
    owned_.reset();
    if (keeps_open_) return read_request();
    // If the socket were closed at once, with unread bytes, the client could lose the answer.
    ::shutdown(stream_.socket().native_handle(), SHUT_WR);
    make_progress(linger_timeout);
    linger();
  }

  void linger() {
    received_.clear();
    stream_.async_read_some(received_.prepare(longest_head),
                            [self = shared_from_this()](error_code why, std::size_t) {
                              if (!why) self->linger();
                            });
  }

  using parser = http::request_parser<http::empty_body>;
  using buffers = std::array<asio::const_buffer, 2>;

  tcp_stream stream_;
  list& all_;
  list ended_;  // has it instead of `all_` after end()
  const list::iterator place_;
  const callbacks& callbacks_;
  clock::time_point since_ = clock::now();
  beast::flat_static_buffer<longest_head> received_;
  std::unique_ptr<parser> parser_ = std::make_unique<parser>();  // of one request
  bool skips_line_ = true;
  bool keeps_open_ = false;
  // The answer, while it is written.
  std::string head_;
  shared_bytes owned_;
  beast::buffers_suffix<buffers> unsent_;
};

}  // namespace g4_tool
