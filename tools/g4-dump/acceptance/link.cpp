// SPDX-License-Identifier: MIT
// Commands, raw replies, waits.
#include "link.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <variant>

#include "g4lidar/core/response.hpp"

namespace g4_tool::acceptance {
namespace {

constexpr std::int64_t longest_read_ns = 50 * ms;
/// A packet or response that does not continue for this time has ended.
constexpr std::int64_t cut_off_ns = 60 * ms;
constexpr std::int64_t quiet_ns = 150 * ms;
constexpr std::int64_t spin_up_ns = 12'000 * ms;

/// A revolution: when its zero packet came, and the samples until the next one.
struct revolution {
  std::int64_t begin_ns;
  double samples = 0.0;
};

/// How many of the last ones have the speed of the last second.
std::size_t steady_ones(std::span<const revolution> all, std::int64_t end_ns) {
  constexpr std::size_t fewest = 4;
  constexpr double same = 0.03;
  std::size_t last = 0;
  while (last < all.size() &&
         (last < fewest || end_ns - all[all.size() - last].begin_ns < 1'000 * ms))
    ++last;
  if (last < fewest || end_ns - all[all.size() - last].begin_ns < 1'000 * ms) return 0;
  const auto newest = all.last(last);
  const double mean =
      std::accumulate(newest.begin(), newest.end(), 0.0,
                      [](double sum, const revolution& each) { return sum + each.samples; }) /
      static_cast<double>(last);
  const auto is_other = [&](const revolution& each) {
    return std::abs(each.samples / mean - 1.0) > same;
  };
  const auto first = std::find_if(all.rbegin(), all.rend(), is_other);
  const auto count = static_cast<std::size_t>(first - all.rbegin());
  return count < last ? 0 : count;
}

}  // namespace

bytes raw_reply::content() const noexcept {
  if (begin < 0) return {};
  return bytes(data).subspan(static_cast<std::size_t>(begin) + response_header_size);
}

std::size_t raw_reply::length(std::size_t expected) const noexcept {
  if (begin < 0) return 0;
  const std::size_t stated = data[static_cast<std::size_t>(begin) + 2];
  return stated != expected ? stated : content().size();
}

std::optional<std::int32_t> raw_reply::number() const noexcept {
  const bytes all = content();
  const std::size_t stated = begin < 0 ? 0 : data[static_cast<std::size_t>(begin) + 2];
  if (stated == 1 && !all.empty()) return all[0];
  if (stated != 4 || all.size() < 4) return std::nullopt;
  return static_cast<std::int32_t>(load_u32(all, 0));
}

std::string raw_reply::text() const {
  constexpr std::size_t most = 32;
  return fmt::format("{:02x}", fmt::join(bytes(data).first(std::min(data.size(), most)), ""));
}

void lidar_link::read_as(const model& model) {
  which_ = model;
  parser_ = stream_parser(which_.samples);
  counts_ = {};
  layout_ = {};
  raw_.clear();
}

void lidar_link::listen(const std::int64_t& until_ns, const observer& to) {
  while (!is_over()) {
    is_cancelled_now_ = is_cancelled_ && is_cancelled_();
    const std::int64_t begin_ns = now_ns();
    if (is_cancelled_now_ || begin_ns >= until_ns) return;
    const auto got = port_->read(buffer_, std::min(until_ns, begin_ns + longest_read_ns));
    if (!got) {
      if (got.error() != problem::cancelled) error_ = got.error();
    } else if (got->count > 0) {
      take(bytes(buffer_).first(got->count), got->arrival_ns, to);
    } else if (parser_.held() > 0 && now_ns() - heard_ns_ >= cut_off_ns) {
      while (const auto found = parser_.finish()) give(*found, heard_ns_, to);
    }
  }
}

void lidar_link::take(bytes data, std::int64_t arrival_ns, const observer& to) {
  heard_ns_ = arrival_ns;
  layout_.take(data);
  if (on_bytes_) on_bytes_(data, arrival_ns);
  raw_.insert(raw_.end(), data.begin(), data.end());
  parser_.feed(data, [&](const event& found) { give(found, arrival_ns, to); });
}

void lidar_link::give(const event& found, std::int64_t arrival_ns, const observer& to) {
  const std::size_t size = std::min(size_of(found), raw_.size());
  const auto* const gone = std::get_if<skipped>(&found);
  const bool is_noise = gone != nullptr && gone->reason == skip_reason::noise;
  look_for_text(is_noise ? bytes(raw_).first(size) : bytes{});
  raw_.erase(raw_.begin(), raw_.begin() + static_cast<std::ptrdiff_t>(size));
  counts_.add(found);
  if (to) to(found, arrival_ns);
}

void lidar_link::look_for_text(bytes noise) {
  constexpr std::size_t enough = 16;
  if (noise.empty()) letters_ = 0;
  for (const std::uint8_t byte : noise) {
    const bool is_letter = (byte >= 0x20 && byte < 0x7F) || byte == '\r' || byte == '\n';
    letters_ = is_letter ? letters_ + 1 : 0;
    if (letters_ == enough) ++boots_;
  }
}

void lidar_link::send(command code) {
  if (is_over()) return;
  const auto sent = port_->write(encode(code), now_ns() + 500 * ms);
  if (!sent && sent.error() != problem::cancelled) error_ = sent.error();
}

raw_reply lidar_link::ask(command code, std::int64_t patience_ns) {
  constexpr std::int64_t rest_ns = 40 * ms;
  constexpr std::size_t longest_reply = 256;
  raw_reply got;
  send(code);
  const std::int64_t asked_ns = now_ns();
  std::int64_t until_ns = asked_ns + patience_ns;
  on_bytes_ = [&](bytes data, std::int64_t arrival_ns) {
    if (got.first_ns < 0) got.first_ns = std::max<std::int64_t>(arrival_ns - asked_ns, 0);
    const bytes kept = data.first(std::min(data.size(), longest_reply - got.data.size()));
    got.data.insert(got.data.end(), kept.begin(), kept.end());
    until_ns = std::min(until_ns, arrival_ns + rest_ns);
  };
  listen(until_ns);
  on_bytes_ = nullptr;
  const auto found = std::ranges::search(got.data, response_start).begin();
  const bool is_whole = got.data.end() - found > static_cast<std::ptrdiff_t>(response_header_size);
  if (is_whole) got.begin = found - got.data.begin();
  return got;
}

std::optional<std::int32_t> lidar_link::number(command query) {
  constexpr int tries = 5;
  std::optional<std::int32_t> found;
  for (int i = 0; i < tries && !found && !is_over(); ++i) found = ask(query).number();
  return found;
}

std::int64_t lidar_link::wait_for_packet(std::int64_t patience_ns) {
  const std::int64_t begin_ns = now_ns();
  std::int64_t until_ns = begin_ns + patience_ns;
  std::int64_t found_ns = -1;
  listen(until_ns, [&](const event& found, std::int64_t arrival_ns) {
    if (found_ns >= 0 || !std::holds_alternative<packet_view>(found)) return;
    found_ns = std::max<std::int64_t>(arrival_ns - begin_ns, 0);
    until_ns = arrival_ns;
  });
  return found_ns;
}

std::int64_t lidar_link::wait_for_silence(std::int64_t patience_ns) {
  const std::int64_t begin_ns = now_ns();
  while (!is_over() && now_ns() < begin_ns + patience_ns) {
    listen(std::max(heard_ns_, begin_ns) + quiet_ns);
    if (now_ns() < std::max(heard_ns_, begin_ns) + quiet_ns) continue;
    while (const auto found = parser_.finish()) give(*found, heard_ns_, {});
    return std::max<std::int64_t>(heard_ns_ - begin_ns, 0);
  }
  return -1;
}

// By the samples of a revolution: a USB bridge delays bytes, and does not change their number.
steady_motor wait_until_steady(lidar_link& link) {
  std::vector<revolution> all;
  std::size_t steady = 0;
  std::int64_t end_ns = 0;
  std::int64_t until_ns = link.now_ns() + spin_up_ns;
  link.listen(until_ns, [&](const event& found, std::int64_t arrival_ns) {
    const auto* const packet = std::get_if<packet_view>(&found);
    if (packet == nullptr || steady > 0) return;
    if (packet->is_zero()) {
      end_ns = arrival_ns;
      steady = steady_ones(all, end_ns);
      if (steady > 0) until_ns = arrival_ns;
      all.push_back({arrival_ns});
    }
    if (!all.empty()) all.back().samples += static_cast<double>(packet->sample_count());
  });
  if (steady == 0) return {};
  const std::int64_t since_ns = all[all.size() - 1 - steady].begin_ns;
  return {static_cast<double>(steady) / (static_cast<double>(end_ns - since_ns) / 1e9), since_ns};
}

bool lidar_link::set_dtr(bool high) { return !is_over() && port_->set_dtr(high).value_or(false); }

bool pulse_dtr(lidar_link& link, std::int64_t low_ns) {
  if (!link.set_dtr(false)) return false;
  link.listen_for(low_ns);
  return link.set_dtr(true);
}

std::int64_t lidar_link::start() {
  if (which_.motor == motor_kind::dtr) pulse_dtr(*this);
  if (is_two_way()) send(command::start);
  return wait_for_packet(spin_up_ns);
}

bool lidar_link::stop_scan() {
  constexpr int tries = 4;
  bool is_silent = !is_two_way();
  for (int i = 0; i < tries && !is_silent && !is_over(); ++i) {
    send(command::forced_stop);
    send(command::stop);
    is_silent = wait_for_silence(500 * ms) >= 0;
  }
  // Where reading has failed, a write may still stop the motor.
  for (const command code : {command::forced_stop, command::stop}) {
    if (error_ && is_two_way()) static_cast<void>(port_->write(encode(code), now_ns() + 100 * ms));
  }
  return is_silent && !error_;
}

bool lidar_link::stop() {
  const bool is_silent = stop_scan();
  if (which_.motor == motor_kind::dtr) set_dtr(false);
  return is_silent;
}

packet_survey lidar_link::survey(std::int64_t time_ns) {
  packet_survey made(which_);
  listen(now_ns() + time_ns,
         [&](const event& found, std::int64_t arrival_ns) { made.take(found, arrival_ns); });
  return made;
}

packet_survey steady_survey(lidar_link& link, std::int64_t time_ns) {
  constexpr int most = 3;
  for (int i = 1;; ++i) {
    packet_survey made = link.survey(time_ns);
    if (made.is_steady() || i == most || time_ns > short_survey_ns || link.is_over()) return made;
  }
}

}  // namespace g4_tool::acceptance
