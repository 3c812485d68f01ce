// SPDX-License-Identifier: MIT
// What the steps of an acceptance run are made of: commands, raw replies, waits.
#include <algorithm>
#include <array>
#include <cmath>

#include "acceptance_link.hpp"
#include "g4lidar/core/response.hpp"
#include "stages.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t spin_up_ns = 12'000 * ms;
constexpr std::size_t longest_reply = 256;

/// The place of a response header in `data`; -1: there is none.
std::int64_t response_in(bytes data) noexcept {
  const auto found = std::ranges::search(data, response_start).begin();
  const auto place = found - data.begin();
  const bool is_whole = data.size() - static_cast<std::size_t>(place) > response_header_size;
  return is_whole ? static_cast<std::int64_t>(place) : -1;
}

}  // namespace

std::string spin_up_words(std::int64_t first_ns, double steady_ms) {
  return "First packet after " + std::to_string(std::lround(in_ms(first_ns))) +
         " ms, steady after " + std::to_string(std::lround(steady_ms)) + " ms.";
}

bytes raw_reply::content() const noexcept {
  if (begin < 0) return {};
  const auto at = static_cast<std::size_t>(begin);
  const std::size_t stated = data[at + 2];
  const bytes behind = bytes(data).subspan(at + response_header_size);
  return behind.first(std::min(stated, behind.size()));
}

std::optional<std::int32_t> raw_reply::number() const noexcept {
  const bytes all = content();
  if (all.size() == 1) return all[0];
  if (all.size() != 4) return std::nullopt;
  return static_cast<std::int32_t>(load_u16(all, 0) | static_cast<std::uint32_t>(load_u16(all, 2))
                                                          << 16U);
}

std::string raw_reply::text() const {
  constexpr std::size_t most = 32;
  std::string all;
  for (const std::uint8_t each : bytes(data).first(std::min(data.size(), most))) {
    all += digits_of(each, 16, 2);
  }
  return all;
}

raw_reply acceptance_link::ask(std::uint8_t code, std::int64_t patience_ns) {
  constexpr std::int64_t rest_ns = 40 * ms;
  raw_reply got;
  send(static_cast<command>(code));
  const std::int64_t asked_ns = monitor_.now_ns();
  std::int64_t until_ns = asked_ns + patience_ns;
  monitor_.listen(until_ns, {.event = [&](const observed_event& found) {
                    if (got.first_ns < 0) got.first_ns = found.arrival_ns - asked_ns;
                    const std::size_t room =
                        longest_reply - std::min(longest_reply, got.data.size());
                    const bytes raw = found.raw.first(std::min(found.raw.size(), room));
                    got.data.insert(got.data.end(), raw.begin(), raw.end());
                    until_ns = std::min(until_ns, found.arrival_ns + rest_ns);
                  }});
  got.begin = response_in(got.data);
  return got;
}

std::int64_t acceptance_link::wait_for_packet(std::int64_t patience_ns) {
  const std::int64_t begin_ns = monitor_.now_ns();
  std::int64_t until_ns = begin_ns + patience_ns;
  std::int64_t found_ns = -1;
  monitor_.listen(until_ns, {.event = [&](const observed_event& found) {
                    if (found_ns >= 0 || !std::holds_alternative<packet_view>(found.what)) return;
                    found_ns = std::max<std::int64_t>(found.arrival_ns - begin_ns, 0);
                    until_ns = found.arrival_ns;
                  }});
  return found_ns;
}

std::int64_t acceptance_link::wait_for_silence(std::int64_t patience_ns) {
  constexpr std::int64_t quiet_ns = 150 * ms;
  const std::int64_t begin_ns = monitor_.now_ns();
  monitor_.listen_for_quiet(quiet_ns, begin_ns + patience_ns);
  const bool is_silent = monitor_.now_ns() >= monitor_.heard_ns() + quiet_ns;
  return is_silent ? std::max<std::int64_t>(monitor_.heard_ns() - begin_ns, 0) : -1;
}

double acceptance_link::wait_until_steady() {
  constexpr int most = 24;
  double last_hz = 0.0;
  for (int i = 0; i < most; ++i) {
    const double now_hz = survey(500 * ms).frequency_hz();
    if (last_hz > 0.0 && std::abs(now_hz / last_hz - 1.0) < 0.03) return now_hz;
    last_hz = now_hz;
  }
  return 0.0;
}

bool acceptance_link::set_dtr(bool high) {
  if (monitor_.is_over()) return false;
  return port_->set_dtr(high).value_or(false);
}

std::int64_t acceptance_link::start() {
  if (which_.motor == motor_kind::dtr) pulse_dtr(monitor_);
  if (is_two_way()) send(command::start);
  return wait_for_packet(spin_up_ns);
}

void acceptance_link::stop() {
  if (is_two_way()) static_cast<void>(monitor_.stop());
  if (which_.motor == motor_kind::dtr) static_cast<void>(set_dtr(false));
}

stream_survey acceptance_link::survey(std::int64_t time_ns) {
  stream_survey made(which_);
  std::int64_t until_ns = monitor_.now_ns() + time_ns;
  monitor_.listen(until_ns, {.event = [&](const observed_event& found) {
                    made.take(found.what, found.arrival_ns);
                  }});
  return made;
}

stream_survey acceptance_link::steady_survey(std::int64_t time_ns) {
  constexpr int most = 3;
  constexpr std::int64_t short_ns = 5'000 * ms;
  constexpr std::int64_t least_gaps = 20;  // of the longest length, that fit into the time
  for (int i = 1;; ++i) {
    const stream_survey made = survey(time_ns);
    const bool is_steady = made.longest_gap_ns() * least_gaps < time_ns;
    if (is_steady || i == most || time_ns > short_ns || monitor_.is_over()) return made;
  }
}

std::optional<std::int32_t> acceptance_link::go_to_limit(std::uint8_t code) {
  constexpr int most_steps = 20;  // of 1 Hz
  std::optional<std::int32_t> last;
  for (int i = 0; i < most_steps; ++i) {
    const auto now = ask(code).number();
    if (!now || now == last) break;
    last = now;
  }
  return last;
}

}  // namespace g4lidar
