// SPDX-License-Identifier: MIT
// The steps with a running scan: stream, sample bits, CT bytes, time packets, targets; and the unplug.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "acceptance_run.hpp"

namespace g4lidar {
namespace {

using enum acceptance_verdict;

constexpr std::int64_t spun_up_ns = 3'000 * ms;

}  // namespace

void acceptance_run::stream(acceptance_result& into) {
  if (link_->start() < 0) {
    link_->stop();
    return into.add_finding(differs, "No packet came.");
  }
  static_cast<void>(link_->survey(spun_up_ns));
  const std::uint64_t skipped_before = link_->monitor().counts().skipped_bytes();
  surveyed_.emplace(link_->survey(std::chrono::nanoseconds(options_.stream_time).count()));
  const stream_survey& heard = *surveyed_;
  link_->stop();
  into.add("packets", heard.packets());
  into.add("bad_checksums", heard.bad_checksums());
  into.add("skipped_bytes", link_->monitor().counts().skipped_bytes() - skipped_before);
  into.add("revolutions", heard.zero_packets());
  into.add("most_samples", heard.most_samples());
  into.add("sample_rate_hz", heard.sample_rate_hz());
  into.add("frequency_hz", heard.frequency_hz());
  into.add("reported_hz", heard.reported_hz());
  into.add("sample_bytes", link_->monitor().layout().sample_bytes());
  if (heard.packets() == 0)
    return into.add_finding(differs, "No packet of the model's layout came.");
  const std::uint64_t all = heard.packets() + heard.bad_checksums();
  constexpr std::uint64_t hundred = 100;
  const bool is_clean = heard.bad_checksums() * hundred <= all;
  into.add_finding(is_clean ? agrees : differs, is_clean
                                                    ? "The packets have the layout of the model."
                                                    : "Many packets have a wrong checksum.");
  if (heard.most_samples() > which_->samples.max_samples) {
    into.add_finding(differs, "Packets are longer than in the table.");
  }
  const expected_rate rate = expected_rate_of(*which_, first_rate_hz(*which_));
  const bool is_known_rate =
      std::ranges::any_of(which_->rates.entries, [&](const sample_rate_entry& each) {
        return each.hz != 0 &&
               std::abs(heard.sample_rate_hz() / each.hz - 1.0) <= std::max(rate.tolerance, 0.1);
      });
  if (!is_known_rate) into.add_finding(differs, "The sample rate is none of the table.");
  if (heard.reported_hz() <= 0.0) {
    into.add_finding(observed, "Zero packets do not report the frequency.");
  } else {
    const double offset_hz = heard.frequency_hz() - heard.reported_hz();
    into.add("offset_hz", offset_hz);
    constexpr double tolerance_hz = 0.3;
    const double stated_hz = which_->frequency.ct_offset_dhz / 10.0;
    if (std::abs(offset_hz - stated_hz) > tolerance_hz) {
      into.add_finding(differs, "The frequency in zero packets has another offset.");
    }
  }
}

void acceptance_run::sample_bits(acceptance_result& into) const {
  const stream_survey& heard = *surveyed_;
  constexpr std::array<std::string_view, stream_survey::zones> names{"no_return", "below_1_m",
                                                                     "below_2_m", "beyond"};
  std::uint64_t with_bits = 0;
  for (std::size_t zone = 0; zone < names.size(); ++zone) {
    for (unsigned value = 0; value < 4; ++value) {
      const std::uint64_t count = heard.bits(static_cast<stream_survey::zone>(zone), value);
      into.add(std::string(names.at(zone)) + "_bits_" + std::to_string(value), count);
      if (value != 0) with_bits += count;
    }
  }
  into.add_finding(observed, with_bits == 0 ? "The two lower bits are always 0."
                                            : "The two lower bits are used.");
}

void acceptance_run::ct_information(acceptance_result& into) const {
  const stream_survey& heard = *surveyed_;
  into.add("crc_fits", heard.crc_fits());
  into.add("crc_does_not_fit", heard.crc_misfits());
  into.add("packets_with_ct", heard.informing_packets());
  const bool has_crc = heard.crc_fits() >= 3 && heard.crc_fits() > heard.crc_misfits();
  into.add_finding(observed,
                   has_crc ? "A CRC byte follows each revolution." : "There is no CRC byte.");
  const auto& who = heard.information();
  if (who) {
    into.add("id_low_bits", who->id_low_bits);
    into.add("firmware",
             std::to_string(who->firmware_major) + "." + std::to_string(who->firmware_minor));
    into.add("hardware", who->hardware);
    into.add("faults", static_cast<std::uint8_t>(who->faults));
  }
  constexpr std::uint64_t packets_with_information = 14;
  if (!who && has_crc && heard.packets() < packets_with_information * heard.zero_packets()) {
    return into.add_finding(observed, "A revolution has too few packets for the information.");
  }
  const presence seen = who ? presence::yes : presence::no;
  const bool is_open = which_->ct_information == presence::unknown;
  into.add_finding(
      is_open                          ? observed
      : seen == which_->ct_information ? agrees
                                       : differs,
      who ? "The CT bytes contain information." : "The CT bytes contain no information.");
}

void acceptance_run::time_packets(acceptance_result& into) const {
  into.add("time_packets", surveyed_->time_packets());
  into.add_finding(observed, surveyed_->time_packets() > 0 ? "It sends time packets."
                                                           : "It sends no time packets.");
}

void acceptance_run::target(acceptance_result& into, acceptance_action where) {
  const auto placed_mm = options_.ask ? options_.ask(where) : std::nullopt;
  if (!placed_mm) return into.add_finding(not_done, "The user declined.");
  if (link_->start() < 0) {
    link_->stop();
    return into.add_finding(differs, "No packet came.");
  }
  static_cast<void>(link_->survey(spun_up_ns));
  direction_survey seen(*which_);
  std::int64_t until_ns = link_->monitor().now_ns() + 3'000 * ms;
  link_->monitor().listen(until_ns, {.event = [&](const observed_event& found) {
                            const auto* const packet = std::get_if<packet_view>(&found.what);
                            if (packet != nullptr) seen.take(*packet);
                          }});
  link_->stop();
  if (where == acceptance_action::place_near) target_degree_ = seen.nearest();
  const auto range_mm = target_degree_ ? seen.range_mm(*target_degree_) : std::nullopt;
  if (!range_mm) return into.add_finding(differs, "Nothing was measured in this direction.");
  const double angle_deg = static_cast<double>(*target_degree_) + 0.5;
  into.add("placed_mm", *placed_mm);
  into.add("measured_mm", *range_mm);
  into.add("ratio", *range_mm / *placed_mm);
  into.add("device_angle_deg", angle_deg);
  into.add("robot_bearing_deg", std::remainder(which_->turn_deg - angle_deg, 360.0));
  const double allowed_mm = std::max(30.0, 0.05 * *placed_mm);
  const bool is_near = std::abs(*range_mm - *placed_mm) <= allowed_mm;
  into.add_finding(is_near ? agrees : differs, is_near ? "The range is that of the target."
                                                       : "The range is not that of the target.");
  if (where == acceptance_action::place_near) {
    into.add_finding(observed, "The direction of the target shows where zero is.");
  }
}

void acceptance_run::unplug(acceptance_result& into) {
  constexpr std::int64_t retry_ns = 200 * ms;
  const auto wait_ns = std::chrono::nanoseconds(options_.plug_time).count();
  const auto frequency = [this]() -> std::optional<std::int32_t> {
    if (which_->frequency.max_dhz == 0) return std::nullopt;
    return link_->ask(static_cast<std::uint8_t>(command::frequency_query)).number();
  };
  const auto frequency_before = frequency();
  if (!options_.ask || !options_.ask(acceptance_action::unplug)) {
    return into.add_finding(not_done, "The user declined.");
  }
  const std::int64_t begin_ns = link_->monitor().now_ns();
  while (!link_->monitor().is_over() && link_->monitor().now_ns() < begin_ns + wait_ns)
    link_->monitor().listen_for(retry_ns);
  if (link_->monitor().is_cancelled()) return into.add_finding(not_done, "Interrupted.");
  if (!link_->monitor().failure()) return into.add_finding(differs, "The connection was not lost.");
  into.add("lost_as", std::string(name_of(link_->monitor().failure()->code())));
  if (!options_.ask(acceptance_action::plug_in))
    return into.add_finding(not_done, "The user declined.");
  const std::int64_t gone_ns = from_.now_ns();
  link_.reset();
  while (!open() && from_.now_ns() < gone_ns + wait_ns) {
    if (options_.is_cancelled && options_.is_cancelled()) break;
    static_cast<void>(from_.pause(from_.now_ns() + retry_ns));
  }
  if (!link_) return into.add_finding(differs, "The lidar did not come back.");
  into.add("back_after_ms", static_cast<double>(from_.now_ns() - gone_ns) / 1e6);
  if (!is_two_way()) {
    if (which_->motor == motor_kind::dtr) static_cast<void>(link_->set_dtr(true));
    const bool sends = link_->wait_for_packet(12'000 * ms) >= 0;
    return into.add_finding(sends ? agrees : differs,
                            sends ? "It sends again." : "It does not send again.");
  }
  bytes who;
  raw_reply got;
  constexpr int tries = 5;  // it boots
  for (int i = 0; i < tries && who.empty(); ++i) {
    got = link_->ask(static_cast<std::uint8_t>(command::device_info), 1'000 * ms);
    who = got.content();
  }
  const bool is_same = std::ranges::equal(who, identified_);
  into.add_finding(is_same ? agrees : differs,
                   is_same ? "The same lidar answers." : "Another lidar answers, or none.");
  const auto frequency_after = frequency();
  if (!frequency_before || !frequency_after) return;
  into.add("frequency_before_hz", *frequency_before / 100.0);
  into.add("frequency_after_hz", *frequency_after / 100.0);
}

}  // namespace g4lidar
