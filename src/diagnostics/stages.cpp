// SPDX-License-Identifier: MIT
// The stages that devices and files share, from the measurements.
#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "core/number_text.hpp"
#include "discovery/fitting_models.hpp"
#include "stages.hpp"

namespace g4lidar {
namespace {

/// More than a USB packet of 64 bytes at 230400 baud.
constexpr double held_back_limit_ms = 3.3;

/// The same at this rate, if that is more.
double held_back_limit_of_ms(std::uint32_t baud) noexcept {
  constexpr double usual_baud = 230'400.0;
  return held_back_limit_ms * std::max(1.0, usual_baud / baud);
}
/// The amount of damage up to which there is only a warning.
constexpr std::uint64_t few_events = 2;
constexpr double few_lost = 0.002;

/// "The packets have 4 bytes per sample; those of a G4 have 2."
std::string other_samples(std::size_t size, const model& wanted) {
  return "The packets have " + std::to_string(size) + " bytes per sample; those of " +
         one_of(wanted) + " have " + std::to_string(sample_size(wanted.samples.layout)) + ".";
}

/// "The number 15 is that of a G2; that of an X4 is 6.": the second half if a model was stated.
std::string other_number(std::uint8_t id, const model& wanted, bool is_stated) {
  const std::string number = "The number " + std::to_string(id) + " is that of ";
  const std::string_view product = other_product(id);
  const auto having = models_that_fit({.id = id});
  std::string text = number;
  if (!product.empty()) {
    text.append(product).append(", which is not supported");
  } else if (having.empty()) {
    text += "no known model";
  } else {
    text += one_of(*having.front());
  }
  if (is_stated) text += "; that of " + one_of(wanted) + " is " + std::to_string(wanted.ids[0]);
  if (is_stated && wanted.ids[1] != 0) text += " or " + std::to_string(wanted.ids[1]);
  text += ".";
  if (product.empty() && having.empty())
    text += " Please report it, with the file of g4-dump doctor --report.";
  return text;
}

/// The last diagnosis of each stage, in the order of the enumeration. An unplug belongs to the port.
constexpr std::array<std::pair<diagnosis, diagnostic_stage>, 14> last_of_stages{
    {{diagnosis::bad_file, diagnostic_stage::port},
     {diagnosis::permission, diagnostic_stage::permission},
     {diagnosis::interference, diagnostic_stage::holder},
     {diagnosis::wrong_baud_rate, diagnostic_stage::baud_rate},
     {diagnosis::answers_missing, diagnostic_stage::answers},
     {diagnosis::other_device, diagnostic_stage::identity},
     {diagnosis::health_error, diagnostic_stage::health},
     {diagnosis::motor_unsteady, diagnostic_stage::motor},
     {diagnosis::unplugged, diagnostic_stage::port},
     {diagnosis::host_busy, diagnostic_stage::stream},
     {diagnosis::sample_rate_off, diagnostic_stage::rate},
     {diagnosis::line_noise, diagnostic_stage::loss},
     {diagnosis::no_returns, diagnostic_stage::returns},
     {diagnosis::usb_latency, diagnostic_stage::usb_latency}}};

/// Whether a lidar like `model` can have measured so many samples in this time; 0 s: not known, and true.
bool may_measure_in(const model& model, double samples, double seconds) noexcept {
  constexpr double far = 2.0;  // beyond the highest rate of the model
  double most_hz = std::max(model.rates.nominal_hz, model.rates.most_seen_hz);
  for (const sample_rate_entry& each : model.rates.entries)
    most_hz = std::max<double>(most_hz, each.hz);
  return seconds <= 0.0 || most_hz <= 0.0 || samples <= far * most_hz * seconds;
}

}  // namespace

std::string one_of(const model& model) {
  return std::string(article_of(model)).append(" ").append(model.name);
}

diagnostic_stage stage_of(diagnosis what) noexcept {
  return std::ranges::lower_bound(last_of_stages, what, {},
                                  &decltype(last_of_stages)::value_type::first)
      ->second;
}

std::string words_of(std::span<const model* const> all) {
  return list_of(all, [](const model* each) { return each->word; }, " and ");
}

bool refuses_number(const diagnostic_options& options, const model& stated, std::uint8_t number,
                    std::uint32_t baud) {
  return !options.insist_on_model && is_surely_another(stated, number, baud);
}

bool report_identity(stage_log& log, const std::optional<device_information>& known,
                     const model& wanted, std::uint32_t baud, std::size_t sample_bytes) {
  if (!known) {
    log.skip(diagnostic_stage::identity, "There is no device information.");
    return true;
  }
  stage_report identity{.stage = diagnostic_stage::identity};
  identity.add("model", static_cast<int>(known->model));
  identity.add("firmware", std::to_string(known->firmware_major)
                               .append(".")
                               .append(std::to_string(known->firmware_minor)));
  identity.add("hardware", static_cast<int>(known->hardware));
  identity.add("serial_number",
               std::string(known->serial_digits.begin(), known->serial_digits.end()));
  const bool is_wanted = known->model == wanted.ids[0] || known->model == wanted.ids[1];
  const bool is_stated = log.options().model != nullptr || wanted.link == link_kind::one_way;
  const bool is_surely_other = is_stated ? refuses_number(log.options(), wanted, known->model, baud)
                                         : !other_product(known->model).empty();
  if (!is_wanted) {
    identity.find(is_surely_other ? diagnosis::other_device : diagnosis::other_number);
    if (!other_product(known->model).empty()) identity.detail = error_detail::unsupported_product;
    identity.remark = other_number(known->model, wanted, is_stated);
    const std::size_t own = sample_size(wanted.samples.layout);
    if (is_surely_other && sample_bytes != 0 && sample_bytes != own) {
      identity.detail = error_detail::other_samples;
      identity.add("bytes_per_sample", sample_bytes);
      identity.remark += " " + other_samples(sample_bytes, wanted);
    }
  }
  log.report(std::move(identity));
  return is_wanted || !is_surely_other;
}

bool report_health(stage_log& log, const std::optional<health>& known) {
  if (!known) {
    log.skip(diagnostic_stage::health, "There is no health information.");
    return true;
  }
  stage_report report{.stage = diagnostic_stage::health};
  report.add("status", name_of(known->status));
  report.add("error_code", known->error_code);
  if (known->status == health_status::warning) report.find(diagnosis::health_warning);
  if (known->status == health_status::error) report.find(diagnosis::health_error);
  log.report(std::move(report));
  return known->status != health_status::error;
}

bool is_mostly_damaged(const stream_statistics& measured) noexcept {
  const stream_counts& counts = measured.tally().counts;
  const std::uint64_t damaged =
      counts.skipped(skip_reason::bad_checksum) + counts.skipped(skip_reason::bad_header);
  return damaged > counts.parsed_bytes && 4 * damaged > counts.skipped_bytes();
}

void judge_stream(stage_report& stream, const stream_statistics& measured, double seconds) {
  const arrival_statistics& arrivals = measured.tally().arrivals;
  const stream_counts& counts = measured.tally().counts;
  if (seconds > 0.0) stream.add("seconds", seconds);
  stream.add("bytes", arrivals.bytes());
  stream.add("packets", counts.packets);
  stream.add("points", counts.points);
  if (measured.tally().jerks > 0) stream.add("jerks", measured.tally().jerks);
  if (seconds > 0.0) stream.add("longest_silence_ms", arrivals.longest_silence_ns() / 1'000'000);
  if (arrivals.longest_host_pause_ns() > 0) {
    stream.add("longest_host_pause_ms", arrivals.longest_host_pause_ns() / 1'000'000);
  }
  if (arrivals.stalls() > 0) {
    stream.add("stalls", arrivals.stalls());
    if (stream.diagnoses.empty() && !is_host_busy(measured)) stream.find(diagnosis::stalls);
  }
  if (measured.has_become_garbage()) {
    stream.add("bytes_since_last_packet", measured.bytes_since_packet());
    if (!is_mostly_damaged(measured)) stream.find(diagnosis::wrong_baud_rate);
  }
  // Among many damaged packets some have a matching checksum, and look like jolts.
  if (20 * measured.tally().jerks > measured.tally().damage.changed && measured.was_steady()) {
    stream.find(diagnosis::jolts);
  }
  if (is_host_busy(measured)) stream.find(diagnosis::host_busy);
}

void judge_motor(stage_report& motor, const stream_statistics& measured) {
  if (measured.tally().counts.packets <= few_packets || measured.was_steady()) return;
  if (is_mostly_damaged(measured)) {
    motor.outcome = stage_verdict::skipped;
    motor.remark = "Too many packets are damaged.";
    return;
  }
  motor.find(measured.stands() ? diagnosis::motor_stuck : diagnosis::motor_unsteady);
}

void report_loss(stage_log& log, const stream_statistics& measured, const model& wanted,
                 const stream_survey* seen, double seconds) {
  if (measured.tally().arrivals.bytes() == 0)
    return log.skip(diagnostic_stage::loss, "Nothing arrived.");
  stage_report loss{.stage = diagnostic_stage::loss};
  const double all = static_cast<double>(measured.tally().samples + measured.tally().lost);
  const double lost = static_cast<double>(measured.tally().lost) / std::max(all, 1.0);
  const bool is_possible = may_measure_in(wanted, all, seconds);
  if (is_possible) {
    loss.add("lost_percent", 100.0 * lost);
    loss.add("samples_lost", measured.tally().lost);
  } else {
    loss.remark =
        "The angles go back and forth, as those of no head that turns: what is lost is not known.";
  }
  for (const auto reason : {skip_reason::noise, skip_reason::bad_header, skip_reason::bad_checksum,
                            skip_reason::truncated}) {
    loss.add(std::string("skipped_") + name_of(reason), measured.tally().counts.skipped(reason));
  }
  const damage_counts& damage = measured.tally().damage;
  for (const auto& [name, count] :
       {std::pair("crc_matches", measured.tally().counts.crc_matches),
        std::pair("crc_mismatches", measured.tally().counts.crc_mismatches),
        std::pair("changed", damage.changed), std::pair("shortened", damage.shortened),
        std::pair("cut", damage.cut), std::pair("lengthened", damage.lengthened),
        std::pair("vanished", damage.vanished), std::pair("unclear", damage.unclear)}) {
    if (count > 0) loss.add(name, count);
  }
  if (damage.one_packet > 0) {
    loss.add("wrong_bits_in_a_checksum",
             static_cast<double>(damage.wrong_bits) / static_cast<double>(damage.one_packet));
  }
  if (measured.was_steady()) {
    const std::string_view of_the_line = describe(diagnosis::line_noise).advice;
    const bool is_changed = seen != nullptr && seen->change() != stream_change::none;
    for (const diagnosis what : diagnoses_of(measured)) {
      if (what == diagnosis::packets_lost && !is_possible) continue;
      const bool is_of_bridge =
          log.by() == byte_path::network && describe(what).advice == of_the_line;
      loss.find(is_changed || is_of_bridge ? diagnosis::changed_bytes : what);
    }
    if (is_changed && !loss.diagnoses.empty()) loss.remark = seen->finding();
  }
  if (loss.diagnoses.empty() && is_mostly_damaged(measured)) loss.find(diagnosis::line_noise);
  const stream_counter& counts = measured.tally().counts;
  if (wanted.ct_information == presence::yes && counts.packets > few_packets &&
      counts.crc_matches + counts.crc_mismatches == 0) {
    loss.remark =
        "No CRC byte was seen, which " + one_of(wanted) + " sends: old firmware has none.";
  }
  if (damage.all() <= few_events && !is_mostly_damaged(measured)) {
    if (!loss.diagnoses.empty()) loss.remark = "This is little evidence: measure longer.";
    if (lost < few_lost) loss.outcome = std::min(loss.outcome, stage_verdict::warn);
  }
  log.report(std::move(loss));
}

std::string arrived(const stream_survey& heard) {
  const std::string text(heard.all().text());
  return text.empty() ? text : text.substr(text.find_first_not_of(", ")) + " arrived.";
}

bool find_other_source(stage_report& report, const stream_survey& seen) {
  std::string finding = seen.finding();
  if (finding.empty()) return false;
  report.find(seen.is_of_another() ? diagnosis::no_lidar : diagnosis::changed_bytes);
  const std::string all(seen.all().text());
  const bool is_clear = seen.maker() != nullptr || seen.echo() != echo_kind::none;
  if (!is_clear && !all.empty()) finding += " It begins with" + all.substr(1) + ".";
  report.remark = std::move(finding);
  return true;
}

bool find_other_layout(stage_report& report, const layout_recogniser& seen, const model& wanted) {
  const std::size_t size = seen.sample_bytes();
  const std::size_t wanted_size = sample_size(wanted.samples.layout);
  if (size == 0 || size == wanted_size) return false;
  report.add("bytes_per_sample", size);
  report.find(diagnosis::other_device);
  report.detail = error_detail::other_samples;
  report.remark = other_samples(size, wanted);
  return true;
}

void report_latency(stage_log& log, const stream_statistics& measured, std::uint32_t baud,
                    std::string_view name) {
  if (log.by() == byte_path::network) {
    return log.skip(diagnostic_stage::usb_latency, "It does not apply to a network bridge.");
  }
  if (is_pty(std::string(name))) {
    return log.skip(diagnostic_stage::usb_latency, "There is no USB bridge in this connection.");
  }
  if (baud == 0 || !measured.tally().arrivals.has_delays()) {
    return log.skip(diagnostic_stage::usb_latency, "There is nothing to measure it by.");
  }
  stage_report latency{.stage = diagnostic_stage::usb_latency};
  const double held_ms = measured.tally().arrivals.held_back_ms(baud);
  latency.add("held_back_ms", held_ms);
  if (measured.tally().arrivals.longest_host_pause_ns() > 0) {
    latency.remark = "This computer was busy: that delays bytes, too.";
  } else if (held_ms > held_back_limit_of_ms(baud)) {
    latency.find(diagnosis::usb_latency);
  }
  log.report(std::move(latency));
}

}  // namespace g4lidar
