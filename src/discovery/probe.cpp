// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string>
#include <variant>

#include "g4lidar/core/request.hpp"
#include "g4lidar/core/session.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/discovery.hpp"

namespace g4lidar {
namespace {

/// A response that does not continue for this time is not continued: 700 bytes at the baud rate.
constexpr std::int64_t cut_off_after_ns = 30'000'000;

/// One query to an unknown device.
class inquiry {
 public:
  explicit inquiry(transport& port) noexcept : port_(port) {}

  [[nodiscard]] result<device_information> ask(std::int64_t deadline_ns) {
    static_cast<void>(session_.begin(requests::device_info(), port_.now_ns()));
    while (port_.now_ns() < deadline_ns) {
      if (auto sent = send(deadline_ns); !sent) return tl::unexpected(sent.error());
      if (const auto ended = session_.finished()) return judge(*ended);
      if (auto got = receive(deadline_ns); !got) return tl::unexpected(got.error());
    }
    return nothing_believable();
  }

 private:
  [[nodiscard]] result<void> send(std::int64_t deadline_ns) {
    while (const auto command = session_.to_send()) {
      if (auto sent = port_.write(*command, deadline_ns); !sent) return sent;
    }
    return {};
  }

  [[nodiscard]] result<void> receive(std::int64_t deadline_ns) {
    std::int64_t until_ns = std::min(session_.next_look_ns(), deadline_ns);
    if (parser_.held() > 0) until_ns = std::min(until_ns, heard_ns_ + cut_off_after_ns);
    const auto got = port_.read(buffer_, until_ns);
    if (!got) return tl::unexpected(got.error());
    if (got->count > 0) {
      heard_ns_ = got->arrival_ns;
      parser_.feed(bytes(buffer_).first(got->count), [&](const event& found) { take(found); });
    }
    const std::int64_t now_ns = port_.now_ns();
    if (got->count == 0 && now_ns >= heard_ns_ + cut_off_after_ns) {
      while (const auto found = parser_.finish()) take(*found);
    }
    if (now_ns >= session_.next_look_ns()) session_.look(now_ns);
    return {};
  }

  void take(const event& found) noexcept {
    has_heard_ = true;
    has_packets_ = has_packets_ || std::holds_alternative<packet_view>(found);
    session_.take(found, heard_ns_);
  }

  [[nodiscard]] result<device_information> judge(const outcome& ended) const {
    const auto* device = std::get_if<device_information>(&ended.value);
    if (ended.how != verdict::answered || device == nullptr) return nothing_believable();
    if (device->model == model_g4) return *device;
    return failure(task::asking, problem::other_device,
                   std::string(port_.name()) + ", model " + std::to_string(device->model));
  }

  // A connection that is never silent is that of a G4 only if it contains packets; otherwise it is
  // another baud rate or another device.
  [[nodiscard]] tl::unexpected<error> nothing_believable() const noexcept {
    if (has_packets_) return fail(problem::does_not_stop);
    return fail(has_heard_ ? problem::garbage : problem::silence);
  }

  [[nodiscard]] tl::unexpected<error> fail(problem what) const noexcept {
    return failure(task::asking, what, port_.name());
  }

  transport& port_;
  session session_;
  stream_parser parser_;
  std::array<std::uint8_t, 4096> buffer_{};
  std::int64_t heard_ns_ = 0;
  bool has_heard_ = false;
  bool has_packets_ = false;
};

}  // namespace

result<device_information> probe(transport& port, std::int64_t deadline_ns) {
  return inquiry(port).ask(deadline_ns);
}

}  // namespace g4lidar
