// SPDX-License-Identifier: MIT
// From a file that is played to the outboxes of clients: a day of scans, and shaped ones.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "served.hpp"
#include "support/cdr_reader.hpp"
#include "support/cloud_rows.hpp"
#include "support/laser_scan.hpp"
#include "support/shaped_drive.hpp"
#include "support/test_scale.hpp"

namespace {

using namespace g4_tool;
using serve::Served;

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
  client_registry::client* who;
  unsigned every;
  std::uint64_t messages = 0;

  void read(client_registry& from, std::uint64_t scan) {
    if (every == 0 || scan % every != 0) return;
    while (from.take(*who)) ++messages;
  }
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
  EXPECT_EQ(events_, 0) << "a recording that begins again was not lost";
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

class Ranges : public Served {
 protected:
  Ranges() {
    EXPECT_TRUE(center_.receive(*viewer_,
                                R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":1}]})"));
  }
  bool read_all() override {
    while (const auto message = center_.take(*viewer_)) {
      if (!message->is_text) last_.assign(message->payload->begin(), message->payload->end());
    }
    return true;
  }

  client_registry::client* viewer_ = center_.connect(client_kind::foxglove, nullptr);
  std::vector<std::uint8_t> last_;
};

// The lidar drives to 0.15 m before a wall, which is too near within acos(0.15 / 0.28) of the way to it: 114 degrees.
TEST_F(Ranges, WhatMayBeTooNearIsMinusInfinity_WithTheOption) {
  cli::write_file(path("near.txt"),
                  "wall -4 -3 4 -3\nwall 4 -3 4 3\nwall 4 3 -4 3\nwall -4 3 -4 -3\n"
                  "lidar 3.2 0 0\ndrive wait 1\ndrive forward 0.65 0.3\n");
  EXPECT_EQ(
      cli::run({"sim", "--seconds", "5", "--world", path("near.txt"), "-o", path("near.bin")}).code,
      0);
  serve_options options;
  options.common.marks.near = near_limits{.revolutions = near_limits::until_return};
  options.common.grid.near_is_minus_infinity = true;
  play(path("near.bin"), false, options);
  const auto found = g4lidar::test::read_laser_scan(last_);
  EXPECT_EQ(found.ranges.size(), 720U);
  EXPECT_GE(std::ranges::count(found.ranges, -std::numeric_limits<float>::infinity()), 200);
  EXPECT_EQ(found.range_max, 16.0F);
}

/// What g4-serve sends of a drive, to programs and to pages.
class EqualShapes : public Served {
 protected:
  EqualShapes() {
    EXPECT_TRUE(center_.receive(
        *viewer_,
        R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":2},{"id":1,"channelId":1}]})"));
  }
  bool read_all() override {
    while (const auto message = center_.take(*viewer_)) {
      constexpr std::size_t id = 1;  // of the subscription, behind the kind of the message
      if (!message->is_text) {
        (message->prefix[id] == 0 ? clouds_ : grids_).push_back(text_of(message->payload));
      }
    }
    while (const auto message = center_.take(*page_)) {
      if (!message->is_text) shown_.push_back(text_of(message->payload));
    }
    return true;
  }
  static std::string text_of(const auto& payload) { return {payload->begin(), payload->end()}; }

  client_registry::client* viewer_ = center_.connect(client_kind::foxglove, nullptr);
  client_registry::client* page_ = center_.connect(client_kind::page, nullptr);
  std::vector<std::string> clouds_;
  std::vector<std::string> grids_;
  std::vector<std::string> shown_;
};

/// The bytes of numbers in the order of this machine, which is that of the messages.
std::string bytes_of(std::span<const float> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

TEST_F(EqualShapes, ToThoseOfTheLibrary_BitForBit) {
  const g4lidar::test::shaped_drive drive(G4_DUMP, path("."));
  serve_options options;
  options.common.filter.least_range_mm = 300.0F;
  options.common.marks = {
      .speckle = speckle_limits{}, .edges = edge_limits{}, .near = near_limits{}};
  options.common.deskew = deskewing::by_scans;
  play(drive.recording(), false, options);
  std::size_t at = 0;
  int deskewed = 0;
  const auto compare = [&](scan_shaper& shaper, const scan& of) {
    ASSERT_LT(at, clouds_.size());
    ASSERT_EQ(grids_.size(), clouds_.size());
    ASSERT_EQ(shown_.size(), clouds_.size());
    const std::string rows = g4lidar::test::rows_of(shaper.kept().points, of.time_ns());
    const std::string& cloud = clouds_[at];
    ASSERT_GT(cloud.size(), rows.size());
    const std::string got = cloud.substr(cloud.size() - 1 - rows.size(), rows.size());
    ASSERT_TRUE(g4lidar::test::without_times(got) == rows) << at;
    bool is_at_one_time = true;
    for (std::size_t t = 12; t < got.size(); t += g4lidar::test::cloud_row_size) {
      is_at_one_time = is_at_one_time && got.substr(t, 4) == std::string(4, '\0');
    }
    deskewed += is_at_one_time ? 1 : 0;
    std::array<float, 720> ranges_m{};
    fill_grid(shaper.for_grid(), ranges_m);
    EXPECT_NE(grids_[at].find(bytes_of(ranges_m)), std::string::npos) << at;
    std::vector<float> places;
    for (const point& p : shaper.kept()) {
      if (p.is_no_return()) continue;
      const xy_point place = to_xy(p, frame::robot);
      places.insert(places.end(), {place.x_m, place.y_m});
    }
    constexpr std::size_t head = 16;
    ASSERT_GT(shown_[at].size(), head);
    const std::string wanted = bytes_of(places);  // the place of the lidar follows
    EXPECT_TRUE(shown_[at].substr(head, wanted.size()) == wanted) << at;
    ++at;
  };
  g4lidar::test::shape_drive(drive, false, deskewing::by_scans, compare);
  EXPECT_EQ(at, clouds_.size());
  EXPECT_GT(deskewed, 25) << "nobody is to deskew them again";
}

class Setting : public Served {
 protected:
  bool read_all() override {
    if (scans_ == 1) {
      publisher_->set({.name = "frequency", .value = "10"}, [this](const std::string& error) {
        EXPECT_EQ(error, "");
        while (const auto message = center_.take(*page_)) {
          const std::string text(message->payload->begin(), message->payload->end());
          is_early_ = is_early_ || text.find(R"("op":"settings")") != std::string::npos;
        }
        is_done_ = true;
      });
    }
    return !is_done_;
  }

  client_registry::client* page_ = center_.connect(client_kind::page, nullptr);
  bool is_early_ = false;
  bool is_done_ = false;
};

// Otherwise a page that sets again when it gets the settings is refused: the first one is "not done yet".
TEST_F(Setting, IsDone_BeforePagesGetTheSettings) {
  play("sim:", false);
  EXPECT_TRUE(is_done_);
  EXPECT_FALSE(is_early_);
}

}  // namespace
