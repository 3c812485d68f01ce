// SPDX-License-Identifier: MIT
// The kinds of fault in one table, and the parser of their text form.
#include "sim/exact.hpp"

#include "g4lidar/sim/device.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/enumerators.hpp"
#include "sim/read_time.hpp"
#include "sim/world/world_text.hpp"

namespace g4lidar::sim {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t longest_ns = 1'000'000'000'000'000;  // 11 days

enum class amount_is : std::uint8_t { nothing, bytes, time, health, command };

struct kind_traits {
  fault_kind kind;
  std::string_view name;
  bool has_rate;
  double rate;
  amount_is amount;
  std::int64_t value;
};

constexpr std::array<kind_traits, 20> kinds{{
    {fault_kind::flip, "flip", true, 0.001, amount_is::nothing, 0},
    {fault_kind::drop, "drop", true, 0.001, amount_is::nothing, 0},
    {fault_kind::insert, "insert", true, 0.001, amount_is::nothing, 0},
    {fault_kind::burst, "burst", true, 0.0001, amount_is::bytes, 30},
    {fault_kind::truncate, "truncate", true, 0.01, amount_is::nothing, 0},
    {fault_kind::stall, "stall", false, 1.0, amount_is::nothing, 0},
    {fault_kind::batch, "batch", false, 1.0, amount_is::time, 16 * ms},
    {fault_kind::late, "late", true, 1.0, amount_is::time, 300 * ms},
    {fault_kind::wrong, "wrong", true, 1.0, amount_is::command, 0},
    {fault_kind::twice, "twice", true, 1.0, amount_is::command, 0},
    {fault_kind::mute, "mute", true, 1.0, amount_is::command, 0},
    {fault_kind::deaf, "deaf", false, 1.0, amount_is::nothing, 0},
    {fault_kind::baud, "baud", false, 1.0, amount_is::nothing, 0},
    {fault_kind::scanning, "scanning", false, 1.0, amount_is::nothing, 0},
    {fault_kind::brown_out, "brown_out", false, 1.0, amount_is::time, 30 * ms},
    {fault_kind::reboot, "reboot", false, 1.0, amount_is::time, 30 * ms},
    {fault_kind::unplug, "unplug", false, 1.0, amount_is::nothing, 0},
    {fault_kind::health, "health", false, 1.0, amount_is::health, 2},
    {fault_kind::jolt, "jolt", true, 0.01, amount_is::nothing, 0},
    {fault_kind::omit, "omit", true, 0.01, amount_is::nothing, 0},
}};
static_assert(kinds.back().kind == last_fault_kind);

constexpr bool in_order() {
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i].kind != static_cast<fault_kind>(i)) return false;
  }
  return kinds.back().kind == last_fault_kind;
}
static_assert(in_order());

const kind_traits& traits_of(fault_kind kind) noexcept {
  return g4lidar::detail::row_of(kinds, kind);
}

struct number {
  std::int64_t millionths;
  std::string_view unit;  // the text after the number
};

constexpr bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

// A decimal number with at most nine digits before the point and six behind it.
std::optional<number> read_number(std::string_view text) noexcept {
  std::size_t at = 0;
  std::int64_t value = 0;
  for (; at < text.size() && is_digit(text[at]); ++at) {
    if (at == 9) return std::nullopt;
    value = value * 10 + (text[at] - '0');
  }
  if (at == 0) return std::nullopt;
  std::size_t behind = 0;
  if (at < text.size() && text[at] == '.') {
    for (++at; at < text.size() && is_digit(text[at]); ++at) {
      if (++behind > 6) return std::nullopt;
      value = value * 10 + (text[at] - '0');
    }
    if (behind == 0) return std::nullopt;
  }
  for (; behind < 6; ++behind) value *= 10;
  return number{value, text.substr(at)};
}

std::optional<double> read_rate(std::string_view text) noexcept {
  const std::optional<number> read = read_number(text);
  if (!read || (!read->unit.empty() && read->unit != "%")) return std::nullopt;
  const double per = read->unit.empty() ? 1e6 : 1e8;
  return static_cast<double>(read->millionths) / per;
}

/// Two digits of a command, as the protocol names it: "93".
std::optional<std::int64_t> read_command(std::string_view text) noexcept {
  constexpr std::string_view digits = "0123456789ABCDEFabcdef";
  std::int64_t code = 0;
  for (const char each : text) {
    const std::size_t at = digits.find(each);
    if (at == std::string_view::npos) return std::nullopt;
    code = 16 * code + static_cast<std::int64_t>(at < 16 ? at : at - 6);
  }
  return text.size() == 2 && code != 0 ? std::optional(code) : std::nullopt;
}

std::optional<std::int64_t> read_amount(std::string_view text, amount_is amount) noexcept {
  if (amount == amount_is::time) return read_time_ns(text);
  if (amount == amount_is::command) return read_command(text);
  if (amount == amount_is::health) {
    if (text == "warning") return 1;
    if (text == "error") return 2;
  }
  const std::optional<number> read = read_number(text);
  if (!read || !read->unit.empty() || read->millionths % 1'000'000 != 0) return std::nullopt;
  return read->millionths / 1'000'000;
}

fault_error wrong(std::string_view what, std::string_view is) {
  constexpr std::size_t enough = 60;
  return {quoted(what, enough).append(" ").append(is)};
}

// "a@b" returns "a" and leaves "b"; nothing if there is no '@'.
std::string_view cut_before(std::string_view& rest, char mark, bool& found) noexcept {
  const std::size_t at = rest.find(mark);
  found = at != std::string_view::npos;
  const std::string_view before = rest.substr(0, at);
  rest = found ? rest.substr(at + 1) : std::string_view{};
  return before;
}

// "[@BEGIN[+DURATION]]"
std::optional<fault_error> read_when(std::string_view times, fault& read) {
  constexpr std::string_view is_no_time =
      "is no time: 5s, 1.5ms, 200us, 30ns or 2min, at most 11 days";
  bool has_duration = false;
  const std::string_view begin = cut_before(times, '+', has_duration);
  const std::optional<std::int64_t> begin_ns = read_time_ns(begin);
  if (!begin_ns) return wrong(begin, is_no_time);
  read.begin_ns = *begin_ns;
  if (!has_duration) return std::nullopt;
  const std::optional<std::int64_t> duration_ns = read_time_ns(times);
  if (!duration_ns) return wrong(times, is_no_time);
  read.duration_ns = *duration_ns;
  return std::nullopt;
}

// "KIND[=AMOUNT][*RATE]"
std::variant<fault, fault_error> read_what(std::string_view what) {
  bool has_rate = false;
  std::string_view rate = what;
  std::string_view name = cut_before(rate, '*', has_rate);
  bool has_amount = false;
  std::string_view amount = name;
  name = cut_before(amount, '=', has_amount);

  const kind_traits* known = nullptr;
  std::string all;
  for (const kind_traits& kind : kinds) {
    if (kind.name == name) known = &kind;
    all.append(all.empty() ? "" : ", ").append(kind.name);
  }
  if (known == nullptr) return wrong(name, "is not a fault; faults are " + all);
  fault read = make_fault(known->kind);
  if (has_amount) {
    if (known->amount == amount_is::nothing) return wrong(name, "takes no amount");
    const std::optional<std::int64_t> value = read_amount(amount, known->amount);
    if (!value) return wrong(amount, "is no amount for " + std::string(name));
    read.amount = *value;
  }
  if (has_rate) {
    if (!known->has_rate) return wrong(name, "takes no rate");
    const std::optional<double> value = read_rate(rate);
    if (!value) return wrong(rate, "is no rate: 0 to 1, or 0% to 100%");
    read.rate = *value;
  }
  return read;
}

}  // namespace

std::optional<std::int64_t> read_time_ns(std::string_view text) noexcept {
  const std::optional<number> read = read_number(text);
  if (!read) return std::nullopt;
  constexpr std::array<std::pair<std::string_view, std::int64_t>, 5> units{
      {{"ns", 1}, {"us", 1'000}, {"ms", ms}, {"s", 1'000 * ms}, {"min", 60'000 * ms}}};
  for (const auto& [name, ns] : units) {
    if (read->unit != name) continue;
    // Whole units and millionths of a unit separately: neither product overflows.
    const std::int64_t whole = read->millionths / 1'000'000;
    if (whole > longest_ns / ns) return std::nullopt;
    const std::int64_t time_ns = whole * ns + read->millionths % 1'000'000 * ns / 1'000'000;
    return time_ns <= longest_ns ? std::optional(time_ns) : std::nullopt;
  }
  if (read->unit.empty() && read->millionths == 0) return 0;
  return std::nullopt;
}

fault make_fault(fault_kind kind, std::int64_t begin_ns, std::int64_t duration_ns) noexcept {
  const kind_traits& traits = traits_of(kind);
  return {kind, begin_ns, duration_ns, traits.rate, traits.value};
}

std::string_view name_of(fault_kind kind) noexcept { return traits_of(kind).name; }

std::string_view problem_with(const fault& f) noexcept {
  if (f.kind > last_fault_kind) return "a fault must be of a known kind";
  if (f.begin_ns < 0 || f.begin_ns > longest_ns) return "a fault must begin within 0 to 11 days";
  if (f.duration_ns < 0) return "a fault must not end before it begins";
  if (!(f.rate >= 0.0 && f.rate <= 1.0)) return "the rate of a fault must be 0 to 1";
  switch (traits_of(f.kind).amount) {
    case amount_is::nothing:
      return {};
    case amount_is::bytes:
      return f.amount >= 1 && f.amount <= 1'000'000 ? "" : "a burst must have 1 to 1000000 bytes";
    case amount_is::time:
      return f.amount >= 0 && f.amount <= 4'000 * ms ? "" : "a fault's time must be 0 to 4 s";
    case amount_is::health:
      return f.amount >= 0 && f.amount <= 2 ? "" : "the health must be 0, 1 or 2";
    case amount_is::command:
      return f.amount >= 0 && f.amount <= 0xFF ? "" : "a command must be 0 to FF";
  }
  return {};
}

std::variant<fault, fault_error> parse_fault(std::string_view text) {
  bool has_when = false;
  std::string_view when = text;
  const std::string_view what = cut_before(when, '@', has_when);
  std::variant<fault, fault_error> read = read_what(what);
  fault* const found = std::get_if<fault>(&read);
  if (found == nullptr) return read;
  if (has_when) {
    if (std::optional<fault_error> error = read_when(when, *found)) return *std::move(error);
  }
  if (const std::string_view problem = problem_with(*found); !problem.empty()) {
    return fault_error{std::string(problem)};
  }
  return read;
}

}  // namespace g4lidar::sim
