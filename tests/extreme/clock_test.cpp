// SPDX-License-Identifier: MIT
// The clock of samples, the assembler of scans and the session, with extreme times and counts.
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "g4lidar/core/clock/arrival_line.hpp"
#include "g4lidar/core/clock/arrival_window.hpp"
#include "g4lidar/core/clock/packet_times.hpp"
#include "g4lidar/core/clock/sample_counter.hpp"
#include "g4lidar/core/point_ring.hpp"
#include "g4lidar/core/scan_assembler.hpp"
#include "g4lidar/core/sensor_clock.hpp"
#include "g4lidar/core/session.hpp"
#include "g4lidar/core/wall_clock.hpp"
#include "numbers.hpp"
#include "support/packet_maker.hpp"

namespace {

using namespace g4lidar;
using namespace g4lidar::extreme;

decoded any_packet(test::dice& random, std::vector<point>& memory) {
  decoded made;
  made.revolution = any<std::uint32_t>(random);
  made.sample_count = any<std::uint16_t>(random);
  made.first_angle_64ths = any<std::uint16_t>(random);
  made.span_64ths = any<std::int16_t>(random);
  made.reported_frequency_chz = any<std::uint16_t>(random);
  made.starts_revolution = random.below(4) == 0;
  made.suspect = random.below(8) == 0;
  memory = several<point>(random, 90);
  if (!made.suspect) made.points = memory;
  return made;
}

TEST(ExtremeClock, Lines) {
  with_extremes<double>([](double x) {
    const double power = exp_minus(x);
    EXPECT_TRUE(power >= 0.0 && power <= 1.0) << x;
    use(square_root(x));
  });
  many_times(
      [](test::dice& random) {
        line_under_points line;
        for (std::size_t i = 0; i < line_under_points::capacity; ++i)
          line.add_left(any<double>(random), any<double>(random));
        use(line.estimate(any<double>(random), any<double>(random), any<double>(random)));
        arrival_window window(any<double>(random));
        window.clear();
        for (int i = 0; i < 200; ++i) {
          use(window.add({any<std::int64_t>(random), any<std::int64_t>(random)},
                         any<double>(random)));
        }
        use(window.span_ns());
        const sampling_line fitted =
            window.fit({any<double>(random), any<double>(random)}, any<double>(random));
        use(fitted.at(any<std::int64_t>(random)));
      },
      300);
}

TEST(ExtremeClock, Packets) {
  late_packets late;
  sample_counter counter;
  std::vector<point> memory;
  many_times([&](test::dice& random) {
    use(late.add(any<bool>(random), any<double>(random), any<std::int64_t>(random)));
    use(counter.next(any_packet(random, memory), any<bool>(random), any<double>(random)));
    use(counter.step_64ths());
    packet_times times{any<std::int64_t>(random), any<double>(random), 0, 0};
    use(times.at(any<std::size_t>(random)));
    std::array<point, 80> points{};
    times.write_to(points);
  });
}

TEST(ExtremeClock, SensorClock) {
  std::vector<point> memory;
  many_times(
      [&](test::dice& random) {
        sensor_clock clock({any<double>(random), any<double>(random), any<std::int64_t>(random),
                            any<std::uint32_t>(random), any<sample_layout>(random)});
        for (int i = 0; i < 100; ++i) {
          clock.seen(any<std::size_t>(random), any<std::int64_t>(random));
          if (random.below(4) == 0) clock.lost(any<std::size_t>(random));
          if (random.below(50) == 0) clock.reset({any<double>(random), any<double>(random)});
          const packet_times times =
              clock.stamp(any_packet(random, memory), any<std::int64_t>(random));
          times.write_to(memory);
          use(clock.next_sample_ns());
          EXPECT_GT(clock.sample_rate_hz(), 0.0);
        }
      },
      300);
}

// Times that are possible stay so, whatever came before.
TEST(ExtremeClock, SensorClockAfterwards) {
  std::vector<point> memory;
  many_times(
      [&](test::dice& random) {
        sensor_clock clock;
        for (int i = 0; i < 30; ++i)
          use(clock.stamp(any_packet(random, memory), any<std::int64_t>(random)));
        EXPECT_TRUE(std::isfinite(clock.sample_rate_hz()));
      },
      300);
}

TEST(ExtremeClock, Assembler) {
  many_times(
      [](test::dice& random) {
        std::vector<point> storage(1 + random.below(500));
        std::vector<point> memory;
        scan_assembler assembler(storage);
        for (int i = 0; i < 50; ++i) {
          assembler.set_sample_rate(any<std::uint32_t>(random));
          if (random.below(8) == 0)
            assembler.add(skipped{any<std::size_t>(random), any<skip_reason>(random)});
          if (random.below(20) == 0) assembler.crc_mismatch();
          decoded packet = any_packet(random, memory);
          while (const auto made = assembler.next(packet)) {
            use(made->end_ns());
            use(made->measured_sample_rate_hz());
            use(made->measured_frequency_hz());
          }
        }
        if (const auto made = assembler.finish()) use(made->end_ns());
      },
      500);
}

TEST(ExtremeClock, Ring) {
  const auto ring =
      std::make_unique<point_ring<64>>(std::numeric_limits<std::uint64_t>::max() - 10);
  auto reader = ring->make_reader();
  std::array<point, 100> out{};
  many_times(
      [&](test::dice& random) {
        ring->push(several<point>(random, 150));
        ring->push(any<point>(random));
        use(reader.read(std::span(out).first(random.below(100))));
        use(reader.ahead());
      },
      300);
  published_count<std::uint32_t> count(0);
  with_extremes<std::uint64_t>([&](std::uint64_t number) {
    count.store(number);
    EXPECT_EQ(count.load(), number);
  });
  with_extremes<std::uint32_t, std::uint32_t, std::uint32_t>([](auto before, auto low, auto after) {
    use(published_count<std::uint32_t>::join(before, low, after));
  });
}

session_times any_times(test::dice& random) {
  session_times made;
  for (std::int64_t* const each :
       {&made.answer_ns, &made.first_answer_ns, &made.start_ns, &made.quiet_ns, &made.drain_ns,
        &made.boot_sign_ns, &made.boot_ns, &made.keep_alive_ns, &made.protected_ns,
        &made.spin_up_notice_ns, &made.first_packet_ns, &made.stall_ns, &made.request_ns}) {
    if (random.below(2) == 0) *each = any<std::int64_t>(random);
  }
  return made;
}

TEST(ExtremeClock, Session) {
  const made::packet sent(0, 100, 500, 40);
  many_times(
      [&](test::dice& random) {
        session asked(any_times(random));
        for (int i = 0; i < 40; ++i) {
          const auto now_ns = any<std::int64_t>(random);
          const request wanted{any<request_kind>(random), any<std::uint16_t>(random)};
          use(asked.begin(wanted, now_ns, any<while_scanning>(random)));
          if (random.below(2) == 0) asked.take(event(sent.view()), now_ns);
          asked.look(any<std::int64_t>(random));
          use(asked.next_look_ns());
          use(asked.scan_length_ns());
          while (asked.to_send()) {
          }
        }
      },
      500);
  many_times(
      [](test::dice& random) {
        const session_times times = any_times(random);
        command_channel channel(times);
        scan_supervisor watch;
        for (int i = 0; i < 20; ++i) {
          const auto now_ns = any<std::int64_t>(random);
          const std::size_t which = random.below(7);
          if (which == 0) channel.drain(now_ns);
          if (which == 1) channel.ask(any<command>(random), any<bool>(random), now_ns);
          if (which == 2) channel.clear(now_ns);
          if (which == 3) channel.start(now_ns);
          if (which == 4) channel.restart(now_ns);
          if (which == 5) watch.start_sent(now_ns);
          if (which == 6) watch.runs(now_ns);
          if (random.below(4) == 0) watch.packet(any<std::int64_t>(random));
          if (random.below(4) == 0) watch.set_protection(any<power_down_protection>(random));
          use(channel.look(any<std::int64_t>(random)));
          use(channel.next_look_ns());
          use(watch.look(any<std::int64_t>(random), times));
          use(watch.header(any<std::int64_t>(random), times));
          use(watch.next_look_ns(times));
        }
      },
      500);
  with_extremes<scan_need>([](scan_need need) { use(notice_of(need)); });
  with_extremes<response_kind>([](response_kind kind) { use(as_reply(kind)); });
  with_extremes<response_kind, std::uint8_t>([](response_kind kind, std::uint8_t largest) {
    const std::array<std::uint8_t, 5> content{largest, 0, 1, 255, 2};
    EXPECT_LE(possible_bytes(kind, content, largest), content.size());
    EXPECT_EQ(possible_bytes(kind, {}, largest), 0U);
  });
}

TEST(ExtremeClock, WallClock) {
  const wall_clock wall;
  with_extremes<std::int64_t>([&](std::int64_t time_ns) { use(wall.at(time_ns)); });
}

}  // namespace
