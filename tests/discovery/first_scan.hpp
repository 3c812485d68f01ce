// SPDX-License-Identifier: MIT
// How long a program waits for the first whole scan of a lidar whose model it names, or does not, in virtual time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "g4lidar/discovery.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/sim/device.hpp"
#include "g4lidar/sim/virtual_port.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar::test {

/// Gives the port of a search first, with what was found, as lidar::open() does at the path of a port.
class searched_connector final : public forwarding_connector {
 public:
  searched_connector(std::unique_ptr<connector> inner, std::unique_ptr<transport> port,
                     recognised_lidar found, bool is_named)
      : forwarding_connector(std::move(inner)),
        port_(std::move(port)),
        found_(std::move(found)),
        is_named_(is_named) {}

  result<std::unique_ptr<transport>> connect() noexcept override {
    return port_ != nullptr ? std::move(port_) : inner().connect();
  }
  [[nodiscard]] connector_traits traits() const noexcept override {
    connector_traits known;
    known.recognised.model = found_.model;
    known.recognised.by = is_named_ ? known_by::user : found_.by;
    known.recognised.candidates = found_.candidates;
    known.recognised.is_silent = found_.is_silent;
    known.is_searched = !is_named_;
    return known;
  }

 private:
  std::unique_ptr<transport> port_;
  recognised_lidar found_;
  bool is_named_;
};

/// One opening of a port behind which a lidar has had power for 5 s.
struct opening {
  sim::device_options options;
  std::vector<sim::fault> faults;
  const model* named = nullptr;  ///< Null: it is searched for.
  std::int64_t after_ns = 0;     ///< So much later, which decides where it is in its turn.
  bool was_closed =
      false;  ///< An earlier program has closed the port: a motor that DTR drives is at rest.
};

/// From the opening of the port to the first whole scan. Fails like lidar::open(), start() and try_scan().
inline result<std::int64_t> time_to_first_scan(const opening& what) {
  constexpr std::int64_t on_ns = 5'000'000'000;
  constexpr std::int64_t search_ns = 5'000'000'000;
  sim::device simulated(sim::built_in_world(), what.options, what.faults);
  sim::virtual_clock clock;
  if (what.was_closed) const sim::virtual_port earlier(simulated, clock);
  clock.advance_to(on_ns + what.after_ns);
  const std::int64_t begin_ns = clock.now_ns();
  const auto made = [&] {
    auto from = std::make_unique<sim::virtual_connector>(simulated, clock);
    from->set_baud(what.named != nullptr ? what.named->bauds[0] : g4_model.bauds[0]);
    return from;
  };
  const auto open_found = [&]() -> result<lidar> {
    auto from = made();
    auto port = from->connect();
    if (!port) return tl::unexpected(port.error());
    transport& to = **port;
    auto found = search(to, to.now_ns() + search_ns, {.model = what.named, .may_pulse_dtr = true});
    if (!found) return tl::unexpected(found.error());
    return lidar::open(
        std::make_unique<searched_connector>(std::move(from), std::move(*port), *std::move(found),
                                             what.named != nullptr),
        {.model = what.named});
  };
  const bool has_one_rate = what.named != nullptr && what.named->bauds[1] == 0;
  auto opened = has_one_rate ? lidar::open(made(), {.model = what.named}) : open_found();
  if (!opened && has_one_rate && opened.error() != problem::silence) opened = open_found();
  if (!opened) return tl::unexpected(opened.error());
  if (auto started = opened->start(); !started) return tl::unexpected(started.error());
  const auto got = opened->try_scan(std::chrono::seconds(10));
  if (!got) return tl::unexpected(got.error());
  return clock.now_ns() - begin_ns;
}

/// By how much the search delays the first scan of a lidar: one percentile of several openings.
struct search_delay {
  std::int64_t named_ns = 0;  ///< Medians.
  std::int64_t unnamed_ns = 0;
  std::int64_t added_ns = 0;  ///< The 90th percentile.
  bool good = true;           ///< Each opening had a scan.
};

/// Of `runs` openings, each at another time of the turn. `is_sending`: the lidar sends packets when the port is opened;
/// else it is idle, or its motor is at rest.
inline search_delay delay_of_search(const model& which, bool is_sending, int runs) {
  sim::device_options options;
  search_delay all{.good = sim::use_model(options, which.word)};
  if (is_sending) options.dtr_starts_by = sim::dtr_start::level;
  std::vector<sim::fault> faults;
  if (is_sending) faults.push_back(sim::make_fault(sim::fault_kind::scanning));
  std::vector<std::int64_t> named;
  std::vector<std::int64_t> unnamed;
  std::vector<std::int64_t> added;
  for (int i = 0; i < runs; ++i) {
    opening what{options, faults, &which, i * 13'700'000, !is_sending};  // 274 ms: two turns
    what.options.scanner.seed += static_cast<std::uint64_t>(i);
    const auto with_name = time_to_first_scan(what);
    what.named = nullptr;
    const auto without = time_to_first_scan(what);
    if (!with_name || !without) {
      all.good = false;
      continue;
    }
    named.push_back(*with_name);
    unnamed.push_back(*without);
    added.push_back(*without - *with_name);
  }
  if (added.empty()) return all;
  const auto percentile = [](std::vector<std::int64_t>& of, std::size_t percent) {
    std::ranges::sort(of);
    return of[(of.size() * percent + 99) / 100 - 1];
  };
  all.named_ns = percentile(named, 50);
  all.unnamed_ns = percentile(unnamed, 50);
  all.added_ns = percentile(added, 90);
  return all;
}

}  // namespace g4lidar::test
