// SPDX-License-Identifier: MIT
// The search for the lidar at an open port: at which rate it sends or answers, and which model it is.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "driver/unrecognised_bytes.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/discovery.hpp"
#include "model_choice.hpp"

namespace g4lidar {

enum class stop_attempts : std::uint8_t;

/// One search. *Single thread; allocates.*
///
/// Two-way lidars are silent until they are asked; one-way lidars send always, and answer nothing. So it
/// listens first, and asks only where it is silent: with `90`, two bytes that change nothing. Only a
/// stream of packets that a two-way lidar may send is stopped, and once where a one-way lidar may send it, too.
/// A one-way lidar that was named gets no byte.
class lidar_search {
 public:
  lidar_search(transport& port, const search_options& options);

  [[nodiscard]] result<recognised_lidar> run(std::int64_t deadline_ns);

 private:
  using found = result<std::optional<recognised_lidar>>;

  /// What arrived at one rate.
  struct hearing {
    layout_recogniser stream;
    stream_parser replies =
        stream_parser(g4_format);  // a response is found whatever the size of samples is
    std::optional<device_information> device;
    std::size_t bytes = 0;
    unsigned foreign = 0;  // starts of packets of another protocol
    unsigned run = 0;      // equal start bytes in a row
  };

  [[nodiscard]] result<recognised_lidar> find(std::int64_t deadline_ns);
  [[nodiscard]] found round(bool is_first);
  [[nodiscard]] found visit(std::uint32_t baud, std::int64_t listen_ns);
  [[nodiscard]] found question(std::uint32_t baud, std::int64_t wait_ns);
  [[nodiscard]] found pulse();
  [[nodiscard]] result<bool> tune(std::uint32_t baud);
  /// Reads until then, or until `is_enough()`.
  template <class Enough>
  [[nodiscard]] result<void> listen(std::int64_t until_ns, Enough is_enough);
  void take(bytes input);

  [[nodiscard]] found judge_stream();
  [[nodiscard]] found judge_reply();
  [[nodiscard]] result<std::optional<device_information>> stop_and_ask(const model& like,
                                                                       stop_attempts how);
  [[nodiscard]] recognised_lidar made(std::vector<const model*> candidates,
                                      const lidar_signs& signs) const;
  [[nodiscard]] lidar_signs signs() const noexcept;
  [[nodiscard]] tl::unexpected<error> not_found() const;
  [[nodiscard]] error unknown(std::uint8_t id) const;
  /// Whether the user has named a lidar that answers nothing.
  [[nodiscard]] bool only_listens() const noexcept {
    return options_.model != nullptr && options_.model->link == link_kind::one_way;
  }
  [[nodiscard]] std::int64_t in_ns(std::int64_t time_ns) const noexcept;

  transport& port_;
  search_options options_;
  std::vector<std::uint32_t> rates_;  // in the order of listening
  std::vector<std::uint32_t> tried_;
  std::int64_t deadline_ns_ = 0;
  bool has_fixed_rate_ = false;
  bool has_pulsed_ = false;
  std::size_t sending_ = 0;  // rates at which something sends
  hearing heard_;
  unrecognised_bytes all_heard_;
};

}  // namespace g4lidar
