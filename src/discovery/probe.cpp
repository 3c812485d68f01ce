// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <string>
#include <variant>

#include "driver/device_link.hpp"
#include "g4lidar/core/request.hpp"
#include "g4lidar/discovery.hpp"

namespace g4lidar {
namespace {

/// One query to an unknown device.
class inquiry {
 public:
  explicit inquiry(transport& port) noexcept : port_(port) {}

  [[nodiscard]] result<device_information> ask(std::int64_t deadline_ns) {
    static_cast<void>(link_.talk().begin(requests::device_info(), port_.now_ns()));
    while (port_.now_ns() < deadline_ns) {
      const auto sent = link_.send([&](bytes out) { return port_.write(out, deadline_ns); });
      if (!sent) return tl::unexpected(sent.error());
      if (const auto ended = link_.talk().finished()) return judge(*ended);
      if (auto got = receive(deadline_ns); !got) return tl::unexpected(got.error());
    }
    return nothing_believable();
  }

 private:
  [[nodiscard]] result<void> receive(std::int64_t deadline_ns) {
    const std::int64_t due_ns = std::min(link_.talk().next_look_ns(), link_.cut_off_ns());
    const auto got = port_.read(buffer_, std::min(due_ns, deadline_ns));
    if (!got) return tl::unexpected(got.error());
    const std::int64_t now_ns = port_.now_ns();
    if (got->count > 0) {
      link_.heard(got->arrival_ns);
      input_.feed(bytes(buffer_).first(got->count), got->arrival_ns);
    } else if (link_.is_cut_off(now_ns)) {
      input_.cut();
    }
    while (const event* const found = input_.next()) {
      has_heard_ = true;
      has_packets_ = has_packets_ || std::holds_alternative<packet_view>(*found);
      link_.take(*found);
    }
    if (now_ns >= link_.talk().next_look_ns()) link_.talk().look(now_ns);
    return {};
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
  event_reader input_;
  device_link link_{input_};
  std::array<std::uint8_t, 4096> buffer_{};
  bool has_heard_ = false;
  bool has_packets_ = false;
};

}  // namespace

result<device_information> probe(transport& port, std::int64_t deadline_ns) {
  return inquiry(port).ask(deadline_ns);
}

}  // namespace g4lidar
