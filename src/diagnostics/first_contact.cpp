// SPDX-License-Identifier: MIT
#include "first_contact.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "discovery/model_choice.hpp"
#include "transport/custom_baud.hpp"

namespace g4lidar {
namespace {

/// The time of observation before anything is sent.
constexpr std::int64_t unasked_ns = 300 * ms;
/// A one-way lidar whose motor spins up sends its first packet by then.
constexpr std::int64_t unasked_one_way_ns = 1'500 * ms;
/// The wait for the first reply, for each attempt: a device may be booting, and a reply may be
/// late. Then attempts if the bytes contained no packets or responses: they may have been noise.
constexpr std::array<std::int64_t, 8> patiences_ns{800 * ms, 800 * ms, 3'000 * ms, 300 * ms,
                                                   300 * ms, 300 * ms, 300 * ms,   300 * ms};
constexpr std::size_t attempts = 3;
/// Packets arrive more often.
constexpr std::int64_t silent_ns = 200 * ms;
constexpr std::int64_t search_ns = 3'000 * ms;
/// Answers to 90, of which most decide the model.
constexpr int more_identities = 4;

}  // namespace

first_contact::state first_contact::make(stage_report& baud) {
  link_monitor& link = of_.link;
  examined_lidar& lidar = of_.lidar;
  const bool is_met = lidar.is_one_way() ? hear_stream() : make_quiet() && ask(0, 1);
  if (is_met || link.is_over()) return is_met ? state::made : state::none;
  const bool is_noise = garbage_ > 0;
  // A device that has written its boot text and nothing more boots. Other bytes may look like a text.
  const bool is_booting = link.boots() > 0 && link.now_ns() > link.heard_ns() + silent_ns;
  state found = state::none;
  if (!is_booting) {
    found = search(baud);
    if (found == state::refused || link.is_over()) return found;
    if (found == state::made && lidar.is_one_way()) return found;
  }
  if (lidar.is_deaf) return state::made;
  if (!lidar.is_one_way()) {
    const std::size_t end = is_noise || garbage_ > 0 ? patiences_ns.size() : attempts;
    if (ask(is_noise ? 0 : 1, end) || lidar.was_scanning) return state::made;
    const bool is_there = found == state::made || garbage_ == 0;
    if (is_there && lidar.takes_commands() && !link.is_over() && scans_when_started()) {
      of_.answers.find(diagnosis::answers_missing);
      return state::made;
    }
  }
  if (garbage_ > 0 && !link.is_over()) {
    baud.add("bytes_of_no_packet", garbage_);
    if (!find_other_source(baud, link.survey()) &&
        !find_other_layout(baud, link.layout(), *lidar.which)) {
      baud.find(diagnosis::unknown_bytes);
      if (!tried_.empty()) baud.remark = "No packet at any rate that was tried: " + tried_ + ".";
      if (baud.remark.empty()) baud.remark = arrived(link.survey());
    }
  }
  return state::none;
}

/// Whether packets of the one-way lidar arrive that was named.
bool first_contact::hear_stream() {
  link_monitor& link = of_.link;
  of_.log.begin(diagnostic_activity::listening);
  if (of_.lidar.is_driven_by_dtr()) static_cast<void>(link.port().set_dtr(true));
  const std::int64_t until_ns = link.now_ns() + unasked_one_way_ns;
  while (!link.is_over() && link.now_ns() < until_ns && link.layout().sample_bytes() == 0) {
    link.listen_for(longest_read_ns);
  }
  const std::size_t size = link.layout().sample_bytes();
  if (size == 0) garbage_ = link.counts().skipped_bytes();
  return size == sample_size(of_.lidar.which->samples.layout);
}

/// Whether the packets that were recognised cannot be those of a one-way lidar.
bool first_contact::is_of_two_way() const {
  const layout_recogniser& seen = of_.link.layout();
  const auto fitting = models_that_fit({.baud = of_.link.port().baud(),
                                        .is_baud_certain = of_.lidar.has_baud,
                                        .sample_bytes = seen.sample_bytes(),
                                        .sample_rate_hz = seen.rate_hz()});
  return seen.sample_bytes() != 0 && std::ranges::none_of(fitting, [](const model* row) {
           return row->link == link_kind::one_way;
         });
}

bool first_contact::make_quiet() {
  link_monitor& link = of_.link;
  of_.log.begin(diagnostic_activity::listening);
  link.listen_for(unasked_ns);
  if (link.counts().packets > 0 && link.layout().sample_bytes() == 0) link.listen_for(unasked_ns);
  const bool is_recognised = link.layout().sample_bytes() != 0;
  const bool has_packets = is_recognised || link.counts().packets > 0;
  const std::uint64_t skipped = link.counts().skipped_bytes();
  of_.lidar.is_met = of_.lidar.is_met || is_of_two_way();
  if (!of_.lidar.is_named && is_recognised) link.read_as(link.layout().most_likely());
  const std::uint64_t unasked = link.counts().packets;
  if (!has_packets && link.boots() == 0 && skipped > 0 && !of_.lidar.is_named) {
    garbage_ += skipped;
    return false;  // nothing is sent to what may be another device
  }
  if (!of_.lidar.takes_commands()) return !has_packets;
  const bool is_quiet = !link.is_over() && link.stop();
  const stream_counts& now = link.counts();
  if (has_packets || now.packets > 0) of_.lidar.was_scanning = true;
  if (!of_.lidar.was_scanning && link.boots() == 0) garbage_ += now.skipped_bytes();
  if (is_quiet || link.is_over()) return is_quiet;
  of_.lidar.is_deaf = now.packets > unasked;
  return false;
}

void first_contact::report_scanning() {
  if (of_.lidar.is_one_way()) return;
  if (of_.lidar.was_scanning) of_.answers.find(diagnosis::was_scanning);
  if (of_.lidar.is_deaf) of_.answers.find(diagnosis::deaf);
}

bool first_contact::ask(std::size_t from, std::size_t to) {
  of_.log.begin(diagnostic_activity::asking);
  for (std::size_t i = from; i < to && !of_.link.is_over(); ++i) {
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
  const auto is_its = [&](const device_information& who) {
    return who.model == lidar.which->ids[0] || who.model == lidar.which->ids[1];
  };
  if (!once || is_its(*once)) {
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
  const bool is_other_product = !other_product(who->model).empty();
  lidar_signs known{.baud = baud,
                    .is_baud_certain = lidar.has_baud,
                    .sample_bytes = of_.link.layout().sample_bytes(),
                    .id = who->model,
                    .answers = presence::yes};
  lidar.candidates = models_that_fit(known);
  if (lidar.candidates.empty() && !is_other_product) {  // its samples decide
    known.id = 0;
    lidar.candidates = models_that_fit(known);
  }
  if (!lidar.candidates.empty()) lidar.which = lidar.candidates.front();
  of_.link.read_as(*lidar.which);
  return true;
}

// ---- the search ---------------------------------------------------------------------------------

first_contact::state first_contact::search(stage_report& baud) {
  link_monitor& link = of_.link;
  examined_lidar& lidar = of_.lidar;
  of_.log.begin(diagnostic_activity::searching);
  const std::uint32_t before = link.port().baud();
  const auto found = link.search({.may_pulse_dtr = may_pulse_dtr_}, search_ns);
  if (!found) {
    if (link.port().baud() != before) static_cast<void>(link.set_baud(before));
    const error_detail why = found.error().detail();
    if (why != error_detail::unsupported_product && why != error_detail::other_maker) {
      if (found.error() == problem::garbage) tried_ = found.error().subject();
      return state::none;
    }
    baud.find(diagnosis::other_device);
    baud.remark = cause_of(found.error());
    return state::refused;
  }
  garbage_ = 0;
  const auto is_named = [&lidar](const model* each) { return each->word == lidar.which->word; };
  if (lidar.is_named && std::ranges::none_of(found->candidates, is_named)) {
    contradict(baud, *found);
    return state::refused;
  }
  if (!lidar.is_named) {
    lidar.which = found->model;
    lidar.candidates = found->candidates;
  }
  if (!is_expected_rate(found->baud)) {
    baud.add("rate_that_works", found->baud);
    baud.find(diagnosis::wrong_baud_rate);
    baud.remark = "The bytes are right at " + std::to_string(found->baud) + " baud: those of " +
                  one_of(*lidar.which) + ".";
    return state::refused;
  }
  if (link.port().baud() != before) asked_ns_ = -1;  // that query did not reach it
  lidar.is_met = true;
  lidar.is_deaf = false;
  lidar.was_scanning = lidar.was_scanning || found->was_scanning;
  link.read_as(*lidar.which);
  return state::made;
}

void first_contact::contradict(stage_report& baud, const recognised_lidar& found) {
  const examined_lidar& lidar = of_.lidar;
  const std::string words = words_of(found.candidates);
  const std::string where =
      lidar.has_baud ? " at " + std::to_string(found.baud) + " baud" : std::string();
  const bool is_silent_one = !lidar.is_one_way() && found.model->link == link_kind::one_way;
  if (is_silent_one) {
    of_.answers.find(diagnosis::one_way_lidar);
    of_.answers.remark = "This lidar answers nothing" + where +
                         ". Its bytes are those of these models: " + words + ". But " +
                         one_of(*lidar.which) + " answers.";
  } else {
    baud.find(diagnosis::other_device);
    baud.remark =
        "The lidar is " + one_of(*found.model) + where + ", not " + one_of(*lidar.which) + ".";
  }
  baud.add("found_model", words);
  if (lidar.has_baud) baud.add("found_baud", found.baud);
}

/// Whether this is the rate that the user has named, or else one of the model that the user has named.
bool first_contact::is_expected_rate(std::uint32_t baud) const noexcept {
  const auto is_near = [baud](std::uint32_t wanted) {
    return wanted != 0 && is_tolerable(baud, wanted);
  };
  const std::uint32_t given = of_.log.options().baud;
  if (!of_.lidar.has_baud) return true;
  if (given != 0) return is_near(given);
  return !of_.lidar.is_named || std::ranges::any_of(of_.lidar.which->bauds, is_near);
}

// Whether a device that sends no reply starts nevertheless.
bool first_contact::scans_when_started() {
  link_monitor& link = of_.link;
  if (of_.lidar.is_driven_by_dtr()) pulse_dtr(link);
  link.send(command::start);
  link.listen_for(1'500 * ms);
  const bool scans = link.layout().sample_bytes() != 0 || link.counts().packets > 0;
  link.stop();
  return scans;
}

}  // namespace g4lidar
