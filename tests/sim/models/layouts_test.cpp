// SPDX-License-Identifier: MIT
// Packets of each format with more samples than its models send.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "family_stream.hpp"

namespace g4lidar {
namespace {

class SimLayout : public testing::TestWithParam<test::family_model> {};

TEST_P(SimLayout, MoreSamplesThanTheModelSends_AreRefused) {
  const sample_format& format = model_named(GetParam().word)->samples;
  const reference::wire_format& how = GetParam().format();
  for (unsigned count = 1; count <= 120; ++count) {
    const auto packet = reference::packet_of(how, 0, 6400, 7040,
                                             std::vector<reference::wire_sample>(count, {7, 4000}));
    const bool is_possible = count <= format.max_samples;
    EXPECT_EQ(packet_view::from(packet, format).has_value(), is_possible) << count;
    stream_parser parser(format);
    std::size_t packets = 0;
    std::size_t taken = 0;
    const auto take = [&](const event& found) {
      if (std::holds_alternative<packet_view>(found)) ++packets;
      if (const auto* const gone = std::get_if<skipped>(&found)) taken += gone->count;
    };
    parser.feed(packet, take);
    while (const auto last = parser.finish()) take(*last);
    EXPECT_EQ(packets, is_possible ? 1U : 0U) << count;
    EXPECT_EQ(taken, is_possible ? 0U : packet.size()) << count;
  }
}

INSTANTIATE_TEST_SUITE_P(OfTheFamily, SimLayout, testing::ValuesIn(test::models_of_each_format()),
                         [](const auto& each) {
                           std::string name = each.param.word;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace g4lidar
