// SPDX-License-Identifier: MIT
// The table of options, and what is made from it: each row is complete, its limits hold, and the documents have it.
#include "g4lidar/options/option_table.hpp"

#include <gmock/gmock.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "g4lidar/options/filter_text.hpp"
#include "g4lidar/transport/source.hpp"

namespace g4lidar::test {
namespace {

using ::testing::HasSubstr;

std::string contents_of(const std::string& path) {
  std::ifstream file(G4LIDAR_SOURCE_DIR "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string set(lidar_options& into, const char* name, const parameter_value& value) {
  return set_option(into, *find_parameter(name), value);
}

TEST(OptionTable, EachRowIsComplete) {
  std::set<std::string_view> names;
  for (const parameter& each : all_parameters()) {
    EXPECT_TRUE(names.insert(each.name).second) << each.name;
    EXPECT_EQ(find_parameter(each.name), &each);
    EXPECT_FALSE(each.text.empty() || each.text.ends_with('.')) << each.name;
    EXPECT_LE(each.text.size() + each.unset.size(), 90U) << each.name;
    if (each.usual.empty()) continue;
    EXPECT_EQ(converted(std::string(each.usual), each.type).index(), each.type) << each.name;
    filter_settings filters;
    if (each.kind == parameter_kind::filter) {
      EXPECT_EQ(set_filter(filters, each.name, each.usual), "") << each.name;
    }
  }
  EXPECT_EQ(find_parameter("rnage_min"), nullptr);
}

TEST(OptionTable, EachFilterHasASetter) {
  for (const parameter& each : all_parameters()) {
    filter_settings filters;
    const std::string wrong = set_filter(filters, each.name, "east");
    const bool is_filter = each.kind == parameter_kind::filter;
    EXPECT_EQ(wrong.starts_with("there is no filter"), !is_filter) << each.name << ": " << wrong;
  }
}

TEST(OptionTable, ALimitIsTheLastValueThatIsTaken) {
  for (const auto& [name, least, most] :
       {std::tuple("baud", 1.0, 1e7), std::tuple("zero_angle", -360.0, 360.0),
        std::tuple("longest_backoff", 1.0, 1000.0), std::tuple("answer_time", 10.0, 10'000.0),
        std::tuple("stall_time", 100.0, 60'000.0), std::tuple("batch", 0.0, 100.0),
        std::tuple("transport_delay", 0.0, 1e9), std::tuple("speed", 0.001, 1000.0),
        std::tuple("raw_sample_rate_hz", 1.0, 1e6)}) {
    lidar_options options;
    options.model = model_named("tg15");  // has an offset of zero
    EXPECT_EQ(set(options, name, least), "") << name;
    EXPECT_EQ(problem_with(options), std::nullopt) << name;
    EXPECT_EQ(set(options, name, most), "") << name;
    EXPECT_EQ(problem_with(options), std::nullopt) << name;
    EXPECT_THAT(set(options, name, least - 1), HasSubstr("is not in the range")) << name;
    EXPECT_THAT(set(options, name, most + 1), HasSubstr("is not in the range")) << name;
    EXPECT_THAT(set(options, name, std::string("many")), HasSubstr("is not in the range")) << name;
  }
}

TEST(OptionTable, SetsWhatItNames) {
  lidar_options options;
  EXPECT_EQ(set(options, "model", std::string("x4!")), "");
  EXPECT_EQ(options.model, model_named("x4"));
  EXPECT_TRUE(options.insist_on_model);
  EXPECT_THAT(set(options, "model", std::string("x44")), HasSubstr("x44"));
  EXPECT_EQ(options.model, model_named("x4"));
  options.model = nullptr;
  EXPECT_EQ(set(options, "listen_only", true), "");
  EXPECT_TRUE(options.listen_only);
  EXPECT_EQ(set(options, "answer_time", std::string("250")), "");
  EXPECT_EQ(options.tuning.answer_time, std::chrono::milliseconds(250));
  EXPECT_EQ(set(options, "pace", std::string("revolutions")), "");
  EXPECT_EQ(options.tuning.pace, read_pace::revolutions);
  EXPECT_THAT(set(options, "pace", std::string("slow")), HasSubstr("packets"));
  EXPECT_EQ(set(options, "zero_angle", -1.5), "");
  EXPECT_EQ(options.zero_angle, zero_angle{.cdeg = -150});
  EXPECT_EQ(set(options, "frequency", 7.5), "");
  EXPECT_EQ(options.frequency, scan_frequency{750});
  EXPECT_EQ(set(options, "end", std::int64_t{5}), "");
  EXPECT_EQ(options.playback.to_ns, 5);
  EXPECT_THAT(set(options, "grid", std::int64_t{720}), HasSubstr("grid"));  // of programs
}

// As people read them: the table is the only place of these texts.
TEST(OptionTable, DescribesAnOption) {
  const auto text_of = [](const char* name) { return description_of(*find_parameter(name)); };
  EXPECT_EQ(text_of("zero_angle"), "Added to all angles, not the answer to command 93, degrees");
  EXPECT_EQ(text_of("range_min"), "Shortest range that is kept, m");
  EXPECT_THAT(text_of("baud"), HasSubstr("searched, or by the model"));
}

/// As the node has it: a setting that is on or off may also be nothing.
std::uint8_t node_type(const parameter& of) {
  return of.type == 1 && of.setting != nullptr ? std::uint8_t{4} : of.type;
}

std::string node_default(const parameter& of) {
  const std::string zero = node_type(of) == 1 ? "false" : node_type(of) == 4 ? "" : "0";
  return (of.usual.empty() ? zero : std::string(of.usual)) + (of.type == 3 ? ".0" : "");
}

/// The rows of a table of docs/ros_packages.md.
std::string document_rows(bool are_fixed) {
  constexpr std::array types{"", "bool", "integer", "double", "string"};
  std::string made;
  for (const parameter& each : all_parameters()) {
    const bool is_fixed = each.kind == parameter_kind::read_only;
    if (!each.is_of(option_door::node) || is_fixed != are_fixed) continue;
    const std::string usual = node_default(each);
    const auto [constraints, range] = limits_of(each);
    made.append("| `").append(each.node_name.empty() ? each.name : each.node_name);
    made.append("` | ").append(types.at(node_type(each))).append(" | ");
    made.append(usual.empty() ? "" : "`" + usual + "`").append(" | ").append(description_of(each));
    if (!constraints.empty() && each.name != "model")
      made.append(" (").append(constraints).append(")");
    made += " |\n";
  }
  return made;
}

TEST(OptionTable, TheParametersOfTheNodeAreInItsFileAndItsDocument) {
  const std::string file = contents_of("ros/g4lidar_ros/config/lidar.yaml");
  const std::string document = contents_of("docs/ros_packages.md");
  const std::regex line("\n    (\\w+): +\"?([^\"#]*?)\"? +# \\S");
  std::set<std::pair<std::string, std::string>> found;
  for (std::sregex_iterator at(file.begin(), file.end(), line), end; at != end; ++at)
    found.emplace((*at)[1], (*at)[2]);
  std::set<std::pair<std::string, std::string>> wanted;
  for (const parameter& each : all_parameters()) {
    if (each.is_of(option_door::node))
      wanted.emplace(each.node_name.empty() ? each.name : each.node_name, node_default(each));
  }
  EXPECT_EQ(found, wanted);
  for (const bool are_fixed : {false, true})
    EXPECT_THAT(document, HasSubstr("|---|---|---|---|\n" + document_rows(are_fixed)));
}

TEST(OptionTable, TheOptionsOfPythonAreInItsInterface) {
  const std::string source = contents_of("python/src/opening.cpp");
  for (const parameter& each : all_parameters()) {
    if (!each.is_of(option_door::python) || each.setting != nullptr) continue;
    EXPECT_THAT(source, HasSubstr("\"" + std::string(each.name) + "\"_a"));
  }
}

}  // namespace
}  // namespace g4lidar::test
