// SPDX-License-Identifier: MIT
// The search for the lidar at an open port: at which rate it sends or answers, and which model it is.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fitting_models.hpp"
#include "g4lidar/discovery.hpp"
#include "survey/stream_survey.hpp"

namespace g4lidar {

enum class stop_attempts : std::uint8_t;

/// What a search receives and asks, as it does. Either may be empty.
struct search_observer {
  /// The bytes of one read, none if nothing arrived, and how long it took.
  std::function<void(bytes, std::int64_t took_ns)> received{};
  std::function<void(std::uint32_t baud)> asked{};
};

/// One search. *Single thread; allocates.*
///
/// Two-way lidars are silent until they are asked; one-way lidars send always, and answer nothing. So it
/// listens first, and asks only where it is silent: with `90`, two bytes that change nothing. Where next to nothing
/// arrives, nothing sends at any rate: so it does not listen at the others. Only a stream of packets that a two-way
/// lidar may send is stopped, and once where a one-way lidar may send it, too. A one-way lidar that was named gets no
/// byte.
class lidar_search {
 public:
  lidar_search(transport& port, const search_options& options, search_observer observer = {});

  [[nodiscard]] result<recognised_lidar> run(std::int64_t deadline_ns);
  /// At the last rate at which something was heard that is known and no lidar as it is; null: nothing was.
  [[nodiscard]] const stream_survey* other() const noexcept { return other_ ? &*other_ : nullptr; }

 private:
  /// Two revolutions at 4 Hz: the CT bytes of one of them are complete.
  static constexpr std::int64_t information_ns = 600'000'000;
  /// One attempt to stop a scan, and a slow answer.
  static constexpr std::int64_t one_stop_ns = 1'000'000'000;
  static constexpr std::int64_t look_ns =
      50'000'000;  // between two questions whether it is cancelled

  using found = result<std::optional<recognised_lidar>>;

  [[nodiscard]] result<recognised_lidar> find(std::int64_t deadline_ns);
  [[nodiscard]] found round(bool is_first);
  [[nodiscard]] found ask(std::span<const std::uint32_t> rates, std::int64_t wait_ns);
  [[nodiscard]] found visit(std::uint32_t baud, std::int64_t listen_ns);
  [[nodiscard]] found question(std::uint32_t baud, std::int64_t wait_ns);
  [[nodiscard]] found pulse();
  [[nodiscard]] result<bool> tune(std::uint32_t baud);
  /// Reads until then, or until `is_enough()`.
  template <class Enough>
  [[nodiscard]] result<void> listen(std::int64_t until_ns, Enough is_enough);
  void take(bytes input);
  void note_other();

  [[nodiscard]] found judge_stream();
  [[nodiscard]] found judge_silent(lidar_signs known, std::int64_t until_ns);
  [[nodiscard]] found judge_named();
  [[nodiscard]] found judge_number(lidar_signs known);
  [[nodiscard]] found judge_reply();
  [[nodiscard]] result<std::optional<device_information>> stop_and_ask(const model& like,
                                                                       stop_attempts attempts);
  [[nodiscard]] recognised_lidar made(std::vector<const model*> candidates,
                                      const lidar_signs& signs) const;
  [[nodiscard]] lidar_signs signs() const noexcept;
  [[nodiscard]] tl::unexpected<error> not_found() const;
  /// Whether nothing is sent: the user wants it so, or has named a lidar that answers nothing.
  [[nodiscard]] bool only_listens() const noexcept {
    return options_.listen_only ||
           (options_.model != nullptr && options_.model->link == link_kind::one_way);
  }
  /// Whether the bytes of this rate cannot be packets.
  [[nodiscard]] bool is_hopeless() const noexcept;
  [[nodiscard]] std::int64_t in_ns(std::int64_t time_ns) const noexcept;

  transport& port_;
  search_options options_;
  search_observer observer_;
  std::vector<std::uint32_t> rates_;   // in the order of listening
  std::vector<std::uint32_t> others_;  // that lidars have
  std::vector<std::uint32_t> tried_;
  std::int64_t deadline_ns_ = 0;
  bool has_fixed_rate_ = false;
  bool has_pulsed_ = false;
  std::size_t sending_ = 0;  // rates at which something sends
  stream_survey heard_;      // at this rate
  std::optional<device_information> device_;
  std::optional<stream_survey> other_;
};

template <class Enough>
result<void> lidar_search::listen(std::int64_t until_ns, Enough is_enough) {
  std::array<std::uint8_t, 1024> buffer{};
  while (!is_enough() && port_.now_ns() < until_ns) {
    if (options_.is_cancelled && options_.is_cancelled()) {
      return failure(task::asking, problem::cancelled, port_.name());
    }
    const std::int64_t begin_ns = port_.now_ns();
    const auto got = port_.read(buffer, std::min(until_ns, begin_ns + look_ns));
    if (!got) return tl::unexpected(got.error());
    const bytes data = bytes(buffer).first(got->count);
    take(data);
    if (observer_.received) observer_.received(data, port_.now_ns() - begin_ns);
  }
  return {};
}

}  // namespace g4lidar
