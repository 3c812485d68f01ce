// SPDX-License-Identifier: MIT
// The ring between an interrupt and a program, as on a real board: the interrupt occurs between any
// two instructions of the other side, also during a carry of the counters.
#include "interrupts.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "check.hpp"
#include "g4lidar/core/point_ring.hpp"

namespace self_test {
namespace {

constexpr std::uint64_t carry = 0x100000000;
using ring_type = g4lidar::point_ring<16>;

/// A point all of whose words follow from its number.
g4lidar::point numbered(std::uint64_t number) {
  g4lidar::point p;
  p.time_ns = static_cast<std::int64_t>(number);
  p.revolution = static_cast<std::uint32_t>(number) * 2654435761U;
  p.angle_deg = static_cast<float>(static_cast<std::uint32_t>(number) % 360U);
  p.range_mm = static_cast<float>(static_cast<std::uint32_t>(number) % 10007U);
  return p;
}

/// The writer: 1 to 24 points at a time, the most of them more than the ring holds.
struct writer {
  ring_type& ring;
  std::uint64_t next;

  void push() { write(prepare()); }
  [[nodiscard]] std::size_t prepare() const {
    const auto count = static_cast<std::size_t>(next % 24U + 1U);
    for (std::size_t i = 0; i < count; ++i) room[i] = numbered(next + i);
    return count;
  }
  void write(std::size_t count) {
    ring.push(std::span<const g4lidar::point>(room).first(count));
    next += count;
  }
};

/// The reader, with its counts.
struct listener {
  ring_type::reader reader;
  std::uint64_t place;
  std::uint64_t missed = 0;
  bool in_order = true;

  void read() {
    const g4lidar::ring_read got = reader.read(std::span<g4lidar::point>(other_room).first(7));
    missed += got.missed;
    place += got.missed;
    for (std::size_t i = 0; i < got.points; ++i) in_order &= other_room[i] == numbered(place + i);
    place += got.points;
  }
};

writer* interrupting_writer = nullptr;
listener* interrupting_listener = nullptr;

/// Cycles to the next interrupt: 50 to 2,097, without a pattern.
std::uint32_t next_delay() {
  static std::uint32_t state = 1;
  state = state * 1664525U + 1013904223U;
  return 50U + (state >> 21);
}

void check_account(const writer& in, const listener& out) {
  check(out.in_order);
  check(out.place <= in.next && out.place + out.reader.ahead() == in.next);
  check(in.ring.written() == in.next);
}

void test_interrupting_writer() {
  constexpr std::uint64_t first = carry - 2048;
  ring_type ring(first);
  writer in{ring, first};
  listener out{ring.make_reader(), first};
  interrupting_writer = &in;
  start_ticks(next_delay(), [] {
    interrupting_writer->push();
    return next_delay();
  });
  while (out.place < carry + 4096) out.read();
  stop_ticks();
  check_account(in, out);
  check(out.missed > 0 && out.missed < out.place - first);
  put("  written by an interrupt: ");
  put_number(static_cast<std::size_t>(out.place - first - out.missed));
  put(" points read, ");
  put_number(static_cast<std::size_t>(out.missed));
  put(" missed\n");
}

void test_interrupting_reader() {
  std::uint64_t read = 0;
  std::uint64_t missed = 0;
  for (std::uint64_t round = 0; round < 200; ++round) {
    const std::uint64_t first = carry - 1 - round % 48;
    ring_type ring(first);
    writer in{ring, first};
    listener out{ring.make_reader(), first};
    interrupting_listener = &out;
    start_ticks(next_delay(), [] {
      interrupting_listener->read();
      return next_delay();
    });
    while (in.next < carry + 48) in.push();
    stop_ticks();
    check_account(in, out);
    read += out.place - first - out.missed;
    missed += out.missed;
  }
  check(read > 0 && missed > 0);
  put("  read by an interrupt: ");
  put_number(static_cast<std::size_t>(read));
  put(" points read, ");
  put_number(static_cast<std::size_t>(missed));
  put(" missed\n");
}

/// One interrupt at every place of a push across the carry, or of a read which that push interrupts.
void test_every_moment(bool writer_interrupts) {
  constexpr std::uint64_t first = carry - 12;
  for (std::uint32_t delay = 20; delay < 620; ++delay) {
    ring_type ring(first);
    writer in{ring, first};
    listener out{ring.make_reader(), first};
    in.push();  // 5 points; the next 10 cross the carry
    interrupting_writer = &in;
    interrupting_listener = &out;
    static std::size_t prepared;
    prepared = in.prepare();
    if (writer_interrupts) {
      start_ticks(delay, [] {
        interrupting_writer->write(prepared);
        return std::uint32_t{0};
      });
      out.read();
      while (ring.written() < carry) {
      }
    } else {
      start_ticks(delay, [] {
        interrupting_listener->read();
        return std::uint32_t{0};
      });
      in.write(prepared);
    }
    stop_ticks();
    out.read();
    check_account(in, out);
    check(out.missed == 0);
  }
}

}  // namespace

void test_board() {
  test_interrupting_writer();
  test_interrupting_reader();
  test_every_moment(true);
  test_every_moment(false);
}

}  // namespace self_test
