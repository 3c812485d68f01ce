// SPDX-License-Identifier: MIT
// From a file that is played to the outboxes of clients: a day of scans, and damaged ones.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "io/station.hpp"
#include "program.hpp"
#include "scan_publisher.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4_tool;

/// The nightly has a whole day; the rest of it is as the first hours.
const auto hours = static_cast<std::size_t>(std::min(24, g4lidar::test::scaled(3)));
constexpr std::uint64_t scans_of_an_hour = 12 * 3600;

/// What a program holds: in use, and resident.
struct memory {
  std::size_t used_bytes = ::mallinfo2().uordblks;
  std::size_t resident_bytes = resident();

  static std::size_t resident() {
    std::ifstream statm("/proc/self/statm");
    std::size_t all = 0;
    std::size_t pages = 0;
    statm >> all >> pages;
    return pages * 4096;
  }
};

/// A client that takes all that waits for it after each so many scans; 0: never.
struct reader {
  hub::client* who;
  unsigned every;
  std::uint64_t messages = 0;

  void read(hub& from, std::uint64_t scan) {
    if (every == 0 || scan % every != 0) return;
    while (from.take(*who)) ++messages;
  }
};

/// g4-serve without its sockets. Clients read in the thread of the station, so that each scan finds them as
/// the one before it left them.
class Served : public cli::scratch, public station_listener {
 protected:
  /// Without waiting, until its end, or until read_all() returns false.
  void play(const std::string& source, bool loops) {
    serve_options options;
    options.common.source = source;
    scan_publisher publisher(options, center_);
    publisher_ = &publisher;
    station from(options.common, publisher.how_to_open(), *this, {.loops = loops, .speed = 0});
    publisher.attach(from);
    from.start();
    std::unique_lock lock(mutex_);
    ended_.wait(lock, [this] { return is_over_; });
    lock.unlock();
    from.stop();
    EXPECT_EQ(from.failure(), nullptr);
  }
  /// After each scan.
  virtual bool read_all() = 0;

  void on_open(opened_source& source) override {
    ++openings_;
    publisher_->on_open(source);
  }
  void on_event(const lidar_event& event) override { publisher_->on_event(event); }
  void on_state(station_state state, std::string_view why) override {
    publisher_->on_state(state, why);
    if (state == station_state::ended) end();
  }
  void on_scan(const g4lidar::scan& scan) override {
    if (is_over_) return;
    publisher_->on_scan(scan);
    if (scans_++ % 6 == 0) publisher_->tick();
    if (!read_all()) end();
  }
  void end() {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
    ended_.notify_all();
  }

  std::uint64_t scans_ = 0;
  int openings_ = 0;
  hub center_{"session", false, {.set = {}, .play = {}}, [] {}};

 private:
  scan_publisher* publisher_ = nullptr;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool is_over_ = false;
};

class Day : public Served {
 protected:
  Day() {
    for (const unsigned every : {1U, 50U, 0U}) {
      pages_.push_back({center_.connect(client_kind::page, nullptr), every});
      viewers_.push_back({center_.connect(client_kind::foxglove, nullptr), every});
      EXPECT_TRUE(center_.receive(
          *viewers_.back().who,
          R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1},{"id":1,"channelId":2},)"
          R"({"id":2,"channelId":3},{"id":3,"channelId":4}]})"));
    }
  }
  bool read_all() override {
    if (scans_ % 1000 == 0) center_.disconnect(center_.connect(client_kind::page, nullptr));
    for (reader& each : pages_) each.read(center_, scans_);
    for (reader& each : viewers_) each.read(center_, scans_);
    if (scans_ % scans_of_an_hour == 0) held_.emplace_back();
    return scans_ < hours * scans_of_an_hour;
  }

  std::vector<reader> pages_;
  std::vector<reader> viewers_;
  std::vector<memory> held_;  // at the end of each hour
};

TEST_F(Day, FromTheSourceToTheClients_NeedsNoMoreMemory) {
  // Ten minutes at 12 Hz.
  ASSERT_EQ(cli::run({"sim", "--seconds", "600", "--frequency", "12", "--sample-rate", "4000",
                      "--dropout", "0.02", "-o", path("minutes.bin")})
                .code,
            0);
  ASSERT_EQ(cli::run({"convert", path("minutes.bin"), path("minutes.mcap")}).code, 0);
  play(path("minutes.mcap"), true);
  ASSERT_EQ(held_.size(), hours);
  EXPECT_GE(openings_, static_cast<int>(6 * hours));
  // Only the times of the scans of the last 3 s are as many as the machine is fast.
  constexpr std::size_t tolerance = 2 * 1024 * 1024;
  EXPECT_LE(held_.back().used_bytes, held_.front().used_bytes + tolerance);
  EXPECT_LE(held_.back().resident_bytes, held_.front().resident_bytes + tolerance);
  const std::uint64_t scans = hours * scans_of_an_hour;
  EXPECT_GE(pages_[0].messages, scans) << "each scan";
  EXPECT_GE(viewers_[0].messages, 3 * scans) << "scans, points and bytes";
  EXPECT_LE(pages_[1].messages, scans / 50 * 3 + 100) << "the newest of each";
  EXPECT_LE(viewers_[1].messages, scans / 50 * 5 + 100) << "and that bytes are left out";
  EXPECT_GE(viewers_[1].messages, scans / 50 * 3);
  EXPECT_EQ(pages_[2].messages + viewers_[2].messages, 0U);
}

class Damaged : public Served {
 protected:
  bool read_all() override {
    while (const auto message = center_.take(*page_)) {
      if (!message->is_text) are_whole_.push_back((message->payload->at(1) & 1U) != 0);
    }
    return true;
  }

  hub::client* page_ = center_.connect(client_kind::page, nullptr);
  std::vector<bool> are_whole_;
};

TEST_F(Damaged, RevolutionsAreMarked_AndPiecesLeftOut) {
  ASSERT_EQ(cli::run({"sim", "--seconds", "10", "-o", path("damaged.bin")}).code, 0);
  std::string data = cli::read_file(path("damaged.bin"));
  for (std::size_t at = 20'000; at < data.size(); at += 9'000) {
    data[at] = static_cast<char>(data[at] ^ 1);
  }
  cli::write_file(path("damaged.bin"), data);
  play(path("damaged.bin"), false);
  // "scan,time_ns,partial,..." of each revolution.
  std::istringstream rows(cli::run({"scan", path("damaged.bin"), "-f", "csv", "--grid", "4"}).out);
  std::vector<bool> wanted;
  for (std::string row; std::getline(rows, row);) {
    std::string partial = row.substr(row.find(',', row.find(',') + 1) + 1);
    partial = partial.substr(0, partial.find(','));
    if (partial == "true" || partial == "false") wanted.push_back(partial == "false");
  }
  EXPECT_EQ(are_whole_, wanted);
  EXPECT_GE(std::ranges::count(wanted, false), 10);
  EXPECT_GE(std::ranges::count(wanted, true), 10);
}

}  // namespace
