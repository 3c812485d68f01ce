// SPDX-License-Identifier: MIT
#include "lidar_search.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/number_text.hpp"
#include "g4lidar/core/request.hpp"
#include "inquiry.hpp"

namespace g4lidar {
namespace {

/// A G4 that scans sends five packets in it.
constexpr std::int64_t first_listening_ns = 30'000'000;
/// The slowest stream, of an X2, has three packets in 50 ms.
constexpr std::int64_t listening_ns = 120'000'000;
constexpr std::int64_t answer_ns = 150'000'000;
/// In later rounds: of a device that boots, or behind a slow network.
constexpr std::int64_t late_answer_ns = 400'000'000;
constexpr std::int64_t pulse_ns = 100'000'000;
constexpr std::int64_t after_pulse_ns = 2'000'000'000;
constexpr std::int64_t write_ns = 100'000'000;
/// Fewer bytes in a time of listening are noise, or the end of a message.
constexpr std::size_t stream_bytes = 32;

/// Two of the longest packets: one of them is whole.
constexpr std::size_t hopeless_bytes = 340;

/// The order of asking: the rates of two-way lidars, those with the most users first, then those of variants. At the last
/// one of the usual ones no motor is driven by DTR: such a motor starts later.
constexpr std::array<std::uint32_t, 10> asking_rates{230'400, 128'000, 115'200, 153'600, 512'000,
                                                     150'000, 214'285, 256'000, 460'800, 921'600};

/// "230400, 128000", or where these are many "10 rates from 115200 to 921600".
std::string rates_text(const std::vector<std::uint32_t>& rates) {
  constexpr std::size_t few = 5;
  if (rates.size() <= few) return list_of(rates, [](auto baud) { return std::to_string(baud); });
  const auto [least, most] = std::ranges::minmax(rates);
  return std::to_string(rates.size()) + " rates from " + std::to_string(least) + " to " +
         std::to_string(most);
}

}  // namespace

lidar_search::lidar_search(transport& port, const search_options& options, search_observer observer)
    : port_(port), options_(options), observer_(std::move(observer)) {
  if (options.leave_dtr) options_.may_pulse_dtr = false;
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
  if (options.baud != 0) return;
  std::ranges::copy_if(asking_rates, std::back_inserter(others_), [this](std::uint32_t baud) {
    return std::ranges::find(rates_, baud) == rates_.end();
  });
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
    if (!done && done.error() == problem::does_not_stop) continue;
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
  // What sends at another rate makes bytes at this one, too; few are a late answer.
  const bool is_silent = heard_.count() < stream_bytes && !only_listens();
  for (std::size_t i = has_fixed_rate_ || is_silent ? rates_.size() : 1; i < rates_.size(); ++i) {
    done = visit(rates_[i], listening_ns);
    if (!done || *done) return done;
  }
  if (has_fixed_rate_) return done;
  if (sending_ == rates_.size()) {
    for (const std::uint32_t baud : others_) {
      done = visit(baud, listening_ns);
      if (!done || *done) return done;
    }
  }
  if (sending_ > 0 || only_listens()) return done;
  std::vector<std::uint32_t> order(rates_.begin() + 1, rates_.end());
  std::ranges::sort(order, {}, [](std::uint32_t baud) {
    return std::ranges::find(asking_rates, baud) - asking_rates.begin();
  });
  done = ask(order, is_first ? answer_ns : late_answer_ns);
  if (is_first || !done || *done) return done;
  return ask(others_, answer_ns);
}

/// Ends early when something begins to send.
lidar_search::found lidar_search::ask(std::span<const std::uint32_t> rates, std::int64_t wait_ns) {
  for (const std::uint32_t baud : rates) {
    auto done = question(baud, wait_ns);
    if (!done || *done || heard_.count() >= stream_bytes) return done;
  }
  return std::nullopt;
}

/// Whether the port has this rate now, as far as it has one.
result<bool> lidar_search::tune(std::uint32_t baud) {
  has_fixed_rate_ ? heard_.part() : heard_.tune();
  device_.reset();
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
  // A device that has booted may announce itself.
  const auto is_announced = [this] { return device_ && !only_listens(); };
  const auto is_decided = [&] {
    return heard_.layout().sample_bytes() != 0 || heard_.maker() != nullptr || is_announced();
  };
  const auto is_enough = [&] { return is_decided() || is_hopeless(); };
  if (auto done = listen(in_ns(listen_ns), is_enough); !done) return tl::unexpected(done.error());
  if (heard_.count() > 0 && !is_enough()) {
    if (auto done = listen(in_ns(listening_ns), is_enough); !done) {
      return tl::unexpected(done.error());
    }
  }
  if (heard_.layout().sample_bytes() != 0) return judge_stream();
  if (is_announced()) return judge_reply();
  if (!is_decided()) heard_.finish();
  note_other();
  if (const other_maker* const other = heard_.maker()) {
    const std::string subject = std::string(port_.name()).append(", ").append(with_driver(*other));
    return failure(task::asking, problem::other_device, subject, 0, error_detail::other_maker);
  }
  if (heard_.count() >= stream_bytes) ++sending_;
  return std::nullopt;
}

lidar_search::found lidar_search::question(std::uint32_t baud, std::int64_t wait_ns) {
  if (port_.now_ns() >= deadline_ns_) return std::nullopt;
  const auto tuned = tune(baud);
  if (!tuned) return tl::unexpected(tuned.error());
  if (!*tuned) return std::nullopt;
  const auto ask = encode(command::device_info);
  heard_.sent(ask);
  if (observer_.asked) observer_.asked(port_.baud());
  const auto sent = port_.write(ask, port_.now_ns() + write_ns);
  if (!sent && sent.error() != problem::timeout) return tl::unexpected(sent.error());
  const auto is_enough = [this] { return device_ || heard_.layout().sample_bytes() != 0; };
  if (auto done = listen(in_ns(wait_ns), is_enough); !done) return tl::unexpected(done.error());
  if (heard_.layout().sample_bytes() != 0) return judge_stream();
  if (device_) return judge_reply();
  note_other();
  return std::nullopt;
}

/// What is sent is no lidar, or was changed on its way.
void lidar_search::note_other() {
  if (!heard_.finding().empty()) other_ = heard_;
}

/// For a motor that DTR drives: it needs an edge. Until it turns there is time for the questions at other rates.
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
  if (!only_listens() && !has_fixed_rate_) {
    auto done = ask(others_, answer_ns);
    if (!done || *done) return done;
  }
  for (std::size_t i = 0; port_.now_ns() < until_ns; ++i) {
    auto done = visit(rates_[i % rates_.size()], listening_ns);
    if (!done || *done) return done;
  }
  return std::nullopt;
}

void lidar_search::take(bytes input) {
  heard_.received(input);
  if (!device_) device_ = heard_.device();
}

bool lidar_search::is_hopeless() const noexcept {
  return heard_.count() >= hopeless_bytes && !heard_.layout().has_packet() && !device_ &&
         !heard_.is_other_likely();
}

tl::unexpected<error> lidar_search::not_found() const {
  std::string subject(port_.name());
  if (options_.model != nullptr) subject.append(", ").append(options_.model->name);
  if (options_.listen_only) subject.append(", only listened to");
  if (other_) {
    subject.append(": ").append(other_->finding());
    subject.pop_back();  // its full stop
    return failure(task::asking, problem::garbage, subject, 0, error_detail::known_bytes);
  }
  const unrecognised_bytes& all = heard_.all();
  subject.append(all.text());
  if (tried_.size() > 1 || options_.baud != 0) {
    subject.append(all.count() > 0 ? ", at " : " at ").append(rates_text(tried_)).append(" baud");
  }
  if (all.count() > 0) return failure(task::asking, problem::garbage, subject);
  const auto why = options_.model == nullptr ? error_detail::searched : error_detail::usual;
  return failure(task::asking, problem::silence, subject, 0, why);
}

result<recognised_lidar> search(transport& port, std::int64_t deadline_ns,
                                const search_options& options) {
  return lidar_search(port, options).run(deadline_ns);
}

}  // namespace g4lidar
