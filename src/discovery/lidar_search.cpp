// SPDX-License-Identifier: MIT
#include "lidar_search.hpp"

#include <algorithm>
#include <utility>

#include "g4lidar/core/request.hpp"
#include "inquiry.hpp"

namespace g4lidar {
namespace {

constexpr std::int64_t ms = 1'000'000;
/// A G4 that scans sends five packets in it.
constexpr std::int64_t first_listening_ns = 30 * ms;
/// The slowest stream, of an X2, has three packets in 50 ms.
constexpr std::int64_t listening_ns = 120 * ms;
constexpr std::int64_t answer_ns = 150 * ms;
/// In later rounds: of a device that boots, or behind a slow network.
constexpr std::int64_t late_answer_ns = 400 * ms;
/// A lidar that announces itself sends packets right after it.
constexpr std::int64_t announcement_ns = 40 * ms;
/// Two revolutions at 4 Hz: the CT bytes of one of them are complete.
constexpr std::int64_t information_ns = 600 * ms;
/// One attempt to stop a scan, and a slow answer; or several.
constexpr std::int64_t one_stop_ns = 700 * ms;
constexpr std::int64_t stops_ns = 2'000 * ms;
constexpr std::int64_t look_ns = 50 * ms;  // between two questions whether it is cancelled
constexpr std::int64_t pulse_ns = 100 * ms;
constexpr std::int64_t after_pulse_ns = 2'000 * ms;
constexpr std::int64_t write_ns = 100 * ms;
/// Fewer bytes in a time of listening are noise, or the end of a message.
constexpr std::size_t stream_bytes = 32;

/// Of lidars of the same manufacturer with line sensors: A5 A5 A5 A5, and an address.
constexpr std::uint8_t foreign_start = 0xA5;

error refused(const transport& port, std::string_view product) {
  return {task::asking, problem::other_device,
          std::string(port.name()).append(", a ").append(product), 0,
          error_detail::unsupported_product};
}

}  // namespace

lidar_search::lidar_search(transport& port, const search_options& options)
    : port_(port), options_(options) {
  const auto add = [this](std::uint32_t baud) {
    if (baud != 0 && std::ranges::find(rates_, baud) == rates_.end()) rates_.push_back(baud);
  };
  if (options.baud != 0) {
    add(options.baud);
  } else if (options.model != nullptr) {
    std::ranges::for_each(options.model->bauds, add);
  } else {
    std::ranges::for_each(usual_rates, add);
  }
}

std::int64_t lidar_search::in_ns(std::int64_t time_ns) const noexcept {
  return std::min(port_.now_ns() + time_ns, deadline_ns_);
}

result<recognised_lidar> lidar_search::run(std::int64_t deadline_ns) {
  auto done = find(deadline_ns);
  // Also where an earlier program has kept the line, so that the system would not lower it.
  if (!done && has_pulsed_) static_cast<void>(port_.set_dtr(false));
  return done;
}

result<recognised_lidar> lidar_search::find(std::int64_t deadline_ns) {
  deadline_ns_ = deadline_ns;
  for (bool is_first = true; port_.now_ns() < deadline_ns_; is_first = false) {
    auto done = round(is_first);
    const bool has_time = port_.now_ns() + one_stop_ns + information_ns < deadline_ns_;
    if (!done && done.error() == problem::does_not_stop && has_time) continue;
    if (done && !*done && options_.may_pulse_dtr && sending_ == 0) done = pulse();
    if (!done) return tl::unexpected(done.error());
    // NOLINTNEXTLINE(bugprone-unchecked-optional-access): checked by the caller
    if (*done) return std::move(**done);
  }
  return not_found();
}

lidar_search::found lidar_search::round(bool is_first) {
  sending_ = 0;
  auto done = visit(rates_.front(), first_listening_ns);
  if (!done || *done) return done;
  if (sending_ == 0 && !only_listens()) {
    done = question(rates_.front(), is_first ? answer_ns : late_answer_ns);
    if (!done || *done) return done;
  }
  for (std::size_t i = has_fixed_rate_ ? rates_.size() : 1; i < rates_.size(); ++i) {
    done = visit(rates_[i], listening_ns);
    if (!done || *done) return done;
  }
  if (has_fixed_rate_) return done;
  if (sending_ == rates_.size() && rates_.size() > 1) {
    for (const std::uint32_t baud : unusual_rates) {
      done = visit(baud, listening_ns);
      if (!done || *done) return done;
    }
  }
  if (sending_ > 0 || only_listens()) return done;
  for (std::size_t i = 1; i < rates_.size(); ++i) {
    done = question(rates_[i], answer_ns);
    if (!done || *done) return done;
  }
  return done;
}

/// Whether the port has this rate now, as far as it has one.
result<bool> lidar_search::tune(std::uint32_t baud) {
  heard_ = {};
  if (std::ranges::find(tried_, baud) == tried_.end()) tried_.push_back(baud);
  const auto set = port_.set_baud(baud);
  if (!set) {
    if (set.error() == problem::bad_baud_rate) return false;
    return tl::unexpected(set.error());
  }
  has_fixed_rate_ = !*set;
  return true;
}

lidar_search::found lidar_search::visit(std::uint32_t baud, std::int64_t listen_ns) {
  const auto tuned = tune(baud);
  if (!tuned) return tl::unexpected(tuned.error());
  if (!*tuned) return std::nullopt;
  const auto is_decided = [this] { return heard_.stream.sample_bytes() != 0; };
  if (auto done = listen(in_ns(listen_ns), is_decided); !done) return tl::unexpected(done.error());
  if (heard_.bytes > 0 && !is_decided()) {
    if (auto done = listen(in_ns(listening_ns), is_decided); !done) {
      return tl::unexpected(done.error());
    }
  }
  constexpr unsigned enough = 3;
  if (heard_.foreign >= enough) return tl::unexpected(refused(port_, "GS"));
  if (is_decided()) return judge_stream();
  if (heard_.bytes >= stream_bytes) ++sending_;
  return std::nullopt;
}

lidar_search::found lidar_search::question(std::uint32_t baud, std::int64_t wait_ns) {
  if (port_.now_ns() >= deadline_ns_) return std::nullopt;
  const auto tuned = tune(baud);
  if (!tuned) return tl::unexpected(tuned.error());
  if (!*tuned) return std::nullopt;
  const auto ask = encode(command::device_info);
  all_heard_.sent(ask);
  const auto sent = port_.write(ask, port_.now_ns() + write_ns);
  if (!sent && sent.error() != problem::timeout) return tl::unexpected(sent.error());
  const auto is_enough = [this] { return heard_.device || heard_.stream.sample_bytes() != 0; };
  if (auto done = listen(in_ns(wait_ns), is_enough); !done) return tl::unexpected(done.error());
  if (heard_.stream.sample_bytes() != 0) return judge_stream();
  return heard_.device ? judge_reply() : found();
}

/// For a motor that DTR drives: it needs an edge.
lidar_search::found lidar_search::pulse() {
  options_.may_pulse_dtr = false;  // once
  auto lowered = port_.set_dtr(false);
  if (!lowered) return tl::unexpected(lowered.error());
  if (!*lowered) return std::nullopt;
  if (auto done = port_.pause(port_.now_ns() + pulse_ns); !done) {
    return tl::unexpected(done.error());
  }
  if (auto raised = port_.set_dtr(true); !raised) return tl::unexpected(raised.error());
  has_pulsed_ = true;
  const std::int64_t until_ns = port_.now_ns() + after_pulse_ns;
  deadline_ns_ = std::max(deadline_ns_, until_ns);
  while (port_.now_ns() < until_ns) {
    for (const std::uint32_t baud : rates_) {
      auto done = visit(baud, listening_ns);
      if (!done || *done) return done;
    }
  }
  return std::nullopt;
}

template <class Enough>
result<void> lidar_search::listen(std::int64_t until_ns, Enough is_enough) {
  std::array<std::uint8_t, 1024> buffer{};
  while (!is_enough() && port_.now_ns() < until_ns) {
    if (options_.is_cancelled && options_.is_cancelled()) {
      return failure(task::asking, problem::cancelled, port_.name());
    }
    const auto got = port_.read(buffer, std::min(until_ns, port_.now_ns() + look_ns));
    if (!got) return tl::unexpected(got.error());
    take(bytes(buffer).first(got->count));
  }
  return {};
}

void lidar_search::take(bytes input) {
  heard_.bytes += input.size();
  all_heard_.received(input);
  heard_.stream.take(input);
  heard_.replies.feed(input, [this](const event& each) {
    const auto* const reply = std::get_if<response_view>(&each);
    if (reply == nullptr || heard_.device) return;
    heard_.device = reply->as_device_info();
  });
  for (const std::uint8_t byte : input) {
    constexpr unsigned start_size = 4;
    if (heard_.run == start_size && byte < 8) ++heard_.foreign;
    heard_.run = byte == foreign_start ? heard_.run + 1 : 0;
  }
}

// ---- the verdict ----------------------------------------------------------------------------------

lidar_signs lidar_search::signs() const noexcept {
  lidar_signs all;
  all.baud = port_.baud();
  all.is_baud_certain = !has_fixed_rate_ || (options_.baud != 0 && heard_.device);
  all.sample_bytes = heard_.stream.sample_bytes();
  all.sample_rate_hz = heard_.stream.rate_hz();
  if (heard_.device) all.id = heard_.device->model;
  if (const auto stated = heard_.stream.information()) all.ct_id_low_bits = stated->id_low_bits;
  return all;
}

recognised_lidar lidar_search::made(std::vector<const model*> candidates,
                                    const lidar_signs& of) const {
  recognised_lidar lidar;
  lidar.model = options_.model != nullptr ? options_.model : candidates.front();
  lidar.baud = port_.baud();
  lidar.was_scanning = of.sample_bytes != 0;
  if (heard_.device) {
    lidar.device = *heard_.device;
  } else if (const auto stated = heard_.stream.information()) {
    lidar.device = information_of(*stated, *lidar.model);
  }
  lidar.candidates = std::move(candidates);
  return lidar;
}

/// Packets arrive: at least three more of one size of samples than of the others.
lidar_search::found lidar_search::judge_stream() {
  if (only_listens()) return made({options_.model}, signs());
  const std::int64_t informed_ns = in_ns(information_ns);
  const auto is_one_way = [](const model* row) { return row->link == link_kind::one_way; };
  const bool is_doubtful = std::ranges::any_of(models_that_fit(signs()), is_one_way);
  // A one-way lidar is not to be disturbed: its CT bytes or its sample rate may be sufficient.
  if (is_doubtful) {
    const auto is_certain = [this] { return !may_be_two_way(signs()); };
    if (auto done = listen(informed_ns, is_certain); !done) return tl::unexpected(done.error());
  }
  lidar_signs known = signs();
  if (may_be_two_way(known)) {
    const auto fitting = models_that_fit(known);
    const auto like = std::ranges::find_if_not(fitting, is_one_way);
    const std::optional<device_information> announced = std::exchange(heard_.device, std::nullopt);
    auto device = stop_and_ask(**like, is_doubtful ? stop_attempts::one : stop_attempts::several);
    if (!device) return tl::unexpected(device.error());
    if (*device) {
      // NOLINTNEXTLINE(bugprone-unchecked-optional-access): checked before
      heard_.device = **device;
      known.answers = presence::yes;
      known.id = heard_.device->model;
      auto answering = models_that_fit(known);
      if (answering.empty()) return tl::unexpected(unknown(known.id));
      return made(std::move(answering), known);
    }
    heard_.device = announced;
  }
  // It does not answer. Its CT bytes may identify it.
  known.answers = presence::no;
  const auto does_not_stop = [this] {
    return failure(task::asking, problem::does_not_stop, port_.name());
  };
  if (models_that_fit(known).empty()) return does_not_stop();
  const auto is_informed = [this] { return heard_.stream.information().has_value(); };
  const std::int64_t until_ns = is_doubtful ? informed_ns : in_ns(information_ns);
  if (auto done = listen(until_ns, is_informed); !done) return tl::unexpected(done.error());
  known = signs();
  known.answers = presence::no;
  auto silent = models_that_fit(known);
  if (silent.empty()) return does_not_stop();
  return made(std::move(silent), known);
}

/// A device information has arrived after the question. A one-way lidar sends one after power-on, and
/// packets right after it.
lidar_search::found lidar_search::judge_reply() {
  lidar_signs known = signs();
  known.answers = presence::no;
  if (!models_that_fit(known).empty()) {
    const auto is_stream = [this] { return heard_.stream.sample_bytes() != 0; };
    if (auto done = listen(in_ns(announcement_ns), is_stream); !done) {
      return tl::unexpected(done.error());
    }
    if (is_stream()) return judge_stream();
  }
  known.answers = presence::yes;
  auto fitting = models_that_fit(known);
  if (fitting.empty()) {
    known.answers = presence::unknown;
    fitting = models_that_fit(known);
  }
  if (!fitting.empty()) return made(std::move(fitting), known);
  return tl::unexpected(unknown(known.id));
}

error lidar_search::unknown(std::uint8_t id) const {
  const std::string_view product = other_product(id);
  if (!product.empty()) return refused(port_, product);
  return {task::asking, problem::other_device,
          std::string(port_.name()) + ", model " + std::to_string(id)};
}

/// What the device answers after a stop; nothing if it does not.
result<std::optional<device_information>> lidar_search::stop_and_ask(const model& like,
                                                                     stop_attempts how) {
  // If it does not stop, the rest of the time shows what else it may be.
  const std::int64_t one_ns = in_ns(one_stop_ns);
  const std::int64_t several_ns = std::min(in_ns(stops_ns), deadline_ns_ - information_ns);
  auto answered = inquiry(port_, like.samples, how)
                      .ask(how == stop_attempts::one ? one_ns : std::max(one_ns, several_ns));
  if (answered) return *answered;
  const problem why = answered.error().code();
  if (why == problem::silence || why == problem::garbage || why == problem::does_not_stop) {
    return std::nullopt;
  }
  return tl::unexpected(answered.error());
}

tl::unexpected<error> lidar_search::not_found() const {
  std::string subject(port_.name());
  if (options_.model != nullptr) subject.append(", ").append(options_.model->name);
  subject.append(all_heard_.text());
  if (tried_.size() > 1 || options_.baud != 0) {
    std::string_view before = all_heard_.count() > 0 ? ", at " : " at ";
    for (const std::uint32_t baud : tried_) {
      subject.append(before).append(std::to_string(baud));
      before = ", ";
    }
    subject.append(" baud");
  }
  if (all_heard_.count() > 0) return failure(task::asking, problem::garbage, subject);
  const auto why = options_.model == nullptr ? error_detail::searched : error_detail::usual;
  return failure(task::asking, problem::silence, subject, 0, why);
}

result<recognised_lidar> search(transport& port, std::int64_t deadline_ns,
                                const search_options& options) {
  return lidar_search(port, options).run(deadline_ns);
}

}  // namespace g4lidar
