// SPDX-License-Identifier: MIT
// The subject of an error, composed without the heap: the transport, the command, the numbers.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/enumerators.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/request.hpp"

namespace g4lidar {

/// As much of the text as an error can hold. *Never allocates.*
class error_context {
 public:
  explicit error_context(std::string_view begin) noexcept { add(begin); }

  error_context& add(std::string_view text) noexcept {
    const std::size_t count = std::min(text.size(), text_.size() - size_);
    std::copy_n(text.begin(), count, text_.begin() + size_);
    size_ += count;
    return *this;
  }
  error_context& add(std::uint32_t number) noexcept {
    std::array<char, 10> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return add({digits.data(), static_cast<std::size_t>(end - digits.data())});
  }
  /// "12 Hz", "7.5 Hz", "7.03 Hz".
  error_context& add(scan_frequency frequency) noexcept {
    add(std::uint32_t{frequency.chz} / 100U);
    const std::uint32_t rest = frequency.chz % 100U;
    if (rest != 0) add(rest < 10 ? ".0" : ".").add(rest % 10 == 0 ? rest / 10 : rest);
    return add(" Hz");
  }
  /// "scan frequency 12 Hz", "health". Empty if the task is sufficient: start, stop.
  error_context& add(const request& wanted) noexcept {
    const std::string_view what = detail::name_in(request_words, wanted.what);
    if (what.empty()) return *this;
    add(", ").add(what);
    if (wanted.what == request_kind::set_scan_frequency)
      return add(" ").add(scan_frequency{wanted.value});
    if (wanted.what == request_kind::set_sample_rate && wanted.value % 1000 == 0) {
      return add(" ").add(std::uint32_t{wanted.value} / 1000U).add(" kHz");
    }
    if (wanted.what == request_kind::set_sample_rate) {
      return add(" ").add(std::uint32_t{wanted.value}).add(" Hz");
    }
    return *this;
  }

  /// "8000, 16000 or 18000".
  error_context& add_rates(const model& model) noexcept {
    const std::uint8_t count = rate_count(model);
    for (std::uint8_t code = 0; code < count; ++code) {
      const std::string_view before = code == 0 ? "" : code + 1 == count ? " or " : ", ";
      add(before).add(rate_hz_of_code(model, code));
    }
    return *this;
  }
  /// "5 Hz to 12 Hz".
  error_context& add_frequencies(const model& model) noexcept {
    add(scan_frequency{model.frequency.min_chz}).add(" to ");
    return add(scan_frequency{model.frequency.max_chz});
  }
  /// " of a G6".
  error_context& add_owner(const model& model) noexcept {
    return add(" of ").add(article_of(model)).add(" ").add(model.name);
  }
  /// What the commands of a model set, and how its speed is set without: "(commands set nothing; its speed: ...)".
  error_context& add_ways(const model& model) noexcept {
    std::string_view before = " (commands set ";
    const auto next = [&](request_kind change, std::string_view name) {
      if (!has_request(model, change)) return false;
      add(before).add(name);
      before = "; ";
      return true;
    };
    if (next(request_kind::set_sample_rate, "sample_rate: ")) add_rates(model);
    if (next(request_kind::set_scan_frequency, "frequency: ")) add_frequencies(model);
    static_cast<void>(next(request_kind::set_direction, "direction; constant; idle"));
    static_cast<void>(next(request_kind::set_protection, "protection"));
    if (before != "; ") add(before).add("nothing");
    if (!model.frequency.pin.empty())
      add("; its speed: voltage or PWM at pin ").add(model.frequency.pin);
    return add(")");
  }
  /// How the speed of a model is set without commands, behind `before`; nothing where commands set it.
  error_context& add_speed(const model& model, std::string_view before) noexcept {
    if (model.frequency.pin.empty()) return *this;
    add(before).add("a voltage or PWM at its pin ").add(model.frequency.pin);
    return add("; most boards leave it at their default");
  }

  // NOLINTNEXTLINE(google-explicit-constructor): it is a text.
  operator std::string_view() const noexcept { return {text_.data(), size_}; }

 private:
  /// In the order of the enumeration; start and stop are in the task already.
  static constexpr std::array<std::string_view, 18> request_words{"device information",
                                                                  "health",
                                                                  "low power",
                                                                  "low power",
                                                                  "direction",
                                                                  "direction",
                                                                  "scan frequency",
                                                                  "scan frequency",
                                                                  "scan frequency",
                                                                  "constant frequency",
                                                                  "sample rate",
                                                                  "sample rate",
                                                                  "power-down protection",
                                                                  "zero angle",
                                                                  "pitch",
                                                                  "restart",
                                                                  "",
                                                                  ""};
  static_assert(request_words.size() == static_cast<std::size_t>(request_kind::stop) + 1);

  std::array<char, 159> text_{};
  std::size_t size_ = 0;
};

}  // namespace g4lidar
