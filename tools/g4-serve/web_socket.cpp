// SPDX-License-Identifier: MIT
#include "web_socket.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "client_json.hpp"

namespace g4_tool {
namespace {

/// Until the first message, because clients in JavaScript may listen only some time after the handshake.
constexpr lws_usec_t first_message_delay_us = 50'000;
constexpr int most_waits = 20;

}  // namespace

web_socket::web_socket(client_registry& clients, client_kind kind, lws* wsi)
    : clients_(clients), kind_(kind), wsi_(wsi) {
  has_place();
  lws_set_timer_usecs(wsi_, first_message_delay_us);
}

bool web_socket::has_place() {
  if (client_ == nullptr && !has_ended_) client_ = clients_.connect(kind_, wsi_);
  return client_ != nullptr;
}

int web_socket::check_timer() {
  if (has_ended_) return 0;
  if (!has_place() && ++waits_ < most_waits) {
    lws_set_timer_usecs(wsi_, first_message_delay_us);
    return 0;
  }
  may_send_ = true;
  return lws_callback_on_writable(wsi_) < 0 ? -1 : 0;
}

int web_socket::receive(std::string_view piece) {
  if (has_ended_) return 0;
  if (!has_place()) return refuse();
  if (lws_frame_is_binary(wsi_) != 0) {
    return close(LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, "texts only");
  }
  if (received_.size() + piece.size() > longest_request) {
    return close(LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "too long");
  }
  received_ += piece;
  if (lws_is_final_fragment(wsi_) == 0 || lws_remaining_packet_payload(wsi_) > 0) return 0;
  const std::string text = std::exchange(received_, {});
  if (!clients_.receive(*client_, text)) {
    return close(LWS_CLOSE_STATUS_PROTOCOL_ERR, "not a request");
  }
  if (clients_.has_more(*client_)) lws_callback_on_writable(wsi_);
  return 0;
}

int web_socket::write(std::vector<std::uint8_t>& scratch) {
  if (has_ended_ || !may_send_) return 0;
  if (!has_place()) return refuse();
  const auto message = clients_.take(*client_);
  if (!message) return 0;
  // libwebsockets writes its header before the message.
  if (scratch.size() < LWS_PRE + message->size()) scratch.resize(LWS_PRE + message->size());
  unsigned char* const begin = scratch.data() + LWS_PRE;
  const auto after = std::copy_n(message->prefix.begin(), message->prefix_size, begin);
  std::ranges::copy(*message->payload, after);
  const auto kind = message->is_text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY;
  if (lws_write(wsi_, begin, message->size(), kind) < 0) return -1;
  if (clients_.has_more(*client_)) lws_callback_on_writable(wsi_);
  return 0;
}

void web_socket::end() {
  if (client_ != nullptr) clients_.disconnect(std::exchange(client_, nullptr));
  has_ended_ = true;
}

int web_socket::close(lws_close_status why, std::string_view words) {
  std::array<unsigned char, 123> text{};  // the most that fits
  words = words.substr(0, text.size());
  std::ranges::copy(words, text.begin());
  lws_close_reason(wsi_, why, text.data(), words.size());
  end();
  return -1;
}

int web_socket::refuse() {
  constexpr auto try_again_later = static_cast<lws_close_status>(1013);
  return close(try_again_later,
               fmt::format("the server has {} clients already", client_registry::most_clients));
}

}  // namespace g4_tool
