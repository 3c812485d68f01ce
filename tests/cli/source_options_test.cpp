// SPDX-License-Identifier: MIT
// An option about the source that a verb cannot use. Those that a source cannot use are cases of all doors.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "program.hpp"
#include "support/family_reference.hpp"

namespace {

using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using words = std::vector<std::string>;

class SourceOptions : public cli::scratch {};

// Where a verb only prints what is in a file, an offset has no effect.
TEST_F(SourceOptions, AnOffsetOfZero_IsRefusedWhereNothingIsTurned) {
  const auto sample = [](unsigned, unsigned, unsigned) { return reference::wire_sample{0, 1000}; };
  const auto tg = reference::revolutions_of(reference::wire_format_of("tg15"), 6, 30, 1, sample);
  const std::string raw = path("walk.bin");
  const std::string recording = path("walk.mcap");
  cli::write_file(raw, std::string(tg.data.begin(), tg.data.end()));
  ASSERT_EQ(run({"convert", raw, recording, "--model", "tg15"}).code, 0);
  for (const words& line :
       {words{"packets", raw, "--model", "tg15"}, {"packets", recording}, {"info", recording}}) {
    EXPECT_EQ(run(line).code, 0);
    words turned = line;
    turned.insert(turned.end(), {"--zero-angle", "90"});
    const outcome found = run(turned);
    EXPECT_EQ(found.code, 2) << line.front();
    EXPECT_THAT(found.err, HasSubstr("it is for g4-dump dump, scan and convert"));
  }
}

}  // namespace
