// SPDX-License-Identifier: MIT
#include "simulation_run.hpp"

#include <algorithm>
#include <string>

#include "application.hpp"

namespace g4lidar::simulation {
namespace {

/// Whether revolutions come as soon as they must, after the last fault and then all the time.
class recovery {
 public:
  recovery(const run_parameters& parameters, application& of)
      : calm_ns_(parameters.calm_ns),
        allowed_ns_(recovery_time_ns(parameters)),
        of_(&of),
        at_calm_(of.scans()),
        seen_(at_calm_),
        seen_ns_(of.now()) {}

  void look() {
    if (of_->scans() != seen_) {
      seen_ = of_->scans();
      seen_ns_ = of_->now();
    }
    if (took_ns_ < 0 && seen_ >= at_calm_ + 2) {
      took_ns_ = of_->now() - calm_ns_;
      of_->log(text_of("recovered after %.3f s", in_seconds(took_ns_)));
    }
    const bool is_over = took_ns_ >= 0;
    if (of_->now() - (is_over ? seen_ns_ : calm_ns_) > allowed_ns_) {
      of_->fail("no revolution within " + std::to_string(allowed_ns_ / ms) + " ms" +
                (is_over ? ", long after the last fault" : " after the last fault"));
    }
  }

  [[nodiscard]] std::int64_t allowed_ns() const { return allowed_ns_; }
  /// Negative where it has not.
  [[nodiscard]] std::int64_t took_ns() const { return took_ns_; }

 private:
  std::int64_t calm_ns_;
  std::int64_t allowed_ns_;
  application* of_;
  std::uint64_t at_calm_;
  std::uint64_t seen_;
  std::int64_t seen_ns_;
  std::int64_t took_ns_ = -1;
};

}  // namespace

run_report run_simulation(const run_parameters& parameters, bool verbose) {
  application app(parameters, verbose);
  while (app.has_passed() && app.now() < parameters.calm_ns) app.act();
  if (app.has_passed()) app.calm_down();
  recovery recovered(parameters, app);
  while (app.has_passed() && app.now() < parameters.end_ns) {
    app.read_calmly();
    if (app.has_passed()) recovered.look();
  }
  if (app.has_passed() && recovered.took_ns() < 0) app.fail("it has not recovered");
  if (app.has_passed()) app.finish();
  run_report report = app.report();
  report.allowed_ns = recovered.allowed_ns();
  report.recovery_ns = std::max<std::int64_t>(recovered.took_ns(), 0);
  return report;
}

}  // namespace g4lidar::simulation
