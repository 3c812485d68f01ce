// SPDX-License-Identifier: MIT
#include "first_contact.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "discovery/fitting_models.hpp"
#include "transport/custom_baud.hpp"

namespace g4lidar {
namespace {

/// The wait for the first reply, for each attempt: a device may be booting, and a reply may be
/// late. Then attempts if the bytes contained no packets or responses: they may have been noise.
constexpr std::array<std::int64_t, 8> patiences_ns{800 * ms, 800 * ms, 3'000 * ms, 300 * ms,
                                                   300 * ms, 300 * ms, 300 * ms,   300 * ms};
constexpr std::size_t attempts = 3;
/// Of a query that was repeated.
constexpr std::int64_t late_answer_ns = 400 * ms;
constexpr std::int64_t search_ns = 3'000 * ms;
/// Answers to 90, of which most decide the model.
constexpr int more_identities = 4;

}  // namespace

first_contact::state first_contact::make(stage_report& baud) {
  link_monitor& link = of_.link;
  examined_lidar& lidar = of_.lidar;
  const state found = search(baud);
  if (found == state::refused || link.is_over() || lidar.is_deaf) return found;
  const bool is_mute = lidar.is_one_way() || of_.log.options().listen_only;
  if (is_mute) return found == state::none ? unknown(baud) : found;
  const stream_counts& heard = link.searched().counts;
  const bool is_lidar =
      lidar.takes_commands() || link.boots() > 0 || heard.responses + heard.packets > 0;
  if (is_lidar || garbage_ == 0) {  // else it may be another device
    if (ask()) return state::made;
    const bool is_there = found == state::made || garbage_ == 0;
    if (is_there && lidar.takes_commands() && !link.is_over() && scans_when_started()) {
      of_.answers.find(diagnosis::answers_missing);
      return state::made;
    }
  }
  return unknown(baud);
}

/// The diagnosis of bytes that are none of a lidar.
first_contact::state first_contact::unknown(stage_report& baud) {
  link_monitor& link = of_.link;
  if (garbage_ == 0) garbage_ = link.searched().bytes;  // answers that were damaged
  if (garbage_ == 0 || link.is_over()) return state::none;
  baud.add("bytes_of_no_packet", garbage_);
  const std::optional<stream_survey>& other = link.searched().other;
  if (!find_other_source(baud, other ? *other : link.survey()) &&
      !find_other_layout(baud, link.survey().layout(), *of_.lidar.which)) {
    baud.find(diagnosis::unknown_bytes);
    if (!tried_.empty()) baud.remark = "No packet at any rate that was tried: " + tried_ + ".";
    if (baud.remark.empty()) baud.remark = arrived(link.survey());
  }
  return state::none;
}

bool first_contact::make_quiet() {
  of_.lidar.was_scanning = true;
  return !of_.link.is_over() && of_.link.stop();
}

void first_contact::report_scanning() {
  if (of_.lidar.is_one_way()) return;
  // Why one scans that ignores commands is not known.
  if (of_.lidar.is_deaf) {
    of_.answers.find(diagnosis::deaf);
  } else if (of_.lidar.was_scanning) {
    of_.answers.find(diagnosis::was_scanning);
  }
}

bool first_contact::ask() {
  of_.log.begin(diagnostic_activity::asking);
  for (std::size_t i = 0; i < patiences_ns.size() && !of_.link.is_over(); ++i) {
    if (i >= attempts && garbage_ == 0) return false;
    exchange made = of_.link.ask(command::device_info, patiences_ns.at(i));
    if (asked_ns_ < 0) asked_ns_ = made.asked_ns;
    if (made.is_answered() || made.wrong > 0) {
      of_.lidar.is_met = true;
      ask_the_rest(std::move(made));
      return true;
    }
    if (made.packets > 0) {
      if (!make_quiet()) return false;
      asked_ns_ = -1;
      continue;
    }
    if (!made.is_disturbed) garbage_ += made.skipped;
  }
  return false;
}

// If the query was repeated, the device was booting; or the replies are late, and others will
// follow.
void first_contact::ask_the_rest(exchange last) {
  link_monitor& link = of_.link;
  const bool booted = link.boots() > 0;
  const std::int64_t longest_ns = last.is_answered() ? last.answered_ns - asked_ns_ : 0;
  bool is_late = false;
  if (asked_ns_ != last.asked_ns) {
    of_.answers.add("first_answer_after_ms", longest_ns / ms);
    const std::uint64_t before = link.counts().responses;
    link.listen_for_quiet(longest_ns + 100 * ms, link.now_ns() + 10'000 * ms);
    is_late = (link.counts().responses > before || last.copies > 0) && !booted;
  }
  if (is_late) last.asked_ns = asked_ns_;
  const std::int64_t latency_ns = last.is_answered() && !booted ? last.latency_ns() : 0;
  const bool is_its = recognise(last);
  if (!booted) of_.replies.add(std::move(last));
  if (!is_its) return;  // the stage identity reports it
  ask_all(link, of_.replies, *of_.lidar.which, latency_ns);
}

/// The model by its own word. False if it contradicts the user.
bool first_contact::recognise(const exchange& first) {
  examined_lidar& lidar = of_.lidar;
  const auto stated = [&](bytes reply) -> std::optional<device_information> {
    const auto view = response_view::from(reply);
    return view ? view->as_device_info() : std::nullopt;
  };
  const auto once = stated(first.reply);
  if (!once || lidar.which->has_number(once->model)) {
    of_.link.read_as(*lidar.which);
    return true;
  }
  reply_statistics several;
  several.add(first);
  for (int i = 0; i < more_identities && !of_.link.is_over(); ++i) {
    exchange again = of_.link.ask(command::device_info, 600 * ms);
    if (lidar.is_named) of_.replies.add(again);
    several.add(std::move(again));
  }
  const auto who = several.snapshot(*lidar.which).information;
  if (!who) return true;
  const std::uint32_t baud = of_.link.port().baud();
  if (lidar.is_named) return !refuses_number(of_.log.options(), *lidar.which, who->model, baud);
  const std::size_t seen = lidar.was_scanning ? sample_size(lidar.which->samples.layout) : 0;
  const layout_recogniser& heard = of_.link.survey().layout();
  lidar.candidates = models_of_answer({.baud = baud,
                                       .is_baud_certain = lidar.has_baud,
                                       .sample_bytes = seen,
                                       .id = who->model,
                                       .sample_rate_hz = heard.rate_hz(),
                                       .frequency_chz = heard.frequency_chz(),
                                       .answers = presence::yes},
                                      true);
  lidar.which = lidar.candidates.front();
  of_.link.read_as(*lidar.which);
  return true;
}

// ---- the search ---------------------------------------------------------------------------------

first_contact::state first_contact::search(stage_report& baud) {
  link_monitor& link = of_.link;
  examined_lidar& lidar = of_.lidar;
  of_.log.begin(diagnostic_activity::searching);
  const std::uint32_t before = link.port().baud();
  const diagnostic_options& wanted = of_.log.options();
  search_options how{.baud = wanted.listen_only ? wanted.baud : 0,
                     .listen_only = wanted.listen_only,
                     .may_pulse_dtr = may_pulse_dtr_ && !wanted.listen_only,
                     .is_cancelled = wanted.is_cancelled};
  if (lidar.is_named) how.model = lidar.which;
  auto found = link.search(how, search_ns);
  // Which listens alone.
  if (!found && lidar.is_one_way() && !link.is_over()) {
    how.model = nullptr;
    how.may_pulse_dtr = false;
    found = link.search(how, search_ns);
  }
  if (!found) {
    if (link.port().baud() != before) static_cast<void>(link.set_baud(before));
    return judge_failure(found.error(), baud);
  }
  const auto is_named = [&lidar](const model* each) { return each == lidar.which; };
  if (lidar.is_named && std::ranges::none_of(found->candidates, is_named) &&
      !may_be_named(*found)) {
    contradict(baud, *found);
    return state::refused;
  }
  if (!lidar.is_named) {
    lidar.which = found->candidates.front();
    lidar.candidates = found->candidates;
  }
  if (!is_expected_rate(found->baud)) {
    baud.add("rate_that_works", found->baud);
    baud.find(diagnosis::wrong_baud_rate);
    baud.remark = "The bytes are right at " + std::to_string(found->baud) + " baud: those of " +
                  one_of(*lidar.which) + ".";
    return state::refused;
  }
  if (link.boots() > 0) asked_ns_ = link.searched().asked_ns;
  wait_for_late_answers();
  if (found->speaks_telnet) {
    baud.find(diagnosis::changed_bytes);
    baud.remark = words_for(stream_change::telnet);
  }
  lidar.is_met = true;
  lidar.is_deaf = found->is_silent;
  lidar.was_scanning = found->was_scanning && !wanted.listen_only;
  link.read_as(*lidar.which);
  return state::made;
}

/// A search that has found no lidar.
first_contact::state first_contact::judge_failure(const error& why, stage_report& baud) {
  const search_record& searched = of_.link.searched();
  const bool is_of_another = why.detail() == error_detail::unsupported_product ||
                             why.detail() == error_detail::other_maker;
  if (!is_of_another) {
    garbage_ = searched.unasked;
    asked_ns_ = searched.asked_ns;
    wait_for_late_answers();
    if (why == problem::garbage) tried_ = why.subject();
    return state::none;
  }
  if (searched.other && find_other_source(baud, *searched.other)) return state::refused;
  baud.find(diagnosis::other_device);
  baud.detail = why.detail();
  baud.remark = cause_of(why);
  return state::refused;
}

/// To questions of the search.
void first_contact::wait_for_late_answers() {
  link_monitor& link = of_.link;
  if (link.searched().asked_ns >= 0)
    link.listen_for_quiet(late_answer_ns, link.now_ns() + 10 * late_answer_ns);
}

/// Whether a lidar may be the named one that fits others better: it may report another number. At its rate the stage
/// identity decides that.
bool first_contact::may_be_named(const recognised_lidar& found) const {
  const examined_lidar& lidar = of_.lidar;
  const auto size_of = [](const model& row) { return sample_size(row.samples.layout); };
  const bool has_its_samples =
      !found.was_scanning || size_of(*found.candidates.front()) == size_of(*lidar.which);
  const bool answers = found.device.is_known() && !found.is_silent && !lidar.is_one_way();
  const bool is_at_its_rate = !lidar.has_baud || has_rate(*lidar.which, found.baud);
  return answers && has_its_samples &&
         (is_at_its_rate ||
          !refuses_number(of_.log.options(), *lidar.which, found.device.model, found.baud));
}

void first_contact::contradict(stage_report& baud, const recognised_lidar& found) {
  const examined_lidar& lidar = of_.lidar;
  const std::string words = words_of(found.candidates);
  const std::string where =
      lidar.has_baud ? " at " + std::to_string(found.baud) + " baud" : std::string();
  const model& closest = *found.candidates.front();
  const bool is_silent_one = !lidar.is_one_way() && closest.link == link_kind::one_way;
  if (is_silent_one) {
    of_.answers.find(diagnosis::one_way_lidar);
    of_.answers.remark = "This lidar answers nothing" + where +
                         ". Its bytes are those of these models: " + words + ". But " +
                         one_of(*lidar.which) + " answers.";
  } else {
    baud.find(diagnosis::other_device);
    baud.remark = "The lidar is " + one_of(closest) + where + ", not " + one_of(*lidar.which) + ".";
  }
  baud.add("found_model", words);
  if (lidar.has_baud) baud.add("found_baud", found.baud);
}

/// Whether this is the rate that the user has named, if he has.
bool first_contact::is_expected_rate(std::uint32_t baud) const noexcept {
  const std::uint32_t given = of_.log.options().baud;
  return !of_.lidar.has_baud || given == 0 || is_tolerable(baud, given);
}

// Whether a device that sends no reply starts nevertheless.
bool first_contact::scans_when_started() {
  link_monitor& link = of_.link;
  if (of_.lidar.is_driven_by_dtr()) pulse_dtr(link);
  link.send(command::start);
  link.listen_for(1'500 * ms);
  const bool scans = link.survey().layout().sample_bytes() != 0 || link.counts().packets > 0;
  link.stop();
  return scans;
}

}  // namespace g4lidar
