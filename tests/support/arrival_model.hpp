// SPDX-License-Identifier: MIT
// A model with known times for the sensor clock: when samples are measured, and when packets
// arrive.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "g4lidar/core/decode.hpp"

namespace g4lidar::arrivals {

/// How bytes get from the connection to the program: immediately (a pty), every millisecond, by a
/// timer of 16 ms, after 0 to 16 ms for each batch, or each packet late by 0 to 16 ms
/// independently.
enum class batching : std::uint8_t { direct, poll, ticks, gaps, each };

struct options {
  std::uint64_t seed = 1;
  double nominal_hz = 9000.0;
  double rate_error = 0.0;       ///< Of the true rate, relative to the nominal one.
  double drift_ppm = 200.0;      ///< Of the true rate: the amplitude of a sine.
  double drift_period_s = 60.0;  ///< Of that sine; 0: a steady drift, `drift_ppm` a minute.
  double motor_hz = 7.0;
  double motor_drift = 0.02;  ///< Amplitude of a sine, as a fraction of the speed.
  double motor_period_s = 20.0;
  int samples = 40;  ///< Of a packet; 0: 20 to 80, drawn for each.
  batching mode = batching::ticks;
  double jitter_ns = 50e3;    ///< Mean of the exponential delay of each read.
  double loss = 0.0;          ///< The probability that a run of packets is lost here.
  double loss_length = 1.0;   ///< Mean length of the run.
  double stalls_per_s = 0.0;  ///< How often the reading program is suspended, for up to a second.
  double outage_at_s = 0.0;   ///< When all packets of `outage_s` are lost.
  double outage_s = 0.0;
  double baud = 230400.0;  ///< 0: bytes take no time.
  sample_layout layout = g4_layout;
  double delay_ns = 0.0;   ///< Of all bytes, after the connection.
  std::int64_t start_ns = 1'000'000'000'000;
};

/// One delivered packet and its truth.
struct delivery {
  decoded packet;
  std::int64_t arrival_ns = 0;
  std::array<double, max_samples> measured_ns{};  ///< After options::start_ns.
  int lost_samples = 0;        ///< Measured after the previous delivery, and never delivered,
  std::size_t lost_bytes = 0;  ///< in packets of so many bytes.
  std::size_t seen_bytes = 0;  ///< Bytes of it that came with a read before the last one;
  std::int64_t seen_ns = 0;    ///< the time of that read.
};

/// A device, its connection and the program that reads it. Allocates nothing; the same on every
/// processor except for the last bits of libm.
class model {
 public:
  explicit model(const options& o) : o_(o), state_(o.seed * 0x9E3779B97F4A7C15U + 1) {
    angle_deg_ = 360.0 * uniform();
    phase_ns_ = 16e6 * uniform();
    drift_phase_ = 2.0 * std::numbers::pi * uniform();
    motor_phase_ = 2.0 * std::numbers::pi * uniform();
    flush_ns_ = phase_ns_;
    if (o_.stalls_per_s > 0.0) stall_ns_ = stall_end_ns_ = exponential(1e9 / o_.stalls_per_s);
  }

  /// The next packet that is not lost.
  delivery next() {
    int lost = 0;
    std::size_t lost_bytes = 0;
    for (;;) {
      delivery d = measure();
      send(d);
      if (!is_lost()) {
        d.lost_samples = lost;
        d.lost_bytes = lost_bytes;
        return d;
      }
      lost += d.packet.sample_count;
      lost_bytes += packet_size(d.packet.sample_count, o_.layout);
    }
  }
  /// The time in the device, after options::start_ns.
  [[nodiscard]] double now_s() const { return now_ns_ * 1e-9; }

  std::uint64_t bits() {  // splitmix64
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31);
  }
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double exponential(double mean) { return -mean * std::log(1.0 - uniform()); }

 private:
  static double sine(double phase, double t_s, double period_s) {
    return std::sin(phase + 2.0 * std::numbers::pi * t_s / period_s);
  }
  [[nodiscard]] double period_ns() const {
    const double drift =
        o_.drift_period_s > 0.0 ? sine(drift_phase_, now_s(), o_.drift_period_s) : now_s() / 60.0;
    return 1e9 / (o_.nominal_hz * (1.0 + o_.rate_error) * (1.0 + 1e-6 * o_.drift_ppm * drift));
  }
  [[nodiscard]] double degrees_in(double ns) const {
    const double drift = o_.motor_drift * sine(motor_phase_, now_s(), o_.motor_period_s);
    return 360e-9 * ns * o_.motor_hz * (1.0 + drift);
  }

  delivery measure() {
    delivery d;
    const double period = period_ns();
    const double turn = degrees_in(period);
    const int drawn = o_.samples > 0 ? o_.samples : 20 + static_cast<int>(bits() % 61);
    const int wanted = index_passed_ ? 1 : drawn;
    d.packet.starts_revolution = index_passed_;
    d.packet.first_angle_64ths = static_cast<std::uint16_t>(angle_deg_ * 64.0);
    index_passed_ = false;
    std::size_t n = 0;
    int last_64ths = 0;
    while (static_cast<int>(n) < wanted && !index_passed_) {
      d.measured_ns[n++] = now_ns_;
      last_64ths = static_cast<int>(angle_deg_ * 64.0);
      now_ns_ += period;
      angle_deg_ += turn;
      index_passed_ = angle_deg_ >= 360.0;
      if (index_passed_) angle_deg_ -= 360.0;
    }
    d.packet.sample_count = static_cast<std::uint16_t>(n);
    const int span = last_64ths - d.packet.first_angle_64ths;
    d.packet.span_64ths = static_cast<std::int16_t>(span < 0 ? span + turn_64ths : span);
    return d;
  }

  /// A packet is transmitted when it is complete and the connection is free.
  void send(delivery& d) {
    const std::size_t size = packet_size(d.packet.sample_count, o_.layout);
    const double byte_ns = o_.baud > 0.0 ? 10e9 / o_.baud : 0.0;
    const double begin = std::max(wire_free_ns_, d.measured_ns[d.packet.sample_count - 1U]);
    wire_free_ns_ = begin + static_cast<double>(size) * byte_ns;
    double before = 0.0;
    const double handed = handed_over(wire_free_ns_, before);
    if (byte_ns > 0.0 && before > begin) {
      d.seen_bytes = static_cast<std::size_t>((before - begin) / byte_ns);
      d.seen_ns = read(before);
    }
    d.arrival_ns = read(handed);
    if (d.seen_ns == d.arrival_ns) d.seen_bytes = 0;  // one read returned all of it
  }

  /// When bytes that arrived at `t` are delivered, and when the previous delivery was.
  double handed_over(double t, double& before) {
    switch (o_.mode) {
      case batching::direct:
        return t;
      case batching::poll:
        return ticked(t, 1e6, before);
      case batching::ticks:
        return ticked(t, 16e6, before);
      case batching::gaps:
        while (flush_ns_ < t) {
          last_flush_ns_ = flush_ns_;
          flush_ns_ += 16e6 * uniform();
        }
        before = last_flush_ns_;
        return flush_ns_;
      case batching::each:
        break;
    }
    flush_ns_ = std::max(flush_ns_, t + 16e6 * uniform());
    return flush_ns_;
  }
  [[nodiscard]] double ticked(double t, double tick_ns, double& before) const {
    const double next = phase_ns_ + std::ceil((t - phase_ns_) / tick_ns) * tick_ns;
    before = next - tick_ns;
    return next;
  }

  /// When the program reads what was delivered at `t`.
  std::int64_t read(double t) {
    if (o_.stalls_per_s > 0.0) {
      while (t > stall_end_ns_) {
        stall_ns_ = stall_end_ns_ + exponential(1e9 / o_.stalls_per_s);
        stall_end_ns_ = stall_ns_ + 1e9 * uniform();
      }
      if (t > stall_ns_) t = stall_end_ns_;
    }
    if (t > read_ns_) read_ns_ = t + exponential(o_.jitter_ns);
    return o_.start_ns + static_cast<std::int64_t>(read_ns_ + o_.delay_ns);
  }

  bool is_lost() {
    const double t = now_s();
    if (t > o_.outage_at_s && t < o_.outage_at_s + o_.outage_s) return true;
    if (to_lose_ > 0) return --to_lose_ >= 0;
    if (o_.loss <= 0.0 || uniform() >= o_.loss) return false;
    to_lose_ = o_.loss_length > 1.0 ? static_cast<int>(exponential(o_.loss_length - 0.5)) : 0;
    return true;
  }

  options o_;
  std::uint64_t state_;
  double now_ns_ = 0.0;
  double angle_deg_ = 0.0;
  double phase_ns_ = 0.0;
  double drift_phase_ = 0.0;
  double motor_phase_ = 0.0;
  double wire_free_ns_ = 0.0;
  double flush_ns_ = 0.0;
  double last_flush_ns_ = 0.0;
  double read_ns_ = 0.0;
  double stall_ns_ = 0.0;
  double stall_end_ns_ = 0.0;
  bool index_passed_ = false;
  int to_lose_ = 0;
};

}  // namespace g4lidar::arrivals
