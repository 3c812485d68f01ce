// SPDX-License-Identifier: MIT
// g4-dump and the offset of zero: recordings, raw bytes, parts of them, --zero-angle; and numbers of other models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "program.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* missing = "the offset of zero of this TG15 is not known";

class ZeroAngleOption : public cli::scratch {
 protected:
  void record(const std::string& source) {
    const outcome made = run({"record", source, "-o", path("a.mcap"), "-d", "1s", "--force"});
    ASSERT_EQ(made.code, 0) << made.err;
  }
  void convert(const std::string& from, const std::string& to,
               const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"convert", path(from), path(to), "--force"};
    words.insert(words.end(), more.begin(), more.end());
    const outcome done = run(words);
    ASSERT_EQ(done.code, 0) << done.err;
  }
  /// Angles and ranges of all points.
  [[nodiscard]] std::vector<std::string> points_of(const std::string& name,
                                                   const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"decode", path(name)};
    words.insert(words.end(), more.begin(), more.end());
    const outcome done = run(words);
    EXPECT_EQ(done.code, 0) << done.err;
    log_ = done.err;
    const std::vector<std::string> rows = lines_of(done.out);
    std::vector<std::string> all;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const std::size_t begin = rows[i].find(',') + 1;
      all.push_back(rows[i].substr(begin, rows[i].rfind(',') - begin));
    }
    return all;
  }

  /// A thousand of the last points: packets behind a stop make none in a recording, but in raw bytes.
  static std::vector<std::string> some_of(const std::vector<std::string>& points) {
    if (points.size() < 1100) return {};
    return {points.end() - 1100, points.end() - 100};
  }
  static bool has(const std::vector<std::string>& points, const std::vector<std::string>& some) {
    return std::search(points.begin(), points.end(), some.begin(), some.end()) != points.end();
  }

  std::string log_;  // what points_of() wrote to standard error
};

TEST_F(ZeroAngleOption, WhereItIsMissing_ALineReportsIt) {
  record("sim:?model=tg15&zero_angle_cdeg=9000&fault=mute=93");
  convert("a.mcap", "a.bin");
  convert("a.bin", "b.mcap", {"--zero-angle", "90"});
  for (const char* const name : {"a.mcap", "a.bin"}) {
    const auto without = points_of(name);
    EXPECT_THAT(log_, HasSubstr(missing)) << name;
    EXPECT_THAT(log_, HasSubstr("--zero-angle gives it"));
    const auto given = points_of(name, {"--zero-angle", "90"});
    EXPECT_THAT(log_, Not(HasSubstr(missing))) << name;
    EXPECT_TRUE(has(points_of("b.mcap"), some_of(given))) << name;
    ASSERT_EQ(given.size(), without.size());
    for (std::size_t i = 0; i < given.size(); ++i) {
      const double apart = std::stod(given[i]) - std::stod(without[i]);
      ASSERT_NEAR(std::remainder(apart - 90.0, 360.0), 0.0, 0.001) << i;
    }
  }
  const outcome listed = run({"doctor", path("a.bin")});
  EXPECT_THAT(listed.out, HasSubstr("no_zero_angle"));
  const outcome served = run({"dump", "sim:?model=tg15&fault=mute=93", "-n", "1"});
  EXPECT_THAT(served.err, HasSubstr(missing));
}

TEST_F(ZeroAngleOption, WhereItHasNoMeaning_IsRefused) {
  ASSERT_EQ(run({"sim", "--model", "tg15", "--seconds", "1", "-o", path("tg.bin")}).code, 0);
  convert("tg.bin", "tg.mcap", {"--model", "tg15"});
  const std::string raw = path("g4.bin");
  ASSERT_EQ(run({"sim", "--seconds", "1", "-o", raw}).code, 0);
  const auto expect_refused = [](const std::vector<std::string>& words, const std::string& why) {
    const outcome done = run(words);
    EXPECT_EQ(done.code, 2) << words[0];
    EXPECT_THAT(done.err, HasSubstr(why));
    EXPECT_EQ(done.out, "");
  };
  expect_refused({"decode", raw, "--zero-angle", "10"}, "a G4 has no such offset");
  expect_refused({"dump", "sim:", "--zero-angle", "10"}, "zero_angle");
  // Where a verb only prints what is in a file, an offset has no effect.
  for (std::vector<std::string> words :
       std::vector<std::vector<std::string>>{{"packets", path("tg.bin"), "--model", "tg15"},
                                             {"packets", path("tg.mcap")},
                                             {"info", path("tg.mcap")}}) {
    EXPECT_EQ(run(words).code, 0);
    words.insert(words.end(), {"--zero-angle", "90"});
    expect_refused(words, "it is for g4-dump dump, scan and convert");
  }
  expect_refused({"decode", raw, "--zero-angle", "361"}, "361");
  expect_refused({"convert", raw, path("out.bin"), "--zero-angle", "10"},
                 "the bytes stay as they are");
  EXPECT_EQ(listing(), "g4.bin\ntg.bin\ntg.mcap\n");
}

}  // namespace
