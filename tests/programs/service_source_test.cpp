// SPDX-License-Identifier: MIT
// The service of a SOURCE: what ends it, in the words of the tools.
#include "io/service_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <string>

#include "cli/exit_code.hpp"
#include "program.hpp"
#include "support/patience.hpp"

namespace {

using g4_tool::common_options;
using g4_tool::exit_code;
using g4_tool::loss_rule;
using g4lidar::reader_state;
using g4lidar::test::comes_true;
using ::testing::HasSubstr;

struct ignoring final : g4lidar::service_sink {
  [[nodiscard]] g4lidar::service_demand wanted() const override { return {.runs = true}; }
};

class ServiceSource : public cli::scratch {
 protected:
  /// It ends with such a failure.
  void expect_end(const std::string& source, loss_rule on_loss, exit_code code,
                  const std::string& text) {
    common_options options;
    options.source = source;
    options.on_loss.usual = on_loss;
    const auto made = begin(options);
    ASSERT_TRUE(comes_true([&] { return final_failure_of(options, *made).has_value(); }));
    const g4_tool::failure reason = *final_failure_of(options, *made);
    EXPECT_EQ(reason.code(), code) << reason.what();
    EXPECT_THAT(reason.what(), HasSubstr(text));
    EXPECT_EQ(why_of(options, made->status(0).why, made->counts(0)), reason.what());
  }
  std::unique_ptr<g4lidar::lidar_service> begin(const common_options& options) {
    auto made = g4_tool::make_service({g4_tool::service_lidar_of(options, {})}, {}, {{&sink_}});
    EXPECT_TRUE(made->start());
    return made;
  }

  ignoring sink_;
};

TEST_F(ServiceSource, Unplug_EndsWithTheFailure) {
  expect_end("sim:?fault=unplug@1500ms", loss_rule::exit, exit_code::lost, "unplugged");
}

TEST_F(ServiceSource, InvalidSource_EndsEvenWhereItWouldWait) {
  expect_end("tcp:127.0.0.1:99999", loss_rule::wait, exit_code::usage, "with a port of 1 to 65535");
}

TEST_F(ServiceSource, MissingFile_EndsEvenWhereItWouldWait) {
  expect_end(path("none.mcap"), loss_rule::wait, exit_code::bad_file, "there is no file");
}

TEST_F(ServiceSource, FileWithoutAPacket_IsAnErrorThatNamesIt) {
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

TEST_F(ServiceSource, EndOfAFile_IsNoFailure) {
  ASSERT_EQ(cli::run({"sim", "--seconds", "2", "-o", path("raw.bin")}).code, 0);
  common_options options;
  options.source = path("raw.bin");
  const auto made = begin(options);
  ASSERT_TRUE(comes_true([&] { return made->status(0).state == reader_state::ended; }));
  made->stop();
  EXPECT_FALSE(final_failure_of(options, *made));
  EXPECT_EQ(why_of(options, made->status(0).why, made->counts(0)), "");
}

}  // namespace
