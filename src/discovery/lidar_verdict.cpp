// SPDX-License-Identifier: MIT
// The search for the lidar: which one it is, when something was heard.
#include <algorithm>
#include <string>
#include <utility>

#include "g4lidar/core/model_choice.hpp"
#include "inquiry.hpp"
#include "lidar_search.hpp"

namespace g4lidar {
namespace {

/// A lidar that announces itself sends packets right after it.
constexpr std::int64_t announcement_ns = 40'000'000;
constexpr std::int64_t stops_ns = 2'000'000'000;
constexpr std::int64_t certain_ns = 100'000'000;

error refused(const transport& port, std::string_view product) {
  return {task::asking, problem::other_device,
          std::string(port.name()).append(", a ").append(product), 0,
          error_detail::unsupported_product};
}

}  // namespace

lidar_signs lidar_search::signs() const noexcept {
  lidar_signs all;
  all.baud = port_.baud();
  all.is_baud_certain = !has_fixed_rate_ || (options_.baud != 0 && device_);
  all.sample_bytes = heard_.layout().sample_bytes();
  all.sample_rate_hz = heard_.layout().rate_hz();
  all.frequency_chz = heard_.layout().frequency_chz();
  if (device_) all.id = device_->model;
  if (const auto stated = heard_.layout().information()) all.ct_id_low_bits = stated->id_low_bits;
  return all;
}

recognised_lidar lidar_search::made(std::vector<const model*> candidates,
                                    const lidar_signs& signs) const {
  recognised_lidar lidar;
  lidar.model = options_.model != nullptr ? options_.model : candidates.front();
  lidar.baud = has_fixed_rate_ ? options_.baud : port_.baud();  // that of a bridge is not known
  lidar.was_scanning = signs.sample_bytes != 0;
  const bool is_numbered = signs.id != 0 || signs.ct_id_low_bits != 0;
  lidar.by = options_.model != nullptr ? known_by::user
             : is_numbered             ? known_by::number
             : signs.sample_bytes != 0 ? known_by::samples
                                       : known_by::nothing;
  lidar.is_silent = !options_.listen_only && signs.answers == presence::no &&
                    lidar.model->link == link_kind::two_way;
  lidar.speaks_telnet = heard_.change() == stream_change::telnet;
  if (device_) {
    lidar.device = *device_;
  } else if (const auto stated = heard_.layout().information()) {
    lidar.device = information_of(*stated, *lidar.model);
  }
  lidar.candidates = std::move(candidates);
  return lidar;
}

/// Packets arrive: at least three more of one size of samples than of the others.
lidar_search::found lidar_search::judge_stream() {
  if (only_listens()) return judge_named();
  // Few more packets may have to contradict what the device answers.
  const auto is_counted = [this] {
    return heard_.layout().votes(heard_.layout().sample_bytes()) >= certain_packets;
  };
  if (auto done = listen(in_ns(certain_ns), is_counted); !done) return tl::unexpected(done.error());
  const std::int64_t informed_ns = in_ns(information_ns);
  const auto is_one_way = [](const model* row) { return row->link == link_kind::one_way; };
  const bool is_doubtful = std::ranges::any_of(models_that_fit(signs()), is_one_way);
  // A one-way lidar is not to be disturbed: its CT bytes or its sample rate may be sufficient.
  if (is_doubtful) {
    const auto is_certain = [this] {
      return heard_.layout().has_stated_all() || !may_be_two_way(signs());
    };
    if (auto done = listen(informed_ns, is_certain); !done) return tl::unexpected(done.error());
  }
  lidar_signs known = signs();
  if (may_be_two_way(known)) {
    const auto fitting = models_that_fit(known);
    const auto like = std::ranges::find_if_not(fitting, is_one_way);
    const std::optional<device_information> announced = std::exchange(device_, std::nullopt);
    auto device = stop_and_ask(**like, is_doubtful ? stop_attempts::one : stop_attempts::several);
    if (!device) return tl::unexpected(device.error());
    if (*device) {
      // NOLINTNEXTLINE(bugprone-unchecked-optional-access): checked before
      device_ = **device;
      known.answers = presence::yes;
      known.id = device_->model;
      return judge_number(known);
    }
    device_ = announced;
  }
  return judge_silent(known, is_doubtful ? informed_ns : in_ns(information_ns));
}

/// Nothing is sent. Packets of a named model must have its samples; whether an unnamed one answers is not known.
lidar_search::found lidar_search::judge_named() {
  if (options_.model == nullptr) {
    const auto is_informed = [this] { return heard_.layout().has_stated_all(); };
    if (auto done = listen(in_ns(information_ns), is_informed); !done) {
      return tl::unexpected(done.error());
    }
    const lidar_signs seen = signs();
    auto all = models_that_fit(seen);
    if (all.empty()) all = models_of_size(seen);
    return made(std::move(all), seen);
  }
  lidar_signs known = signs();
  known.answers = presence::no;
  const std::size_t own = sample_size(options_.model->samples.layout);
  if (known.sample_bytes == own) return made({options_.model}, known);
  return failure(task::asking, problem::other_device,
                 std::string(port_.name())
                     .append(", packets with samples of ")
                     .append(std::to_string(known.sample_bytes))
                     .append(" bytes at ")
                     .append(std::to_string(port_.baud()))
                     .append(" baud, not of ")
                     .append(std::to_string(own)),
                 0, error_detail::other_samples);
}

/// It does not answer. Its CT bytes may identify it. Else it is read as a two-way lidar with this rate whose answers do
/// not arrive, or as a one-way lidar at a rate that is not usual for it.
lidar_search::found lidar_search::judge_silent(lidar_signs known, std::int64_t until_ns) {
  known.answers = presence::no;
  if (!models_that_fit(known).empty()) {
    const auto is_informed = [this] { return heard_.layout().has_stated_all(); };
    if (auto done = listen(until_ns, is_informed); !done) return tl::unexpected(done.error());
    known = signs();
    known.answers = presence::no;
    auto silent = models_that_fit(known);
    if (!silent.empty()) return made(std::move(silent), known);
  } else {
    heard_.part();  // bytes are missing since the stop
    const auto has_rate = [this] { return heard_.layout().rate_hz() != 0; };
    if (auto done = listen(until_ns, has_rate); !done) return tl::unexpected(done.error());
    known.sample_rate_hz = heard_.layout().rate_hz();
    known.frequency_chz = heard_.layout().frequency_chz();
  }
  lidar_signs any = known;
  any.answers = presence::yes;  // if it were heard
  any.id = any.ct_id_low_bits = 0;
  auto all = models_that_fit(any);
  const lidar_signs one_way{.sample_bytes = known.sample_bytes,
                            .sample_rate_hz = known.sample_rate_hz,
                            .frequency_chz = known.frequency_chz,
                            .answers = presence::no};
  const bool is_far = !all.empty() && !may_measure(*all.front(), known);
  auto others = models_that_fit(one_way);
  if (is_far && !others.empty() && may_measure(*others.front(), known)) all.clear();
  // A device that boots, or is busy, may stop later.
  const bool has_time = port_.now_ns() + one_stop_ns + information_ns < deadline_ns_;
  if (!all.empty() && has_time) return failure(task::asking, problem::does_not_stop, port_.name());
  if (all.empty()) all = models_of_size(known);
  return made(std::move(all), known);
}

/// A device that has answered with its number.
lidar_search::found lidar_search::judge_number(lidar_signs known) {
  const std::string_view product = other_product(known.id);
  if (!product.empty() && options_.model == nullptr && known.sample_bytes == 0)
    return tl::unexpected(refused(port_, product));
  const bool is_certain = heard_.layout().votes(known.sample_bytes) >= certain_packets;
  auto fitting = models_of_answer(known, is_certain);
  if (!fitting.front()->has_number(known.id)) known.id = 0;
  return made(std::move(fitting), known);
}

/// A device information has arrived after the question. A one-way lidar sends one after power-on, and
/// packets right after it.
lidar_search::found lidar_search::judge_reply() {
  lidar_signs known = signs();
  known.answers = presence::no;
  const auto has_this_rate = [&](const model* row) { return has_rate(*row, port_.baud()); };
  const bool may_announce = std::ranges::any_of(models_that_fit(known), has_this_rate);
  if (may_announce) {
    const auto is_stream = [this] { return heard_.layout().sample_bytes() != 0; };
    if (auto done = listen(in_ns(announcement_ns), is_stream); !done) {
      return tl::unexpected(done.error());
    }
    if (is_stream()) return judge_stream();
  }
  known.answers = presence::yes;
  if (may_announce && models_that_fit(known).empty()) known.answers = presence::unknown;
  return judge_number(known);
}

/// What the device answers after a stop; nothing if it does not.
result<std::optional<device_information>> lidar_search::stop_and_ask(const model& like,
                                                                     stop_attempts attempts) {
  // If it does not stop, the rest of the time shows what else it may be.
  const std::int64_t one_ns = in_ns(one_stop_ns);
  const std::int64_t several_ns = std::min(in_ns(stops_ns), deadline_ns_ - information_ns);
  auto answered = inquiry(port_, like.samples, attempts)
                      .ask(attempts == stop_attempts::one ? one_ns : std::max(one_ns, several_ns));
  if (answered) return *answered;
  const problem why = answered.error().code();
  if (why == problem::silence || why == problem::garbage || why == problem::does_not_stop) {
    return std::nullopt;
  }
  return tl::unexpected(answered.error());
}

}  // namespace g4lidar
