// SPDX-License-Identifier: MIT
// The examination of the bytes of a stream: facts that the search, the doctor and the errors read.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>

#include "change_signs.hpp"
#include "echo_signs.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/settings.hpp"
#include "other_makers.hpp"
#include "text_signs.hpp"
#include "unrecognised_bytes.hpp"

namespace g4lidar {

/// *Single thread.* Takes bytes as they come, and adds none of its own.
class stream_survey {
 public:
  void sent(bytes command) noexcept {
    all_.sent(command);
    echo_.sent(command);
  }
  void received(bytes data) noexcept {
    all_.received(data);
    count_ += data.size();
    layout_.take(data);
    maker_.take(data);
    text_.take(data);
    change_.take(data);
    echo_.received(data);
    answers_.feed(data, [this](const event& each) {
      const auto* const reply = std::get_if<response_view>(&each);
      if (reply != nullptr && !device_) device_ = reply->as_device_info();
    });
  }
  /// The input has ended.
  void finish() noexcept {
    layout_.finish();
    maker_.finish();
  }
  /// The bytes that follow do not continue the earlier ones, as after another baud rate.
  void part() noexcept {
    layout_ = {};
    maker_ = {};
    answers_ = stream_parser(g4_format);
    device_.reset();
    count_ = 0;
  }

  /// The same, and the baud rate is another one: so far all() and echo() alone remain.
  void tune() noexcept {
    part();
    text_ = {};
    change_ = {};
    echo_.tune();
  }

  /// Packets of which layout; since part().
  [[nodiscard]] const layout_recogniser& layout() const noexcept { return layout_; }
  /// Who sends frames of another protocol; null: nobody is recognised. Valid forever.
  [[nodiscard]] const other_maker* maker() const noexcept { return maker_.found(); }
  /// Whether frames of somebody else have come, too few to recognise him.
  [[nodiscard]] bool is_other_likely() const noexcept { return maker_.is_likely(); }
  /// The first answer with a device information; since part().
  [[nodiscard]] const std::optional<device_information>& device() const noexcept { return device_; }
  /// How many bytes; since part().
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// All bytes, whether they are text, and how they were changed on the way.
  [[nodiscard]] const unrecognised_bytes& all() const noexcept { return all_; }
  [[nodiscard]] text_kind text() const noexcept { return text_.text(); }
  [[nodiscard]] stream_change change() const noexcept {
    return text_.is_text() ? stream_change::none : change_.change();
  }
  /// Whether what was sent comes back.
  [[nodiscard]] echo_kind echo() const noexcept { return echo_.kind(); }
  /// Whether these are bytes that no lidar has sent; else they may be those of a lidar, as they are or changed.
  [[nodiscard]] bool is_of_another() const noexcept {
    return maker() != nullptr || echo() != echo_kind::none || text() == text_kind::plain;
  }
  /// Who or what it is, in sentences; empty: packets of a lidar, or not known. *Allocates.*
  [[nodiscard]] std::string finding() const;

 private:
  layout_recogniser layout_;
  maker_recogniser maker_;
  text_signs text_;
  change_signs change_;
  echo_signs echo_;
  unrecognised_bytes all_;
  stream_parser answers_{g4_format};  // an answer is found whatever the size of samples is
  std::optional<device_information> device_;
  std::size_t count_ = 0;
};

}  // namespace g4lidar
