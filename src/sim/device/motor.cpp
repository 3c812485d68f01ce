// SPDX-License-Identifier: MIT
// The speed as a function of time, in integers: a ramp to the target, and a slow wave on it.
#include "sim/exact.hpp"

#include "motor.hpp"

#include <algorithm>

#include "g4lidar/detail/saturating.hpp"
#include "sim/purpose.hpp"

namespace g4lidar::sim {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

// -1000000 to 1000000 and back in a period.
std::int64_t wave_ppm(std::int64_t at_ns, std::int64_t period_ns) noexcept {
  const std::int64_t once =
      at_ns % period_ns * 4'000'000 / period_ns;  // a period is at most 1000 s
  return once < 2'000'000 ? once - 1'000'000 : 3'000'000 - once;
}

}  // namespace

motor::motor(const device_options& options) noexcept
    : acceleration_mhz_per_s_(std::max(options.acceleration_mhz_per_s, 1U)),
      standstill_ns_(options.standstill_ns),
      period_ns_(options.motor_drift_period_ns),
      offset_ns_(
          static_cast<std::int64_t>(stream_for(options.scanner.seed, purpose::motor).next() %
                                    static_cast<std::uint64_t>(options.motor_drift_period_ns))),
      held_ppm_(options.motor_drift_ppm),
      free_ppm_(options.free_motor_drift_ppm),
      drift_ppm_(options.motor_drift_ppm) {}

void motor::drive(std::uint32_t target_mhz, std::int64_t now_ns) noexcept {
  if (target_mhz == target_mhz_) return;
  from_mhz_ = undisturbed_mhz(now_ns);
  since_ns_ = now_ns;
  target_mhz_ = target_mhz;
}

void motor::jump(std::uint32_t target_mhz, std::int64_t now_ns) noexcept {
  from_mhz_ = target_mhz;
  since_ns_ = now_ns;
  target_mhz_ = target_mhz;
}

void motor::hold(constant_frequency constancy) noexcept {
  drift_ppm_ = constancy == constant_frequency::on ? held_ppm_ : free_ppm_;
}

std::int64_t motor::undisturbed_mhz(std::int64_t now_ns) const noexcept {
  const std::int64_t target = target_mhz_;
  const std::int64_t rest_ns = from_mhz_ == 0 && target != 0 ? standstill_ns_ : 0;
  // Then it has gained 100 Hz, which is more than any speed: this keeps the product small.
  const std::int64_t longest_ns = (100'000 / acceleration_mhz_per_s_ + 1) * second_ns;
  const std::int64_t moving_ns =
      std::clamp<std::int64_t>(now_ns - since_ns_ - rest_ns, 0, longest_ns);
  const std::int64_t gained = moving_ns / 1000 * acceleration_mhz_per_s_ / 1'000'000;
  return from_mhz_ < target ? std::min(from_mhz_ + gained, target)
                            : std::max(from_mhz_ - gained, target);
}

std::uint32_t motor::speed_mhz(std::int64_t now_ns) const noexcept {
  const std::int64_t speed = undisturbed_mhz(now_ns);
  const std::int64_t off_ppm =
      drift_ppm_ * wave_ppm(detail::saturating_add(now_ns, offset_ns_), period_ns_) / 1'000'000;
  return static_cast<std::uint32_t>(speed + speed * off_ppm / 1'000'000);
}

}  // namespace g4lidar::sim
