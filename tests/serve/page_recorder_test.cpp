// SPDX-License-Identifier: MIT
// Recordings that pages begin: which files there are, and what ends them.
#include "page_recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "cli/exit_code.hpp"
#include "server.hpp"

namespace {

using namespace g4_tool;
using nlohmann::json;
using serve::Server;
using ::testing::HasSubstr;

constexpr std::uint64_t megabyte = std::uint64_t{1} << 20U;

/// Each read gives 4000 bytes, a millisecond later.
class endless final : public g4lidar::transport {
 public:
  g4lidar::result<g4lidar::received> read(std::span<std::uint8_t> out,
                                          std::int64_t /*deadline_ns*/) noexcept override {
    std::ranges::fill(out.first(4000), std::uint8_t{7});
    return g4lidar::received{4000, now_ns_ += 1'000'000};
  }
  g4lidar::result<void> write(g4lidar::bytes /*data*/,
                              std::int64_t /*deadline_ns*/) noexcept override {
    return {};
  }
  g4lidar::result<void> pause(std::int64_t /*deadline_ns*/) noexcept override { return {}; }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_; }
  void wake() noexcept override {}
  [[nodiscard]] std::string_view name() const noexcept override { return "endless"; }

 private:
  std::int64_t now_ns_ = 1'000'000'000;
};

class endless_connector final : public g4lidar::connector {
 public:
  g4lidar::result<std::unique_ptr<g4lidar::transport>> connect() noexcept override {
    return std::make_unique<endless>();
  }
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return 0; }
  bool pause(std::int64_t /*deadline_ns*/) noexcept override { return true; }
  void wake() noexcept override {}
};

class PageRecorder : public cli::scratch {
 protected:
  PageRecorder() { std::filesystem::create_directory(recordings_); }

  /// One that is connected, and has had a scan.
  page_recorder& make(std::uint64_t most_bytes = 100 * megabyte,
                      const page_recorder::recorded_lidar& which = {}) {
    recorder_.emplace(recordings_, most_bytes, which);
    from_ = recorder_->observe(std::make_unique<endless_connector>());
    port_ = std::move(*from_->connect());
    recorder_->add(g4lidar::scan{});
    return *recorder_;
  }
  void read(page_recorder& into, int count) {
    for (int i = 0; i < count; ++i) {
      read_bytes(1);
      into.add(g4lidar::scan{});
    }
  }
  /// As at a wrong baud rate: no scan comes.
  void read_bytes(int count) {
    std::array<std::uint8_t, 4000> buffer{};
    for (int i = 0; i < count; ++i) ASSERT_TRUE(port_->read(buffer, 0));
  }
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> all;
    for (const auto& each : std::filesystem::directory_iterator(recordings_)) {
      all.insert(each.path().filename().string());
    }
    return all;
  }

  const std::string recordings_ = path("recordings");
  std::optional<page_recorder> recorder_;  // outlives the next two, which report to it
  std::unique_ptr<g4lidar::connector> from_;
  std::unique_ptr<g4lidar::transport> port_;
};

TEST_F(PageRecorder, NamesItsFiles_AndReplacesNone) {
  page_recorder& recorder = make();
  std::set<std::string> named;
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(recorder.set(true), "");
    EXPECT_TRUE(named.insert(recorder.status()->file).second);
    EXPECT_THAT(recorder.set(true), HasSubstr("already"));
    ASSERT_EQ(recorder.set(false), "");
    EXPECT_TRUE(recorder.status()->file.empty());
  }
  EXPECT_EQ(recorder.set(false), "");
  EXPECT_EQ(files(), named);
  const std::regex wanted(R"(g4-\d{8}T\d{6}Z(-\d)?\.mcap)");
  for (const std::string& name : named) EXPECT_TRUE(std::regex_match(name, wanted)) << name;
}

TEST_F(PageRecorder, EndsAtItsLimit) {
  cli::write_file(recordings_ + "/g4-before.mcap", std::string(2 * megabyte, 'x'));
  cli::write_file(recordings_ + "/other.mcap", std::string(3 * megabyte, 'x'));
  page_recorder& recorder = make(4 * megabyte);
  ASSERT_EQ(recorder.set(true), "");
  read(recorder, 1500);
  const auto status = recorder.status();
  EXPECT_TRUE(status->file.empty());
  EXPECT_THAT(status->why, HasSubstr("4 MB that --record-limit allows"));
  // What is collected for half a second may exceed it.
  EXPECT_GT(std::filesystem::file_size(recordings_ + '/' + status->last), 2 * megabyte);
  EXPECT_LT(std::filesystem::file_size(recordings_ + '/' + status->last), 5 * megabyte);
  EXPECT_THAT(recorder.set(true), HasSubstr("remove some"));
}

TEST_F(PageRecorder, BytesWithoutScans_AreShownAndEndAtTheLimit) {
  page_recorder& recorder = make(4 * megabyte);
  ASSERT_EQ(recorder.set(true), "");
  read_bytes(600);
  EXPECT_GT(recorder.status()->bytes, megabyte);
  EXPECT_NEAR(recorder.status()->seconds, 0.6, 0.01);
  read_bytes(1500);
  const auto status = recorder.status();
  EXPECT_TRUE(status->file.empty());
  EXPECT_THAT(status->why, HasSubstr("4 MB that --record-limit allows"));
  const auto size = std::filesystem::file_size(recordings_ + '/' + status->last);
  EXPECT_EQ(status->bytes, size);
  EXPECT_LT(size, 6 * megabyte);
  EXPECT_EQ(cli::run({"packets", "-q", recordings_ + '/' + status->last}).code, 0);
}

TEST_F(PageRecorder, OfOneOfSeveralLidars_HasItsNameAndItsPartOfTheLimit) {
  page_recorder& recorder = make(8 * megabyte, {.name = "rear", .count = 2});
  ASSERT_EQ(recorder.set(true), "");
  EXPECT_TRUE(
      std::regex_match(recorder.status()->file, std::regex(R"(g4-\d{8}T\d{6}Z-rear\.mcap)")))
      << recorder.status()->file;
  read(recorder, 3000);
  const auto status = recorder.status();
  EXPECT_THAT(status->why, HasSubstr("--record-limit"));
  EXPECT_GT(status->bytes, 4 * megabyte);
  EXPECT_LT(status->bytes, 7 * megabyte);
}

TEST_F(PageRecorder, InADirectoryThatVanishes_IsReported) {
  page_recorder& recorder = make();
  ASSERT_EQ(recorder.set(true), "");
  read(recorder, 300);
  std::filesystem::remove_all(recordings_);
  read(recorder, 300);
  ASSERT_EQ(recorder.set(false), "");
  EXPECT_THAT(recorder.status()->why, HasSubstr("removed"));
  EXPECT_THAT(recorder.set(true), HasSubstr("No such file or directory"));
  EXPECT_TRUE(recorder.status()->file.empty());
  EXPECT_FALSE(std::filesystem::exists(recordings_)) << "it is not made again";
  std::filesystem::create_directory(recordings_);
  EXPECT_EQ(recorder.set(true), "");
}

TEST_F(PageRecorder, HasALargestNumberOfFiles) {
  for (std::size_t i = 0; i < page_recorder::most_files; ++i) {
    cli::write_file(recordings_ + "/g4-" + std::to_string(i) + ".mcap", "");
  }
  page_recorder& recorder = make();
  EXPECT_THAT(recorder.set(true), HasSubstr("remove some"));
  std::filesystem::remove(recordings_ + "/g4-7.mcap");
  EXPECT_EQ(recorder.set(true), "");
}

TEST_F(PageRecorder, ReportsAFullDisk_AndKeepsWhatWasWritten) {
  page_recorder& recorder = make();
  ASSERT_EQ(recorder.set(true), "");
  read(recorder, 600);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{megabyte, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small);
  read_bytes(1500);  // no scan is needed
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  const auto status = recorder.status();
  EXPECT_TRUE(status->file.empty());
  EXPECT_THAT(status->why, HasSubstr("cannot write " + status->last));
  EXPECT_THAT(status->why, Not(HasSubstr(recordings_))) << "clients need not know it";
  EXPECT_GT(std::filesystem::file_size(recordings_ + '/' + status->last), megabyte);
}

TEST_F(PageRecorder, NeedsALidarAndADirectory) {
  EXPECT_THAT(page_recorder("", megabyte).set(true), HasSubstr("--allow-record"));
  EXPECT_FALSE(page_recorder("", megabyte).status());
  EXPECT_THROW(page_recorder(path("nowhere"), megabyte), g4_tool::failure);
  cli::write_file(path("file"), "");
  EXPECT_THROW(page_recorder(path("file"), megabyte), g4_tool::failure);
  page_recorder alone(recordings_, 100 * megabyte);
  EXPECT_THAT(alone.set(true), HasSubstr("not connected"));
  EXPECT_TRUE(files().empty());
}

class RecordingServer : public Server {
 protected:
  /// The next status whose "recording" is so.
  static json next_recording(serve::raw_client& client, bool is_on) {
    json status = next(client, "status");
    while (!status.is_null() && status["recording"]["file"].is_null() == is_on) {
      status = next(client, "status");
    }
    return status["recording"];
  }
  const std::string recordings_ = path("recordings");
};

TEST_F(RecordingServer, RecordsWhatTheLidarSends) {
  std::filesystem::create_directory(recordings_);
  begin({"--allow-record", recordings_});
  const auto client = open_page();
  const auto other = open_page();
  EXPECT_EQ(next(*client, "hello")["allow_record"], true);
  ASSERT_TRUE(gets_scans(*client));
  client->send_text(R"({"op":"record","on":true})");
  const auto name = next_recording(*client, true)["file"].get<std::string>();
  EXPECT_EQ(next_recording(*other, true)["file"], name) << "all pages show it";
  other->send_text(R"({"op":"record","on":true})");
  EXPECT_EQ(next(*other, "error")["message"], name + " is being recorded already");
  ASSERT_TRUE(gets_scans(*client, 10));
  other->send_text(R"({"op":"record","on":false})");
  EXPECT_EQ(next_recording(*client, false)["last"], name);
  const auto scans = json::parse(cli::run({"stats", "--json", recordings_ + '/' + name}).out);
  EXPECT_GE(scans["scans"].get<int>(), 8);
  EXPECT_LT(scans["samples_lost"].get<int>(), 9000) << "a busy machine loses some";
}

TEST_F(RecordingServer, NobodyRecords_WithoutTheOption) {
  begin();
  const auto client = open_page();
  EXPECT_EQ(next(*client, "hello")["allow_record"], false);
  client->send_text(R"({"op":"record","on":true})");
  EXPECT_THAT(next(*client, "error")["message"].get<std::string>(), HasSubstr("--allow-record"));
  EXPECT_TRUE(next(*client, "status")["recording"].is_null());
}

TEST_F(RecordingServer, HostileRequests_MakeNoFile) {
  std::filesystem::create_directory(recordings_);
  begin({"--allow-record", recordings_});
  EXPECT_THAT(serve::raw_client(port_).upgrade(
                  serve::page, "Host: localhost\r\nOrigin: http://evil.example\r\n"),
              Not(HasSubstr(" 101 ")));
  const auto client = open_page();
  ASSERT_TRUE(gets_scans(*client));
  for (const char* const bad :
       {R"({"op":"record","on":true,"file":"../../escaped.mcap"})",
        R"({"op":"record","on":true,"directory":"/tmp"})", R"({"op":"record","on":"yes"})",
        R"({"op":"record","path":"/etc/passwd"})", R"({"op":"record"})"}) {
    client->send_text(bad);
    EXPECT_EQ(next(*client, "error")["of"], "record") << bad;
  }
  EXPECT_TRUE(std::filesystem::is_empty(recordings_));
  // Many at once: at most one file, which is whole at the end.
  for (int i = 0; i < 200; ++i) client->send_text(R"({"op":"record","on":true})");
  EXPECT_FALSE(next_recording(*client, true).is_null());
  EXPECT_EQ(end().code, 128 + SIGTERM);
  std::vector<std::string> all;
  for (const auto& each : std::filesystem::directory_iterator(recordings_)) {
    all.push_back(each.path().string());
  }
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(cli::run({"stats", all[0]}).code, 0);
}

TEST_F(RecordingServer, ADirectoryThatIsNone_IsAnErrorAtTheStart) {
  const auto done = cli::run({"serve", "sim:", "--port", "0", "--allow-record", path("nowhere")});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.err, HasSubstr("--allow-record"));
}

}  // namespace
