// SPDX-License-Identifier: MIT
// Holds the points that a driver delivers against the samples that its device has truly sent.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "g4lidar/core/packet.hpp"
#include "g4lidar/point.hpp"
#include "g4lidar/sim/device.hpp"

namespace g4lidar::simulation {

/// What was found out about the points.
struct truth_counts {
  std::uint64_t points = 0;         ///< That are samples of the device.
  std::uint64_t blind_packets = 0;  ///< Damaged, and with a checksum that agrees all the same.
  std::uint64_t blind_points = 0;   ///< Delivered of those.
  std::uint64_t packets = 0;        ///< That the device has sent.
  std::uint64_t damaged = 0;        ///< Of them, on the way.
  std::uint64_t passed_over = 0;    ///< Undamaged ones of which no point was delivered.
};

/// A delivered point and the sample that it is.
struct known_point {
  point seen;
  std::int64_t
      index;  ///< Of the sample in the device; -1 where it may be another, and for a blind spot.
  std::int64_t time_ns;  ///< When it was truly measured.
};

/// Points come in the order in which they were delivered, whole packets at a time; samples as
/// sim::device::take_truth() gives them, before the points of them. *Single thread.*
class sample_matcher {
 public:
  /// Of samples that were sent in this format.
  explicit sample_matcher(const sim::wire_format& format = {}) : format_(format) {}

  void add(std::span<const sim::sent_sample> samples);
  void add(std::span<const point> points) {
    open_.insert(open_.end(), points.begin(), points.end());
  }

  /// Points were missed here: the next ones may begin in the middle of a packet.
  void cut() {
    open_.clear();
    is_cut_ = true;
  }

  /// Finds for each open point its sample, and gives them. A sentence in problem() where one has none.
  std::span<const known_point> settle(bool all);
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const truth_counts& counts() const { return counts_; }

 private:
  struct sample {
    std::int64_t index;
    std::int64_t time_ns;
    double angle_deg;
    std::uint16_t raw;
    std::uint16_t intensity;
    std::uint8_t flags;
  };
  struct packet {
    std::array<sample, max_samples> samples;
    std::uint64_t number;
    std::size_t count;  ///< That its header claims.
    std::size_t known;  ///< That have come of them.
    double first_deg;   ///< The first-level angle of the first one.
    bool zero;
    bool whole;  ///< As it was sent, and its angles show how the head turned.
  };

  [[nodiscard]] double corrected_deg(const sim::sample_truth& truth) const;
  [[nodiscard]] bool fits(const packet& sent, std::size_t at) const;
  /// Of a packet that was sent with the open points from one on.
  enum class likeness : std::uint8_t {
    none,
    some,
    open,  ///< More must be delivered to be sure.
    sure,
  };
  struct finding {
    std::optional<std::size_t> packet;
    bool is_sure;
    bool waits;  ///< More points may decide.
  };
  [[nodiscard]] likeness compare(std::size_t which, std::size_t at) const;
  [[nodiscard]] finding find(std::size_t at, bool all, std::size_t from = 0) const;
  bool settle_one(bool all);
  void drop_rest_of_packet();
  bool settle_blind(std::size_t blind, std::size_t packets);
  bool settle_unknown(bool all);
  void accept(std::size_t found, bool is_sure, std::size_t blind);

  std::deque<packet> sent_;
  std::deque<point> open_;
  std::vector<known_point> known_;
  truth_counts counts_;
  sim::wire_format format_;
  std::string problem_;
  bool is_cut_ = false;
};

}  // namespace g4lidar::simulation
