// SPDX-License-Identifier: MIT
// The time of each byte is counted from the begin of its sequence, so that rounding errors do not
// accumulate.
#include "sim/exact.hpp"

#include "wire.hpp"

#include <algorithm>

namespace g4lidar::sim {

void transmission::assign(bytes content) noexcept {
  const std::size_t fits = std::min(content.size(), data.size());
  std::copy_n(content.begin(), fits, data.begin());
  size = static_cast<std::uint8_t>(fits);
  begin = 0;
  count = 0;
  zero = false;
  damaged = false;
}

void transmission::assign(const sent_packet& sent, std::optional<std::uint8_t> stray) noexcept {
  begin = stray ? 1 : 0;
  if (stray) data[0] = *stray;
  std::copy(sent.data.begin(), sent.data.end(), data.begin() + begin);
  size = static_cast<std::uint8_t>(begin + sent.data.size());
  count = static_cast<std::uint8_t>(sent.samples.size());
  zero = (sent.data[2] & 1U) != 0;
  damaged = false;
  std::copy(sent.samples.begin(), sent.samples.end(), truths.begin());
}

void wire::send(bytes content, std::int64_t now_ns) noexcept {
  if (queue_.full()) return;
  queue_.push().assign(content);
  if (!busy_) begin(now_ns);
}

void wire::send(const transmission& sending, std::int64_t now_ns) noexcept {
  if (queue_.full()) return;
  transmission& to = queue_.push();
  to.data = sending.data;
  to.size = sending.size;
  to.begin = sending.begin;
  to.count = sending.count;
  to.zero = sending.zero;
  to.damaged = sending.damaged;
  to.packet = sending.packet;
  std::copy_n(sending.truths.begin(), sending.count, to.truths.begin());
  if (!busy_) begin(now_ns);
}

void wire::interject(const answer_bytes& answer, std::int64_t now_ns) noexcept {
  urgent_.push(answer);
  if (!busy_) begin(now_ns);
}

void wire::begin(std::int64_t now_ns) noexcept {
  begin_ns_ = now_ns;
  sent_ = 0;
  take_byte();
}

void wire::take_byte() noexcept {
  busy_ = !urgent_.empty() || !queue_.empty();
  next_ns_ = forever_ns;
  if (!busy_) return;
  from_queue_ = urgent_.empty();
  if (from_queue_) {
    byte_ = queue_.front().data[at_++];
  } else {
    byte_ = urgent_.front().data[urgent_at_++];
    if (!queue_.empty() && at_ > queue_.front().begin) damage();
  }
  ++sent_;
  next_ns_ = begin_ns_ + (sent_ * 10'000'000'000 + baud_ - 1) / baud_;
}

bool wire::in_packet() const noexcept {
  return from_queue_ && queue_.front().count > 0 && at_ > queue_.front().begin;
}

bool wire::inside_packet() const noexcept {
  return in_packet() && at_ > queue_.front().begin + std::size_t{1};
}

const transmission* wire::ending() const noexcept {
  return from_queue_ && at_ == queue_.front().size ? &queue_.front() : nullptr;
}

void wire::advance() noexcept {
  if (from_queue_) {
    if (at_ == queue_.front().size) {
      queue_.pop();
      at_ = 0;
    }
  } else if (urgent_at_ == urgent_.front().size) {
    urgent_.pop();
    urgent_at_ = 0;
  }
  take_byte();
}

void wire::cut_front() noexcept {
  if (queue_.empty() || at_ == 0 || at_ == queue_.front().size) return;
  transmission& front = queue_.front();
  front.damaged = front.damaged || front.count > 0;
  front.size = static_cast<std::uint8_t>(at_);
  if (busy_ && from_queue_) return;  // its last byte is being sent
  queue_.pop();
  at_ = 0;
}

void wire::cut(bool at_once) noexcept {
  queue_.keep(at_ > 0 ? 1 : 0);
  if (at_once) cut_front();
}

void wire::reset() noexcept {
  queue_.clear();
  urgent_.clear();
  at_ = 0;
  urgent_at_ = 0;
  busy_ = false;
  next_ns_ = forever_ns;
}

}  // namespace g4lidar::sim
