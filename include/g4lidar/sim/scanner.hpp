// SPDX-License-Identifier: MIT
// The measuring half of a simulated G4: a turning head, its samples, and the packets it sends.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "g4lidar/bytes.hpp"
#include "g4lidar/command.hpp"
#include "g4lidar/export.hpp"
#include "g4lidar/packet.hpp"
#include "g4lidar/sim/random.hpp"
#include "g4lidar/sim/ray_caster.hpp"
#include "g4lidar/sim/world.hpp"

namespace g4lidar::sim {

/// Which way the head turns, and what becomes of its angles.
enum class turning : std::uint8_t {
  clockwise,  ///< As a G4 comes.
  mirrored,   ///< Counter-clockwise, and the angles grow along with it: a mirrored room.
  falling,    ///< Counter-clockwise, and the angles fall: receivers take such packets for suspect.
};

/// How the device is set and how good it is. By default a G4 as it comes, without flaws.
struct scanner_options {
  std::uint64_t seed = 1;                  ///< Of everything that is drawn at random below.
  std::uint16_t scan_frequency_chz = 700;  ///< Revolutions in 100 s, constant; 500 to 1200.
  ranging_frequency ranging = ranging_frequency::khz_9;
  std::size_t samples_per_packet = 40;  ///< 1 to 80.
  double index_deg = 0.0;  ///< The angle of the index mark, [0, 360); 348 on some devices.
  /// The angle at the first sample, [0, 360); drawn at random where not given.
  std::optional<double> start_deg = std::nullopt;
  bool reports_frequency = true;   ///< Whether a zero packet's CT tells the scan frequency.
  double min_range_mm = 280.0;     ///< What is nearer gives no return.
  double max_range_mm = 16'000.0;  ///< What is farther gives no return; at most 16383.75.
  double noise_mm = 0.0;           ///< Standard deviation of a range, and what each millimetre of
  double noise_ratio = 0.0;        ///< range adds to it. Both >= 0.
  double dropout_ratio = 0.0;  ///< How many of all samples give no return for no reason, 0 to 1.
  /// The true sample rate by the nominal one, 0.9 to 1.1, and how far it wanders from that to either
  /// side within a minute, 0 to 10000 millionths.
  double sample_rate_ratio = 1.0;
  double sample_rate_drift_ppm = 0.0;
  std::uint8_t ordinary_ct = 0;  ///< CT of packets that are no zero packets; its bit 0 is ignored.
};

/// What is wrong with `options`, a sentence to be shown to a person; empty if nothing is. *Pure.*
[[nodiscard]] G4LIDAR_API std::string_view problem_with(const scanner_options& options) noexcept;

/// What a sample truly was, before it was squeezed into the wire's format.
struct sample_truth {
  std::uint64_t index;   ///< Of the sample, from 0.
  std::int64_t time_ns;  ///< When it was measured; sample 0 at 0.
  /// From 0; one more with each zero packet that is not the first packet.
  std::uint64_t revolution;
  double first_level_deg;  ///< The head's angle, clockwise, [0, 360).
  double bearing_deg;      ///< Where the target stands, clockwise, [0, 360). Where there is none,
                           ///< where a far one would stand.
  double range_mm;         ///< Of the target, however far and without noise; 0: there is none.
  std::uint16_t raw;       ///< As sent: quarters of a millimetre, 0 for no return.
};

/// A packet as it leaves the device, and what its samples truly were.
struct sent_packet {
  bytes data;                             ///< Good until the scanner's next call.
  std::span<const sample_truth> samples;  ///< The same number, in order; good as long as `data`.
  std::int64_t complete_ns;               ///< When the last sample was measured: not sent before.
};

/// What a device sends first when scanning starts: the reply to the start command, 7 bytes, good
/// for ever. (protocol: Commands, 60)
[[nodiscard]] G4LIDAR_API bytes scan_start_reply() noexcept;

/// A turning head that measures in virtual time: each next() is one packet further. Same options
/// and same world, same bytes, on every processor. *Single thread. Allocates on construction only.*
/// A copy lives on independently.
class G4LIDAR_API scanner {
 public:
  /// `problem_with(options)` is empty; a mistake there is an assertion.
  scanner(const world& scene, const scanner_options& options);

  /// The next packet. It never ends. A zero packet when the index has passed, with the first sample
  /// after it; then packets of `samples_per_packet`, the last one of a revolution shorter.
  [[nodiscard]] sent_packet next() noexcept;

  /// From the next packet on the head turns this many times in 1000 s, at most 20'000; at 0 it
  /// stands, and all samples have one angle.
  void set_speed_mhz(std::uint32_t speed_mhz) noexcept;
  /// From the next packet on it measures as often as that.
  void set_ranging(ranging_frequency ranging) noexcept;
  /// From the next packet on the head turns that way.
  void set_turning(turning way) noexcept { turning_ = way; }
  /// The next sample is measured at `at_ns`, not before the last one, with the head `phase` / 2^64
  /// turns behind the index.
  void resume(std::int64_t at_ns, std::uint64_t phase) noexcept;
  /// When the next sample will be measured, unless resume() says otherwise.
  [[nodiscard]] std::int64_t next_sample_ns() const noexcept;

  /// As given, but for `ranging`, which set_ranging() changes; good as long as the scanner.
  [[nodiscard]] const scanner_options& options() const noexcept { return options_; }

 private:
  [[nodiscard]] sample_truth measure() noexcept;
  [[nodiscard]] std::uint16_t raw_sample(double range_mm) noexcept;
  void turn_on() noexcept;
  [[nodiscard]] bytes frame_of(std::size_t samples, bool zero) noexcept;
  void keep_rate() noexcept;
  void set_step() noexcept;

  scanner_options options_;
  ray_caster caster_;
  ray_caster mirrored_caster_;
  random_stream noise_;
  random_stream dropouts_;
  turning turning_ = turning::clockwise;
  std::uint32_t speed_mhz_;
  std::uint64_t rate_mhz_;        // the true one, in 0.001 Hz
  std::int64_t since_ns_ = 0;     // the rate has been that since then,
  std::uint64_t index_then_ = 0;  // when this sample was measured
  std::uint64_t phase_;           // since the index, in 2^-64 of a turn
  std::uint64_t step_;            // of a sample
  std::uint64_t index_ = 0;
  std::uint64_t revolution_ = 0;
  bool at_index_;  // the index has passed since the last sample
  std::array<sample_truth, max_samples> truths_{};
  std::array<std::uint8_t, max_packet_size> frame_{};
};

}  // namespace g4lidar::sim
