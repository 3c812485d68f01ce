// SPDX-License-Identifier: MIT
// The cases through g4-dump scan, and through g4-serve as a page sees it: in real time.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "cli/program.hpp"
#include "g4lidar/options/option_table.hpp"
#include "serve/server.hpp"
#include "table.hpp"

namespace cases {
namespace {

std::string flag(const std::string& name) {
  const g4lidar::parameter* const row = g4lidar::find_parameter(name);
  return row == nullptr ? "--" + name : g4lidar::flag_of(*row);
}

outcome failed(const cli::outcome& end) { return {std::to_string(end.code), end.err}; }

class Dump : public testing::TestWithParam<json> {};

TEST_P(Dump, DoesIt) {
  std::vector<std::string> words{
      "scan", source_of(GetParam()), "-n", "12", "-f", "jsonl", "-q", "--frame", "robot", "--unit",
      "m"};
  for (std::string& each : words_of(GetParam(), flag)) words.push_back(std::move(each));
  const cli::outcome end = cli::run(words);
  if (end.code != 0) return check(GetParam(), "dump", failed(end));
  outcome seen{"timeout", "no whole scan"};
  for (const std::string& line : cli::lines_of(end.out)) {
    const json scan = json::parse(line);
    if (scan.at("partial")) continue;
    seen = {};
    seen.samples = scan.at("points");
    for (std::size_t i = 0; i < scan.at("angle_deg").size(); ++i) {
      if (scan.at("range_m")[i] == 0) continue;
      seen.hits.push_back({scan["angle_deg"][i], scan["range_m"][i],
                           scan.contains("intensity") ? scan["intensity"][i].get<unsigned>() : 0});
    }
  }
  check(GetParam(), "dump", seen);
}

INSTANTIATE_TEST_SUITE_P(Case, Dump, testing::ValuesIn(of_door("dump")), name_in_test);

class Serve : public serve::Server, public testing::WithParamInterface<json> {
 protected:
  static_assert(std::endian::native == std::endian::little, "as the messages");
  template <class Number>
  static Number take(std::string_view& from) {
    Number value;
    std::memcpy(&value, from.data(), sizeof value);
    from.remove_prefix(sizeof value);
    return value;
  }
  /// The returns of a revolution, by docs/serve.md.
  static outcome seen_in(std::string_view message) {
    outcome seen;
    const unsigned flags = static_cast<unsigned char>(message[1]);
    message.remove_prefix(2);
    const std::size_t count = take<std::uint16_t>(message);
    message.remove_prefix(12);
    for (std::size_t i = 0; i < count; ++i) {
      const auto x_m = take<float>(message);
      seen.add(x_m, take<float>(message));
    }
    EXPECT_EQ(flags & 6U, 0U);
    for (hit& each : seen.hits)
      if ((flags & 8U) != 0) each.intensity = take<std::uint16_t>(message);
    seen.samples = static_cast<double>(count);  // the room has no direction without a return
    return seen;
  }
};

TEST_P(Serve, DoesIt) {
  std::vector<std::string> words = words_of(GetParam(), flag);
  if (GetParam().contains("error")) {
    words.insert(words.begin(), {"serve", source_of(GetParam()), "--port", "0"});
    return check(GetParam(), "serve", failed(cli::run(words)));
  }
  if (!is_simulated(GetParam())) words.emplace_back("--loop");
  begin(words, source_of(GetParam()));
  const auto page = open_page();
  json hello;
  json status;
  outcome seen;
  for (int whole = 0; whole < 10 || !status.is_object();) {
    const auto message = page->next_frame();
    ASSERT_TRUE(message);
    if (message->starts_with('{')) {
      json text = json::parse(*message);
      if (text["op"] == "hello") hello = std::move(text);
      if (text["op"] == "status" && text["recognition"]["model"].is_string())
        status = std::move(text);
    } else if (((*message)[1] & 1) != 0) {
      seen = seen_in(*message);
      ++whole;
    }
  }
  seen.model = status["recognition"]["model"];
  seen.longest_m = hello["device"]["range_m"];
  check(GetParam(), "serve", seen);
}

INSTANTIATE_TEST_SUITE_P(Case, Serve, testing::ValuesIn(of_door("serve")), name_in_test);

}  // namespace
}  // namespace cases
