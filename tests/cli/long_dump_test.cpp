// SPDX-License-Identifier: MIT
// g4-dump dump of long files: its memory and its times.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "program.hpp"
#include "recording.hpp"

namespace {

using cli::lines_of;
using cli::outcome;
using cli::run;

class LongDump : public cli::scratch {
 protected:
  static outcome dump(const std::string& name, const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"dump", name, "-q"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    cli::program started(arguments, {{}, cli::stream::of_file("/dev/null"), {}});
    return started.wait();
  }
};

TEST_F(LongDump, NeedsNoMoreMemoryThanAShortOne) {
  cli::write_repeated(path("short.bin"), cli::zero(0) + cli::turn(), 500'000);
  cli::write_repeated(path("long.bin"), cli::zero(0) + cli::turn(), 10'000'000);
  const std::vector<std::string> options{"-f",     "csv",     "--frame", "robot",  "--fov",
                                         "-90:90", "--range", "0.1:16",  "--time", "delta"};
  const outcome few = dump(path("short.bin"), options);
  const outcome many = dump(path("long.bin"), options);
  EXPECT_EQ(many.code, 0);
  EXPECT_LT(many.max_rss_kib, few.max_rss_kib + 2048);
}

// At one sample a second a file of some megabytes is a year long: no time overflows on the way, the
// last one is exact, and the memory is that of a minute.
TEST_F(LongDump, IsAYearLong) {
  constexpr std::int64_t samples_of_block = 1 + 9 * 40;
  const std::string block = cli::zero(0, 0) + cli::turn();
  const std::int64_t blocks = 31'536'000 / samples_of_block + 1;
  cli::write_repeated(path("minute.bin"), block, block.size());
  cli::write_repeated(path("year.bin"), block, block.size() * static_cast<std::uint64_t>(blocks));
  const auto thinned = [&](const std::string& name) {  // to the zero packets: nothing came back
    return run({"dump", path(name), "-q", "-f", "csv", "--sample-rate", "1", "--range", "0:0.1",
                "-o", path(name + ".csv")});
  };
  const outcome minute = thinned("minute.bin");
  const outcome year = thinned("year.bin");
  ASSERT_EQ(year.code, 0) << year.err;
  EXPECT_LT(year.max_rss_kib, minute.max_rss_kib + 2048);
  const std::vector<std::string> lines = lines_of(cli::read_file(path("year.bin.csv")));
  EXPECT_EQ(lines.back().substr(lines.back().rfind(',') + 1),
            std::to_string((blocks - 1) * samples_of_block * 1'000'000'000));
}

}  // namespace
