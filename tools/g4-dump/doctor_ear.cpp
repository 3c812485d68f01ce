// SPDX-License-Identifier: MIT
#include "doctor_ear.hpp"

#include <algorithm>
#include <variant>

namespace g4_dump {
namespace {

using namespace g4lidar;

constexpr std::int64_t ms = 1'000'000;
/// A read waits no longer, so that ^C is seen and silence is known to be one.
constexpr std::int64_t slice_ns = 50 * ms;
/// How long a second answer is waited for.
constexpr std::int64_t second_answer_ns = 35 * ms;
/// How long the right answer is waited for after a wrong one.
constexpr std::int64_t after_wrong_ns = 250 * ms;
/// So many letters in a row are the text of a boot.
constexpr std::size_t text_letters = 16;

std::size_t size_of(const event& found) noexcept {
  if (const auto* packet = std::get_if<packet_view>(&found)) return packet->data().size();
  if (const auto* response = std::get_if<response_view>(&found)) return response->data().size();
  const auto* gone = std::get_if<skipped>(&found);
  return gone == nullptr ? 0 : gone->count;
}

}  // namespace

std::optional<response_kind> answer_kind(command code) noexcept {
  const auto traits = traits_of(code);
  if (!traits) return std::nullopt;
  switch (traits->answered_by) {
    case reply::none:
      break;
    case reply::scan_started:
      return response_kind::scan_started;
    case reply::device_info:
      return response_kind::device_info;
    case reply::health:
      return response_kind::health;
    case reply::byte:
      return response_kind::byte;
    case reply::frequency:
      return response_kind::frequency;
  }
  return std::nullopt;
}

void ear::listen(const std::int64_t& until_ns, const listener& to) {
  while (!is_over() && line_) {
    interrupted_ = is_interrupted_ && is_interrupted_();
    const std::int64_t now = line_->now_ns();
    if (interrupted_ || now >= until_ns) return;
    const auto got = line_->read(buffer_, std::min(until_ns, now + slice_ns));
    if (!got) {
      if (got.error().what() == problem::cancelled) continue;
      error_ = got.error();
      finish(to);
      return;
    }
    if (got->count > 0) {
      take(got->count, got->arrival_ns, to);
      continue;
    }
    silence_ns_ += line_->now_ns() - now;
    if (parser_.held() > 0 && line_->now_ns() >= heard_ns_ + frame_pause_ns_) finish(to);
  }
}

bool ear::listen_for_quiet(std::int64_t quiet_ns, std::int64_t until_ns, const listener& to) {
  while (!is_over() && now_ns() < until_ns) {
    const std::uint64_t before = bytes_;
    const std::int64_t then = std::min(now_ns() + quiet_ns, until_ns);
    listen(then, to);
    if (bytes_ == before && now_ns() >= heard_ns_ + quiet_ns) {
      finish(to);
      return true;
    }
  }
  return false;
}

void ear::send(command code) {
  if (is_over() || !line_) return;
  const auto sent = line_->write(encode(code), line_->now_ns() + 500 * ms);
  if (!sent && sent.error().what() != problem::cancelled) error_ = sent.error();
}

exchange ear::ask(command code, std::int64_t patience_ns) {
  exchange made;
  made.asked = code;
  const auto kind = answer_kind(code);
  const std::uint64_t boots_before = boots_;
  send(code);
  made.asked_ns = now_ns();
  std::int64_t until_ns = made.asked_ns + patience_ns;
  listener to;
  to.event = [&](const heard& came) {
    if (std::holds_alternative<packet_view>(came.what)) ++made.packets;
    if (const auto* gone = std::get_if<skipped>(&came.what)) made.skipped += gone->count;
    const auto* response = std::get_if<response_view>(&came.what);
    if (response == nullptr) return;
    if (response->kind() != kind) {
      ++made.wrong;
      until_ns = std::min(until_ns, came.arrival_ns + after_wrong_ns);
    } else if (made.is_answered()) {
      ++made.copies;
    } else {
      made.answered_ns = came.arrival_ns;
      made.content.assign(response->content().begin(), response->content().end());
      until_ns = came.arrival_ns + second_answer_ns;
    }
  };
  listen(until_ns, to);
  finish(to);
  made.booted = boots_ != boots_before;
  return made;
}

void ear::replace(const std::function<std::unique_ptr<transport>()>& make) {
  ended_ns_ = now_ns();
  line_.reset();
  line_ = make();
  parser_ = {};
  raw_.clear();
  raw_begin_ = 0;
  silence_ns_ = 0;
}

void ear::take(std::size_t count, std::int64_t arrival_ns, const listener& to) {
  heard_ns_ = arrival_ns;
  bytes_ += count;
  if (to.arrival) to.arrival({count, arrival_ns, silence_ns_});
  silence_ns_ = 0;
  raw_.erase(raw_.begin(), raw_.begin() + static_cast<std::ptrdiff_t>(raw_begin_));
  raw_begin_ = 0;
  raw_.insert(raw_.end(), buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(count));
  g4lidar::bytes input = g4lidar::bytes(buffer_).first(count);
  while (const auto found = parser_.next(input)) give(*found, to);
}

void ear::finish(const listener& to) {
  while (const auto found = parser_.finish()) give(*found, to);
}

void ear::give(const event& found, const listener& to) {
  const std::size_t size = std::min(size_of(found), raw_.size() - raw_begin_);
  const g4lidar::bytes raw = g4lidar::bytes(raw_).subspan(raw_begin_, size);
  raw_begin_ += size;
  const auto* gone = std::get_if<skipped>(&found);
  if (gone != nullptr && gone->reason == skip_reason::noise) {
    look_for_text(raw);
  } else {
    letters_ = 0;
    in_text_ = false;
  }
  if (to.event) to.event({found, raw, heard_ns_});
}

void ear::look_for_text(g4lidar::bytes raw) {
  for (const std::uint8_t byte : raw) {
    const bool is_letter = (byte >= 0x20 && byte < 0x7F) || byte == '\r' || byte == '\n';
    letters_ = is_letter ? letters_ + 1 : 0;
    if (letters_ == text_letters) {
      if (!in_text_) ++boots_;
      in_text_ = true;
    }
  }
  if (letters_ == 0) in_text_ = false;
}

}  // namespace g4_dump
