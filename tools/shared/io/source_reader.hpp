// SPDX-License-Identifier: MIT
// The background_reader of the word SOURCE, for programs that publish what comes: its errors as failures, and a
// running diagnosis.
#pragma once

#include <exception>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/common_options.hpp"
#include "g4lidar/background_reader.hpp"
#include "g4lidar/diagnostics/running_diagnosis.hpp"
#include "source.hpp"

namespace g4_tool {

/// *Any thread*, as the reader. on_loss: `exit` ends at the first failure or loss; `reconnect` ends if it cannot
/// be opened at first; `wait` never ends for the sake of a device.
class source_reader final : private reader_listener {
 public:
  /// `listener` must outlive this; what it throws is a failure(), after which it is not called again. `how`:
  /// as of opened_source.
  source_reader(const common_options& options, const lidar_options& how, reader_listener& listener,
                const reader_options& wanted = {});

  /// Starts the thread, once. Before it nothing is opened. Throws a failure.
  void start() { value_of(reader_.start()); }
  void stop() { reader_.stop(); }
  [[nodiscard]] background_reader& reader() noexcept { return reader_; }
  [[nodiscard]] const background_reader& reader() const noexcept { return reader_; }
  /// `ended` not before failure() states why.
  [[nodiscard]] reader_state state() const;

  /// The sentences of reader_status::why; empty at the end of a file, and after a signal.
  [[nodiscard]] std::string why() const;
  /// Why it has ended for good. Null before, at the end of a file with packets, and after a signal.
  [[nodiscard]] std::exception_ptr failure() const;
  /// What running_diagnosis finds; `skipped` before it was opened.
  [[nodiscard]] std::vector<stage_report> stages() const {
    return diagnosis_.stages(directions_of(options_));
  }
  /// See opened_source. Only in the thread.
  [[nodiscard]] const sim::simulated_source* simulation() const noexcept { return simulation_; }

 private:
  void on_open(g4lidar::lidar& device) override;
  void on_scan(const scan& found) override;
  void on_points(std::span<const point> found) override;
  void on_event(const lidar_event& what) override;
  void on_state(reader_state state, const std::optional<error>& why) override;
  template <class Call>
  void guard(Call call) noexcept;
  /// Nothing at the end of a file with packets, and after a signal.
  [[nodiscard]] std::optional<g4_tool::failure> failure_after(const error& why) const;

  common_options options_;
  reader_listener& listener_;
  running_diagnosis diagnosis_;
  const sim::simulated_source* simulation_ = nullptr;
  mutable std::mutex mutex_;  // protects the next three
  std::string why_;
  std::exception_ptr failure_;
  reader_state handled_ = reader_state::opening;  // the last one of which the listener knows
  background_reader reader_;                      // its thread ends first
};

}  // namespace g4_tool
