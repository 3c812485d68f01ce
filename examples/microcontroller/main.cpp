// SPDX-License-Identifier: MIT
// A G4 on a microcontroller: an interrupt writes the bytes to a ring, the main loop starts the
// lidar, decodes points and revolutions, and prints the nearest obstacle of each.
#include <g4lidar/core/correction.hpp>
#include <g4lidar/core/decode.hpp>
#include <g4lidar/core/scan_assembler.hpp>
#include <g4lidar/core/session.hpp>
#include <g4lidar/core/stream_counter.hpp>
#include <g4lidar/core/stream_parser.hpp>

#include "board.hpp"
#include "byte_ring.hpp"
#include "line.hpp"

namespace {

constexpr int revolutions_to_measure = 20;
constexpr std::int64_t cut_off_after_ns = 20'000'000;  // no device continues a packet after this

byte_ring<1024> received;  // 44 ms of a G4

// All memory of the program. 9,000 samples per second at 5 Hz make 1,800 per revolution.
std::array<g4lidar::point, 1800> scan_room;
std::array<g4lidar::point, g4lidar::max_samples> packet_room;

class obstacle_watch {
 public:
  /// Starts the lidar, measures, stops it again. Returns whether all of it succeeded.
  bool run() {
    return finish(g4lidar::requests::start(), "start") && measure() &&
           finish(g4lidar::requests::stop(), "stop");
  }

  void print_counts() const {
    line text;
    text << counts_.parsed_bytes + counts_.skipped_bytes() + parser_.held() << " bytes, "
         << counts_.packets << " packets, " << counts_.skipped_bytes() << " bytes skipped, "
         << received.overruns() << " lost in the ring, " << board::receiver_overruns()
         << " in the receiver\n";
    board::print(text.text());
  }

 private:
  /// Sends a request to the lidar and waits for its outcome.
  bool finish(const g4lidar::request& wanted, std::string_view name) {
    if (session_.begin(wanted, board::now_ns())) return false;  // refused: a request is in progress
    while (true) {
      if (const auto outcome = session_.finished()) {
        if (outcome->how == g4lidar::verdict::answered) return true;
        board::print(outcome->heard_nothing() ? "nothing was received after: " : "no answer to: ");
        board::print(name);
        board::print("\n");
        return false;
      }
      step();
    }
  }

  bool measure() {
    while (whole_revolutions_ < revolutions_to_measure) {
      step();
      if (session_.noticed() == g4lidar::notice::stalled) {
        board::print("the lidar has stopped, and does not start again\n");
        return false;
      }
    }
    return true;
  }

  /// One round of the main loop: process received bytes, call what is due, send commands.
  void step() {
    std::array<std::uint8_t, 64> piece;
    const std::int64_t now_ns = board::now_ns();
    if (g4lidar::bytes input = received.take(piece); !input.empty()) {
      heard_ns_ = now_ns;
      while (const auto found = parser_.next(input)) take(*found, now_ns);
    } else {
      if (session_.is_busy() && now_ns - heard_ns_ >= cut_off_after_ns) {
        while (const auto found = parser_.finish()) take(*found, now_ns);
      }
      if (session_.next_look_ns() <= now_ns) session_.look(now_ns);
    }
    bool has_sent = false;
    while (const auto command = session_.to_send()) {
      board::send(*command);
      has_sent = true;
    }
    if (!has_sent) board::sleep();  // until the next byte
  }

  void take(const g4lidar::event& found, std::int64_t now_ns) {
    session_.take(found, now_ns);
    counts_.add(found);
    if (const auto* gone = std::get_if<g4lidar::skipped>(&found)) scans_.add(*gone);
    const auto* packet = std::get_if<g4lidar::packet_view>(&found);
    if (packet == nullptr || !session_.is_scanning()) return;
    auto points = g4lidar::decode(*packet, g4lidar::compact_correction{},
                                  revolutions_.count(*packet), packet_room);
    while (const auto scan = scans_.next(points)) use(*scan);
  }

  void use(const g4lidar::scan& scan) {
    if (scan.is_partial()) return;  // the first one, while the motor spins up
    const g4lidar::point* nearest = nullptr;
    for (const g4lidar::point& p : scan.points) {
      // No return is not free space: see filter/too_near.hpp.
      if (p.is_no_return() || p.is_too_near()) continue;
      if (nearest == nullptr || p.range_mm < nearest->range_mm) nearest = &p;
    }
    if (whole_revolutions_ == revolutions_to_measure) return;
    ++whole_revolutions_;
    line text;
    text << scan.revolution << ": " << scan.points.size() << " points";
    if (nearest != nullptr) {
      text << ", the nearest at " << fixed{nearest->range_mm} << " mm, "
           << fixed{nearest->angle_deg} << " degrees";
    }
    text << "\n";
    board::print(text.text());
  }

  g4lidar::stream_parser parser_;
  g4lidar::session session_;
  g4lidar::revolution_counter revolutions_;
  g4lidar::scan_assembler scans_{scan_room};
  g4lidar::stream_counter counts_;
  std::int64_t heard_ns_ = 0;
  int whole_revolutions_ = 0;
};

obstacle_watch watch;

}  // namespace

void on_lidar_byte(std::uint8_t byte) { received.push(byte); }

int main() {
  board::begin();
  const bool has_succeeded = watch.run();
  watch.print_counts();
  return has_succeeded ? 0 : 1;
}
