// SPDX-License-Identifier: MIT
// Single messages of a recording: valid ones are read as written, invalid ones are refused.
#include "recording/messages.hpp"

#include <gtest/gtest.h>

namespace g4lidar::test {
namespace {

bytes message_of(const recorded_event& event, mcap::record_text& memory) {
  mcap::put_event(memory, event, 0);
  return memory.all();
}

TEST(Messages, Event_IsReadAsWritten) {
  mcap::record_text memory;
  const auto read = mcap::event_from(message_of({.what = recorded_event::kind::begun,
                                                 .delivers = true,
                                                 .baud = 230400,
                                                 .samples_per_second = 8000,
                                                 .unparsed = 7,
                                                 .events = 3,
                                                 .time_ns = 123'456'789},
                                                memory));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->what, recorded_event::kind::begun);
  EXPECT_EQ(read->samples_per_second, 8000U);
  EXPECT_EQ(read->unparsed, 7U);
  EXPECT_EQ(read->events, 3U);
  EXPECT_EQ(read->time_ns, 123'456'789);
}

TEST(Messages, ExtremeSampleRate_IsRefused) {
  for (const std::uint32_t rate : {0U, 1'000'001U, UINT32_MAX}) {
    mcap::record_text memory;
    const recorded_event event{.what = recorded_event::kind::begun, .samples_per_second = rate};
    EXPECT_FALSE(mcap::event_from(message_of(event, memory))) << rate;
  }
  mcap::record_text memory;  // a stream that has not begun has no rate
  EXPECT_TRUE(mcap::event_from(message_of({.what = recorded_event::kind::held}, memory)));
}

TEST(Messages, TruncatedEvent_IsRefused) {
  mcap::record_text memory;
  const bytes whole =
      message_of({.what = recorded_event::kind::opened, .name = "/dev/ttyUSB0"}, memory);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(mcap::event_from(whole.first(size))) << size;
  }
}

}  // namespace
}  // namespace g4lidar::test
