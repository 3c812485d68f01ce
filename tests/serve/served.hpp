// SPDX-License-Identifier: MIT
// The fixture for tests of g4-serve without its sockets.
#pragma once

#include <gtest/gtest.h>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "io/source_reader.hpp"
#include "program.hpp"
#include "scan_publisher.hpp"

namespace serve {

using namespace g4_tool;

/// g4-serve without its sockets. Clients read in the thread of the reader, so that each scan finds them as
/// the one before it left them.
class Served : public cli::scratch, public reader_listener {
 protected:
  /// Without waiting, until its end, or until read_all() returns false.
  void play(const std::string& source, bool loops, serve_options options = {}) {
    options.speed = 0;
    options.loops = loops;
    scan_publisher publisher(options, {{"", source, options.common.mount}}, center_);
    publisher_ = &publisher;
    lidar_ = publisher.lidars().front().get();
    source_reader from(lidar_->options(), lidar_->how_to_open(), *this);
    lidar_->attach(from);
    from.start();
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return is_over_; });
    lock.unlock();
    from.stop();
    EXPECT_EQ(from.failure(), nullptr);
  }
  /// After each scan.
  virtual bool read_all() = 0;

  void on_open(g4lidar::lidar& device) override { lidar_->on_open(device); }
  void on_event(const lidar_event& event) override {
    ++events_;
    lidar_->on_event(event);
  }
  void on_state(reader_state state, const std::optional<error>& why) override {
    lidar_->on_state(state, why);
    if (state == reader_state::ended) end();
  }
  void on_scan(const g4lidar::scan& scan) override {
    if (is_over_) return;
    lidar_->on_scan(scan);
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
  served_lidar* lidar_ = nullptr;

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_over_ = false;
};

}  // namespace serve
