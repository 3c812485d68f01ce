// SPDX-License-Identifier: MIT
// The fixture for tests of g4-serve without its sockets.
#pragma once

#include <gtest/gtest.h>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "g4lidar/lidar_service.hpp"
#include "program.hpp"
#include "scan_publisher.hpp"

namespace serve {

using namespace g4_tool;

/// g4-serve without its sockets. Clients read in the thread of the reader, so that each scan finds them as
/// the one before it left them.
class Served : public cli::scratch, public g4lidar::service_sink {
 protected:
  /// Without waiting, until its end, or until read_all() returns false.
  void play(const std::string& source, bool loops, serve_options options = {}) {
    options.speed = 0;
    options.loops = loops;
    scan_publisher publisher(options, {{"", source, options.common.mount}}, center_, this);
    publisher_ = &publisher;
    publisher.start();
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return is_over_; });
    lock.unlock();
    publisher.stop();
    EXPECT_FALSE(publisher.failure_of_all());
  }
  /// After each scan.
  virtual bool read_all() = 0;

  [[nodiscard]] g4lidar::service_demand wanted() const override { return {}; }
  void on_event(std::size_t /*lidar*/, const lidar_event& /*what*/,
                std::int64_t /*stamp_ns*/) override {
    ++events_;
  }
  void on_state(std::size_t /*lidar*/, reader_state state,
                const std::optional<error>& /*why*/) override {
    if (state == reader_state::ended) end();
  }
  void on_scan(const g4lidar::service_scan& /*made*/) override {
    if (is_over_) return;
    if (scans_++ % 6 == 0) publisher_->tick();
    if (!read_all()) end();
  }
  void end() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    ended_.notify_all();
  }

  std::uint64_t scans_ = 0;
  int events_ = 0;
  client_registry center_{"session", false, {.set = {}, .play = {}}, [] {}};
  scan_publisher* publisher_ = nullptr;

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_over_ = false;
};

}  // namespace serve
