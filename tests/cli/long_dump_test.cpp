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

class LongDump : public cli::scratch {};

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
