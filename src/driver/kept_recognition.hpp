// SPDX-License-Identifier: MIT
// As which model a driver reads its source.
#pragma once

#include <algorithm>
#include <cstdint>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "discovery/fitting_models.hpp"
#include "g4lidar/recording/contents.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/transport/recognition.hpp"
#include "link/sample_size_watch.hpp"

namespace g4lidar {

/// As which model a source is read, with its own memory for the candidates.
class kept_recognition {
 public:
  /// `used`: where nothing is known.
  kept_recognition(const recognition& found, const model& used)
      : what_(found), candidates_(found.candidates.begin(), found.candidates.end()) {
    what_.model = &used;
    if (candidates_.empty()) candidates_ = {&used};
  }
  /// Valid as long as this, and until become().
  [[nodiscard]] recognition get() const noexcept {
    recognition now = what_;
    now.candidates = candidates_;
    return now;
  }
  /// Whether the user, a recording or the name of the source states the model.
  [[nodiscard]] bool is_stated() const noexcept {
    return what_.by == known_by::user || what_.by == known_by::recording;
  }
  void set_device(std::uint8_t number, std::uint32_t baud) noexcept {
    if (number != 0) what_.number = number;
    if (baud != 0) what_.baud = baud;
  }
  /// What its connection shows. That of the search has shown it before: it is not `again` connected.
  void set_bridge(bool speaks_telnet, bool again) noexcept {
    what_.speaks_telnet = speaks_telnet || (what_.speaks_telnet && !again);
  }
  /// Packets of the model have come. Its candidates are not known where there is no memory.
  void confirm(std::uint32_t baud, bool answers) noexcept try {
    what_.has_shown_samples = true;
    if (what_.by != known_by::nothing) return;
    what_.by = known_by::samples;
    candidates_ = models_that_fit({.baud = baud,
                                   .sample_bytes = sample_size(what_.model->samples.layout),
                                   .answers = answers ? presence::yes : presence::no});
    if (candidates_.empty()) candidates_ = {what_.model};
    const auto first = std::ranges::find(candidates_, what_.model);
    if (first != candidates_.end()) std::rotate(candidates_.begin(), first, first + 1);
  } catch (const std::bad_alloc&) {
    candidates_.clear();
  }
  /// Its samples have another size than those of its number: the model is one that has, at this baud rate and with this
  /// sample rate. Null: there is none. *Allocates.*
  [[nodiscard]] const model* follow(const stream_samples& seen, std::uint32_t baud, bool answers) {
    auto fitting = models_at_rate({.baud = baud,
                                   .sample_bytes = seen.bytes,
                                   .sample_rate_hz = seen.rate_hz,
                                   .frequency_chz = seen.frequency_chz,
                                   .answers = answers ? presence::yes : presence::no});
    if (fitting.empty()) return nullptr;
    candidates_ = std::move(fitting);
    what_.model = candidates_.front();
    what_.by = known_by::samples;
    what_.has_shown_samples = true;
    return what_.model;
  }

  /// For the recording of `from`, if there is one: what contradicts the model, if something does, or that it is guessed.
  void record(connector& from) const noexcept {
    recording_hook* const hook = recording_hook_of(from);
    if (hook == nullptr) return;
    try {
      const bool is_guessed = what_.by == known_by::samples || what_.by == known_by::nothing;
      if (is_guessed || !contradictions_of(get()).empty()) hook->recognised(get());
    } catch (const std::bad_alloc&) {
      return;  // the recording is without it
    }
  }

  std::optional<device_information>
      module;  ///< Of the turning part, if it has reported another one.
  /// Of a live lidar.
  struct {
    bool is_judged = false;  ///< By packets since the start.
    bool is_held =
        false;  ///< Its samples have another size, and make no points until the model has followed.
  } live;

 private:
  recognition what_;
  std::vector<const model*> candidates_;
};

}  // namespace g4lidar
