// SPDX-License-Identifier: MIT
#include "station.hpp"

#include <array>
#include <utility>

#include "station_board.hpp"
#include "station_reader.hpp"

namespace g4_tool {

std::string_view name_of(station_state state) noexcept {
  constexpr std::array<std::string_view, 5> names{"opening", "running", "resting", "lost", "ended"};
  return names[static_cast<std::size_t>(state)];
}

station::station(const common_options& options, const lidar_options& how,
                 station_listener& listener, const station_options& wishes)
    : reader_(std::make_unique<station_reader>(options, how, listener, wishes)) {}
station::~station() = default;

void station::start() { reader_->start(); }
void station::stop() { reader_->stop(); }

void station::rest(bool rests) {
  reader_->board.request([rests](station_requests& all) { all.rests = rests; });
}
void station::ask(std::function<void(g4lidar::lidar*)> what) {
  reader_->board.request(
      [&what](station_requests& all) { all.questions.push_back(std::move(what)); });
}
void station::pause(bool pauses) {
  reader_->board.request([pauses](station_requests& all) { all.pauses = pauses; });
}
void station::set_speed(double speed) {
  reader_->board.request([speed](station_requests& all) { all.speed = speed; });
}
void station::seek(double position_s) {
  reader_->board.request([position_s](station_requests& all) { all.seek_s = position_s; });
}

std::optional<playback> station::player() const { return reader_->board.view().player; }
station_state station::state() const { return reader_->board.state(); }
std::string station::why() const { return reader_->board.view().why; }
std::exception_ptr station::failure() const { return reader_->board.view().failure; }
lidar_counts station::counts() const { return reader_->board.view().counts; }
std::optional<device_information> station::identity() const {
  return reader_->board.view().identity;
}
std::string station::name() const { return reader_->board.view().name; }
std::vector<stage_report> station::stages() const { return reader_->diagnosis.stages(); }

std::int64_t station::wall_ns(std::int64_t time_ns) const noexcept {
  return reader_->wall_ns(time_ns);
}

}  // namespace g4_tool
