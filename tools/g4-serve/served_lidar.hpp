// SPDX-License-Identifier: MIT
// One lidar, recording or simulated lidar that is served: its settings, its recording and its state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "byte_tap.hpp"
#include "cli/named_sources.hpp"
#include "cli/serve_verb.hpp"
#include "client_registry.hpp"
#include "io/source_reader.hpp"
#include "lidar_rates.hpp"
#include "page_recorder.hpp"

namespace g4_tool {

class served_lidar;

/// What is done with what comes from lidars. In the threads of their readers.
class lidar_listener {
 public:
  lidar_listener() = default;
  lidar_listener(const lidar_listener&) = delete;
  lidar_listener& operator=(const lidar_listener&) = delete;
  virtual ~lidar_listener() = default;

  virtual void on_lidar_open(served_lidar& from, g4lidar::lidar& device) = 0;
  virtual void on_lidar_scan(served_lidar& from, const g4lidar::scan& scan) = 0;
  /// known() has changed. `sends`: pages that are connected have to get it.
  virtual void on_lidar_change(bool sends) = 0;
  /// A setting was changed by a client.
  virtual void on_lidar_settings() = 0;
};

class served_lidar final : public reader_listener {
 public:
  using answer_function = std::function<void(const std::string& error)>;

  /// `index`: of this lidar among `count`. `to` and `listener` outlive this.
  served_lidar(const serve_options& options, const named_source& which, std::size_t index,
               std::size_t count, client_registry& to, lidar_listener& listener);
  /// Call it before `from` is started. `from` outlives this.
  void attach(source_reader& from) { source_ = &from; }
  /// The options for opening the source. This outlives the reader.
  [[nodiscard]] lidar_options how_to_open();

  [[nodiscard]] std::size_t index() const noexcept { return index_; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const common_options& options() const noexcept { return options_; }
  [[nodiscard]] source_reader& source() const { return *source_; }
  [[nodiscard]] background_reader& reader() const { return source_->reader(); }
  /// Whether it is a lidar or a simulated one.
  [[nodiscard]] bool is_live() const;

  /// *Any thread*, as the next ones.
  [[nodiscard]] page_lidar known() const;
  /// Changes the setting of `word`, "frequency=7".
  void set(const std::string& word, answer_function done);
  void record(bool is_on, answer_function done);
  /// Ends the recording, soon, and removes its file.
  void discard_recording();
  /// The state now. Call it twice a second, in one thread.
  [[nodiscard]] page_status status();

  // In the thread of the reader.
  [[nodiscard]] page_recorder& recorder() noexcept { return recorder_; }
  /// The bytes since the last call as a message; empty if nobody wanted them.
  [[nodiscard]] std::vector<std::uint8_t> take_bytes(bool is_wanted);
  /// The time of the last of these bytes since 1970.
  [[nodiscard]] std::int64_t bytes_ns() const { return reader().wall_ns(bytes_.arrival_ns()); }

  void on_open(g4lidar::lidar& device) override;
  void on_scan(const g4lidar::scan& scan) override;
  void on_event(const lidar_event& event) override;
  void on_state(reader_state state, const std::optional<error>& why) override;

 private:
  void execute(g4lidar::lidar* lidar, const std::string& word, const answer_function& done);
  /// "front: " of one of several lidars.
  [[nodiscard]] std::string prefix() const { return name_.empty() ? "" : name_ + ": "; }

  const std::string name_;
  const std::size_t index_;
  common_options options_;
  const playback_options playback_;
  client_registry& registry_;
  lidar_listener& listener_;
  source_reader* source_ = nullptr;
  page_recorder recorder_;
  byte_tap bytes_;  // of the thread of the reader
  scan_rates rates_;
  loss_window loss_;          // of status()
  mutable std::mutex mutex_;  // protects the next two
  nlohmann::ordered_json settings_;
  const g4lidar::model* model_ = nullptr;
};

}  // namespace g4_tool
