// SPDX-License-Identifier: MIT
// A WebSocket, from its handshake. For web_server.cpp alone.
#pragma once

#include <fmt/format.h>

#include <array>
#include <boost/beast/core/flat_static_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "beast.hpp"
#include "client_json.hpp"
#include "client_registry.hpp"

namespace g4_tool {

/// Becomes a client of the client registry, if a place is free or becomes free within a second, because clients that
/// have just ended may still be counted. Otherwise it is closed with the reason. Pending operations own it.
/// *Single thread.*
class web_socket : public std::enable_shared_from_this<web_socket> {
 public:
  /// `count`: of all of them.
  web_socket(tcp_stream stream, client_registry& clients, std::size_t& count)
      : stream_(std::move(stream)),
        timer_(stream_.get_executor()),
        clients_(clients),
        count_(count) {
    ++count_;
  }
  web_socket(const web_socket&) = delete;
  web_socket& operator=(const web_socket&) = delete;
  ~web_socket() {
    end();
    --count_;
  }

  /// `handshake`: a whole request with this subprotocol, and the bytes that followed the client's own request.
  void accept(const std::string& handshake, std::string_view subprotocol) {
    kind_ = subprotocol == page_subprotocol ? client_kind::page : client_kind::foxglove;
    stream_.set_option(websocket::stream_base::timeout{close_timeout, idle_timeout, true});
    stream_.set_option(websocket::stream_base::decorator(
        [chosen = std::string(subprotocol)](websocket::response_type& answer) {
          answer.set(http::field::sec_websocket_protocol, chosen);
          answer.set(http::field::server, "g4-serve");
        }));
    stream_.auto_fragment(false);
    stream_.read_message_max(longest_request);
    stream_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      if (kind == websocket::frame_type::close) end();
    });
    stream_.async_accept(asio::buffer(handshake), [self = shared_from_this()](error_code why) {
      if (why) return;
      self->has_place();
      self->wait();
      self->read();
    });
  }

  /// Sends the next message, unless one is being sent.
  void write() {
    if (has_ended_ || !may_send_ || sent_) return;
    if (!has_place()) return refuse();
    sent_ = clients_.take(*client_);
    if (!sent_) return;
    stream_.text(sent_->is_text);
    stream_.async_write(
        std::array{asio::const_buffer(sent_->prefix.data(), sent_->prefix_size),
                   asio::const_buffer(sent_->payload->data(), sent_->payload->size())},
        [self = shared_from_this()](error_code why, std::size_t) {
          self->sent_.reset();
          why ? self->end() : self->write();
        });
  }

 private:
  /// Until the first message, because clients in JavaScript may listen only some time after the handshake.
  static constexpr auto first_message_delay = std::chrono::milliseconds(50);
  static constexpr int most_waits = 20;
  static constexpr auto close_timeout = std::chrono::seconds(5);
  /// After half of it a ping is sent.
  static constexpr auto idle_timeout = std::chrono::seconds(30);

  bool has_place() {
    if (client_ == nullptr && !has_ended_) client_ = clients_.connect(kind_, this);
    return client_ != nullptr;
  }

  void wait() {
    timer_.expires_after(first_message_delay);
    timer_.async_wait([self = shared_from_this()](error_code why) {
      if (why || self->has_ended_) return;
      if (!self->has_place() && ++self->waits_ < most_waits) return self->wait();
      self->may_send_ = true;
      self->write();
    });
  }

  void read() {
    stream_.async_read(received_, [self = shared_from_this()](error_code why, std::size_t) {
      why ? self->end() : self->take();
    });
  }

  void take() {
    if (has_ended_) return;
    if (!has_place()) return refuse();
    if (!stream_.got_text()) return close(websocket::close_code::unknown_data, "texts only");
    const std::string_view text(static_cast<const char*>(received_.data().data()),
                                received_.size());
    if (!clients_.receive(*client_, text)) {
      return close(websocket::close_code::protocol_error, "not a request");
    }
    received_.clear();
    write();
    read();
  }

  /// Disconnects it from the client registry.
  void end() {
    if (client_ != nullptr) clients_.disconnect(std::exchange(client_, nullptr));
    has_ended_ = true;
  }

  void close(websocket::close_code why, std::string_view words) {
    end();
    stream_.async_close({why, beast::string_view(words.data(), words.size())},
                        [self = shared_from_this()](error_code) {});
  }

  void refuse() {
    close(websocket::close_code::try_again_later,
          fmt::format("the server has {} clients already", client_registry::most_clients));
  }

  websocket::stream<tcp_stream, false> stream_;
  deadline timer_;
  client_registry& clients_;
  std::size_t& count_;
  client_kind kind_ = client_kind::page;
  client_registry::client* client_ = nullptr;
  beast::flat_static_buffer<longest_request> received_;
  std::optional<outgoing> sent_;  // the message that is being sent
  int waits_ = 0;                 // for a place
  bool may_send_ = false;
  bool has_ended_ = false;
};

}  // namespace g4_tool
