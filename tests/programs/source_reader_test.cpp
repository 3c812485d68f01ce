// SPDX-License-Identifier: MIT
// The reader of a SOURCE: what ends it, in the words of the tools.
#include "io/source_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>

#include "cli/exit_code.hpp"
#include "program.hpp"
#include "support/patience.hpp"

namespace {

using g4_tool::common_options;
using g4_tool::exit_code;
using g4_tool::loss_rule;
using g4_tool::source_reader;
using g4lidar::reader_state;
using g4lidar::test::comes_true;
using ::testing::HasSubstr;

struct ignoring : g4lidar::reader_listener {};

class SourceReader : public cli::scratch {
 protected:
  /// It ends with such a failure.
  void expect_end(const std::string& source, loss_rule on_loss, exit_code code,
                  const std::string& text) {
    common_options options;
    options.source = source;
    options.on_loss.usual = on_loss;
    source_reader made(options, {}, listener_);
    made.start();
    ASSERT_TRUE(comes_true([&] { return made.failure() != nullptr; }));
    try {
      std::rethrow_exception(made.failure());
    } catch (const g4_tool::failure& reason) {
      EXPECT_EQ(reason.code(), code) << reason.what();
      EXPECT_THAT(reason.what(), HasSubstr(text));
      EXPECT_EQ(made.why(), reason.what());
    }
  }

  ignoring listener_;
};

TEST_F(SourceReader, Unplug_EndsWithTheFailure) {
  expect_end("sim:?fault=unplug@1500ms", loss_rule::exit, exit_code::lost, "unplugged");
}

TEST_F(SourceReader, InvalidSource_EndsEvenWhereItWouldWait) {
  expect_end("tcp:127.0.0.1:99999", loss_rule::wait, exit_code::usage, "with a port of 1 to 65535");
}

TEST_F(SourceReader, MissingFile_EndsEvenWhereItWouldWait) {
  expect_end(path("none.mcap"), loss_rule::wait, exit_code::bad_file, "there is no file");
}

TEST_F(SourceReader, FileWithoutAPacket_IsAnErrorThatNamesIt) {
  std::ofstream(path("notes.txt")) << std::string(1000, 'x');
  expect_end(path("notes.txt"), loss_rule::wait, exit_code::bad_file, "This is text");
  expect_end(path("notes.txt"), loss_rule::wait, exit_code::bad_file, "notes.txt");
  std::ofstream(path("noise.bin")) << std::string(1000, '\x17');
  expect_end(path("noise.bin"), loss_rule::wait, exit_code::bad_file, "no point packet");
  // As a user meets it: it ends, and does not wait for a revolution.
  const auto viewed = cli::run({"view", "--once", path("noise.bin")});
  EXPECT_EQ(viewed.code, 10);
  EXPECT_THAT(viewed.err, HasSubstr("no point packet"));
}

TEST_F(SourceReader, EndOfAFile_IsNoFailure) {
  ASSERT_EQ(cli::run({"sim", "--seconds", "2", "-o", path("raw.bin")}).code, 0);
  common_options options;
  options.source = path("raw.bin");
  source_reader made(options, {}, listener_);
  made.start();
  ASSERT_TRUE(comes_true([&] { return made.state() == reader_state::ended; }));
  made.stop();
  EXPECT_EQ(made.failure(), nullptr);
  EXPECT_EQ(made.why(), "");
}

struct throwing : g4lidar::reader_listener {
  void on_scan(const g4lidar::scan& /*found*/) override {
    ++scans;
    throw std::runtime_error("full");
  }
  std::atomic<int> scans = 0;
};

TEST_F(SourceReader, WhatItsListenerThrows_IsTheFailure) {
  common_options options;
  options.source = "sim:";
  throwing listener;
  source_reader made(options, {}, listener);
  made.start();
  ASSERT_TRUE(comes_true([&] { return made.failure() != nullptr; }));
  ASSERT_TRUE(comes_true([&] { return made.reader().counts().scans > 3; }));
  made.stop();
  EXPECT_THROW(std::rethrow_exception(made.failure()), std::runtime_error);
  EXPECT_EQ(listener.scans, 1) << "it is not called again";
}

}  // namespace
