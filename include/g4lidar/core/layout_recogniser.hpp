// SPDX-License-Identifier: MIT
// Which model sends these bytes, as far as they show it: packets do not state the size of samples.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/ct_information.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/model_choice.hpp"
#include "g4lidar/core/packet.hpp"
#include "g4lidar/core/response.hpp"
#include "g4lidar/core/stream_counts.hpp"
#include "g4lidar/core/stream_parser.hpp"

namespace g4lidar {

namespace detail {

/// The packets in a stream if its samples have one size, and what they state about their lidar.
/// *Single thread, never allocates.*
class layout_candidate {
 public:
  explicit constexpr layout_candidate(sample_format format) noexcept : parser_(format) {}

  constexpr void take(bytes input) noexcept {
    parser_.feed(input, [this](const event& found) { take(found); });
  }
  /// The input has ended: a packet at its end counts, too.
  constexpr void finish() noexcept {
    if (is_open_ && gap_ == 0 && parser_.held() == 0) ++votes_;
    is_open_ = false;
    while (const auto found = parser_.finish()) take(*found);
  }

  /// Packets that another packet, a time packet or a response follows, with at most one byte before
  /// it.
  [[nodiscard]] constexpr std::uint32_t votes() const noexcept { return votes_; }
  /// All packets.
  [[nodiscard]] constexpr std::uint32_t packets() const noexcept { return packets_; }
  /// The number in the first device information; 0: there was none.
  [[nodiscard]] constexpr std::uint8_t id() const noexcept { return id_; }
  /// What the bytes CT state.
  [[nodiscard]] constexpr const std::optional<ct_information>& information() const noexcept {
    return reader_.last();
  }
  /// Samples per second, by the frequency that a zero packet reports and the angle between samples; 0: not known.
  [[nodiscard]] constexpr std::uint32_t rate_hz() const noexcept {
    return span_64ths_ == 0 ? 0 : steps_ * turn_64ths * chz_ / (100 * span_64ths_);
  }
  /// The last frequency that a zero packet reported, in 0.01 Hz; 0: none has.
  [[nodiscard]] constexpr std::uint32_t frequency_chz() const noexcept { return chz_; }
  /// Whether nothing is missing that other packets might state: a revolution was received without a gap; or the rate is
  /// known, and the CT bytes are all the same, so that they state nothing.
  [[nodiscard]] constexpr bool has_stated_all() const noexcept {
    return has_revolution_ || (rate_hz() != 0 && ct_or_ == ct_and_);
  }
  /// Whether the second bit of 2-byte samples is seldom set: the lowest bits of a range have all
  /// values.
  [[nodiscard]] constexpr bool has_rare_upper_flag() const noexcept {
    return 10 * upper_flags_ <= ranges_;
  }
  /// Whether samples of 2 bytes consist of flags alone: as a range they would be below a millimetre.
  [[nodiscard]] constexpr bool has_flags_alone() const noexcept {
    constexpr std::uint32_t enough = 16;
    return flags_alone_ >= enough && has_rare_upper_flag();
  }

 private:
  constexpr void take(const event& found) noexcept {
    if (const auto* const gone = std::get_if<skipped>(&found)) {
      gap_ += gone->count;
      reader_.add(*gone);
      return;
    }
    if (is_open_ && gap_ <= 1) ++votes_;
    const auto* const packet = std::get_if<packet_view>(&found);
    is_open_ = packet != nullptr;
    if (is_open_) ++packets_;
    if (packet != nullptr) take(*packet);
    if (const auto* const reply = std::get_if<response_view>(&found);
        reply != nullptr && id_ == 0) {
      if (const auto who = reply->as_device_info()) id_ = who->model;
    }
    gap_ = 0;
  }

  constexpr void take(packet_view packet) noexcept {
    reader_.add(packet);
    const bool goes_on = is_in_revolution_ && gap_ <= 1;
    is_in_revolution_ = packet.is_zero() || (is_in_revolution_ && gap_ == 0);
    constexpr std::size_t exact = 8;  // samples, whose angles are rounded
    if (packet.is_zero()) {
      has_revolution_ = has_revolution_ || goes_on;
      chz_ = static_cast<std::uint32_t>(packet.reported_frequency_chz());
    } else {
      ct_or_ |= packet.ct();
      ct_and_ &= packet.ct();
      if (packet.sample_count() >= exact && packet.span_64ths() > 0) {
        steps_ = static_cast<std::uint32_t>(packet.sample_count() - 1);
        span_64ths_ = static_cast<std::uint32_t>(packet.span_64ths());
      }
    }
    for (std::size_t i = 0; i < packet.sample_count(); ++i) {
      const std::uint16_t word = packet.sample(i);
      if (word > 3) ++ranges_;
      if (word > 3 && (word & 2U) != 0) ++upper_flags_;
      if (word > 0 && word <= 3) ++flags_alone_;
    }
  }

  stream_parser parser_;
  ct_information_reader reader_;
  std::uint32_t votes_ = 0;
  std::size_t gap_ = 0;  // bytes skipped since the last packet or response
  std::uint32_t packets_ = 0;
  bool is_open_ = false;  // the last one was a packet, and has no vote yet
  std::uint8_t id_ = 0;
  bool is_in_revolution_ = false;  // received from its zero packet on, without a gap
  bool has_revolution_ = false;    // one was received until the next zero packet
  std::uint8_t ct_or_ = 0;         // of all CT bytes but those of zero packets
  std::uint8_t ct_and_ = 255;
  std::uint32_t chz_ = 0;          // the last frequency
  std::uint32_t steps_ = 0;        // from the first sample of a packet to its last one,
  std::uint32_t span_64ths_ = 0;   // and their angle
  std::uint32_t ranges_ = 0;       // samples that are not flags alone, and not 0
  std::uint32_t upper_flags_ = 0;  // of them
  std::uint32_t flags_alone_ = 0;
};

}  // namespace detail

/// So many packets in a row, with samples of a size that no other packet has, are right where they contradict what a lidar
/// reports, or its user has named.
inline constexpr std::uint32_t certain_packets = 5;

/// What the model of a stream follows from.
enum class recognised_by : std::uint8_t {
  nothing,  ///< Not decided; the G4.
  size,     ///< The size of its samples: the usual model with it.
  flags,    ///< Also of samples that consist of flags alone: the usual model with such samples.
  number,   ///< The number in a device information, or in the bytes CT.
};

/// Recognises the model that sends a stream. *Single thread, never allocates.*
///
/// The size of a sample is the one with which at least three packets more than with any other size
/// have a valid checksum and are followed by another one: the right size fits each packet, a wrong
/// one few. When the input has ended, the best size decides: that with the most such packets, then that
/// with the most packets, then the smallest. The model is the one that the bytes name: in a device information, or in the information
/// in the bytes CT of a revolution whose CRC fits. After a device information, the only two-way model
/// with this number is taken first. Of several models with this number it is the one whose sample
/// rate is nearest to that of the stream. Where nothing names it, it is the usual_model(), and basis()
/// states so: 2-byte samples are a G4's, or an X2's where samples consist of flags alone; 3-byte
/// samples are a T-mini Pro's, and 4-byte samples a T-mini Plus SH's. Where a device information has the number
/// of a model with samples of another size, or of no model, it is the usual one with this sample rate. So a 2-byte sample in half or
/// whole millimetres is not recognised without a device information, and neither are 10 bits of
/// intensity nor the correction of an SCL.
class layout_recogniser {
 public:
  /// Adds bytes of the stream, in order.
  constexpr void take(bytes input) noexcept {
    for (detail::layout_candidate& each : candidates_) each.take(input);
  }
  /// The input has ended: a packet at its end counts, too, and one packet decides.
  constexpr void finish() noexcept {
    for (detail::layout_candidate& each : candidates_) each.finish();
    is_finished_ = true;
  }

  /// The size of a sample in bytes: 2, 3 or 4; 0 as long as it is not decided.
  [[nodiscard]] constexpr std::size_t sample_bytes() const noexcept {
    const detail::layout_candidate* const found = decided();
    return found == nullptr ? 0 : static_cast<std::size_t>(found - candidates_.data()) + 2;
  }

  /// Packets with samples of 2, 3 or 4 bytes that another one follows; 0 for any other size.
  [[nodiscard]] constexpr std::uint32_t votes(std::size_t sample_bytes) const noexcept {
    const std::size_t at = sample_bytes - 2;
    return at < candidates_.size() ? candidates_[at].votes() : 0;
  }
  /// Whether there was a packet, with samples of any size.
  [[nodiscard]] constexpr bool has_packet() const noexcept {
    return candidates_[0].packets() + candidates_[1].packets() + candidates_[2].packets() != 0;
  }

  /// What the bytes CT state, as long as the size of a sample is decided.
  [[nodiscard]] constexpr std::optional<ct_information> information() const noexcept {
    const detail::layout_candidate* const sent = decided();
    return sent == nullptr ? std::nullopt : sent->information();
  }
  /// Samples per second, by the frequency that a zero packet reports and the angle between samples; 0: not known.
  [[nodiscard]] constexpr std::uint32_t rate_hz() const noexcept {
    const detail::layout_candidate* const sent = decided();
    return sent == nullptr ? 0 : sent->rate_hz();
  }
  /// The frequency in 0.01 Hz from which rate_hz() follows, as it was reported. See true_frequency_chz().
  [[nodiscard]] constexpr std::uint32_t frequency_chz() const noexcept {
    const detail::layout_candidate* const sent = decided();
    return sent == nullptr ? 0 : sent->frequency_chz();
  }
  /// Whether more packets will hardly show more about the model than those that have come. False as long as the size of a
  /// sample is not decided.
  [[nodiscard]] constexpr bool has_stated_all() const noexcept {
    const detail::layout_candidate* const sent = decided();
    return sent != nullptr && sent->has_stated_all();
  }

  /// The model as far as the bytes show it; the G4 as long as the size of a sample is not decided.
  /// Valid forever.
  [[nodiscard]] constexpr const model& most_likely() const noexcept { return *found().which; }
  /// What most_likely() follows from. If it is not `number`, other models send such bytes, too.
  [[nodiscard]] constexpr recognised_by basis() const noexcept { return found().by; }

 private:
  struct finding {
    const model* which;
    recognised_by by;
  };

  [[nodiscard]] constexpr finding found() const noexcept {
    const detail::layout_candidate* const sent = decided();
    if (sent == nullptr) return {&g4_model, recognised_by::nothing};
    const std::size_t size = sample_bytes();
    const bool has_flags = size == 2 && sent->has_flags_alone();
    const auto fits = [&](const model& row) { return may_send(row, size, false); };
    const recognised_by without_number = has_flags ? recognised_by::flags : recognised_by::size;
    if (const std::uint8_t id = sent->id(); id != 0) {
      const model* const named = model_with_id(id, link_kind::two_way);
      if (named != nullptr && fits(*named)) return {named, recognised_by::number};
      for (const std::size_t place :
           {0U, 1U}) {  // the rates of the lines, which decide, are not known
        const auto has_id = [&](const model& row) { return fits(row) && row.ids[place] == id; };
        const auto near = nearest(*sent, has_id, without_number);
        if (near.which != nullptr) return near;
      }
    }
    if (const auto& stated = sent->information(); stated && stated->id_low_bits != 0) {
      const auto informs = [&](const model& row) {
        const bool has_rare = has_sample_flags(row.samples.layout) && sent->has_rare_upper_flag();
        return fits(row) && row.ct_information != presence::no && (size != 2 || has_rare) &&
               detail::may_report(row, stated->id_low_bits);
      };
      const auto near = nearest(*sent, informs, without_number);
      if (near.which != nullptr) return near;
    }
    const auto sends = [&](const model& row) { return may_send(row, size, has_flags); };
    const auto measures = [&](const model& row) {
      return sends(row) && may_measure(row, sent->rate_hz(), sent->frequency_chz());
    };
    // Its number is that of a model with samples of another size: so it may be any model with these, not the usual one.
    const model* const near =
        sent->id() == 0 ? nullptr : usual_model(measures, usual_kind::of_its_layout);
    const model* const usual =
        near != nullptr ? near : usual_model(sends, usual_kind::of_its_layout);
    return {usual != nullptr ? usual : &g4_model, without_number};
  }

  [[nodiscard]] constexpr const detail::layout_candidate* decided() const noexcept {
    constexpr std::uint32_t clear_lead = 3;
    const detail::layout_candidate* best = candidates_.data();
    for (const auto& each : candidates_) {
      const bool is_as_good = each.votes() == best->votes();
      if (each.votes() > best->votes() || (is_as_good && each.packets() > best->packets())) {
        best = &each;
      }
    }
    if (is_finished_) return best->packets() != 0 ? best : nullptr;
    for (const auto& each : candidates_) {
      if (&each != best && best->votes() < each.votes() + clear_lead) return nullptr;
    }
    return best;
  }

  /// The first of the models for which `may_be` is true whose sample rate is nearest; null if there is none. If it
  /// is not the only one, it follows from `otherwise`.
  template <class MayBe>
  [[nodiscard]] static constexpr finding nearest(const detail::layout_candidate& to, MayBe may_be,
                                                 recognised_by otherwise) noexcept {
    constexpr std::uint32_t usual_hz = 3000;
    const std::uint32_t hz = to.rate_hz() != 0 ? to.rate_hz() : usual_hz;
    const auto distance = [hz](const model& row) {
      const std::uint32_t first_hz = first_rate_hz(row);
      return first_hz > hz ? first_hz - hz : hz - first_hz;
    };
    finding best{nullptr, recognised_by::number};
    for (const model& row : models) {
      if (!may_be(row)) continue;
      if (best.which != nullptr) best.by = otherwise;
      if (best.which == nullptr || distance(row) < distance(*best.which)) best.which = &row;
    }
    return best;
  }

  // With samples of 2, 3 and 4 bytes; the rest of the format does not matter for finding packets.
  std::array<detail::layout_candidate, 3> candidates_{
      detail::layout_candidate(g4_format),
      detail::layout_candidate({sample_layout::intensity_8, correction_kind::none}),
      detail::layout_candidate({sample_layout::intensity_16, correction_kind::none})};
  bool is_finished_ = false;
};

}  // namespace g4lidar
