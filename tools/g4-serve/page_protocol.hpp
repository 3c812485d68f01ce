// SPDX-License-Identifier: MIT
// The protocol of the web page, g4lidar.page.v1, in both directions. docs/serve.md describes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cli/exit_code.hpp"
#include "g4lidar/background_reader.hpp"
#include "g4lidar/diagnostics/diagnosis.hpp"
#include "g4lidar/lidar.hpp"
#include "g4lidar/lidar_service.hpp"
#include "g4lidar/scan.hpp"

namespace g4_tool {

inline constexpr const char* page_subprotocol = "g4lidar.page.v1";

/// {"op":"set"}.
struct set_request {
  std::string name;
  std::string value;    ///< As in `g4-dump set`.
  std::string lidar{};  ///< Of several ones; else empty.
};
/// {"op":"play"}: the changes of the playback.
struct play_request {
  std::optional<bool> paused;
  std::optional<double> speed;
  std::optional<double> seek_s;
};
/// {"op":"record"}: begins or ends the recording. What else it holds is refused: the server chooses the name.
struct record_request {
  bool is_on;
};
/// An object that is not a valid request, and why.
struct bad_request {
  std::string of;  ///< Its "op".
  std::string message;
};
using page_request = std::variant<set_request, play_request, record_request, bad_request>;

/// Nothing for a text that a page never sends: close the connection.
[[nodiscard]] std::optional<page_request> parse_page_request(std::string_view text);

/// A lidar as pages know it.
struct page_lidar {
  std::string name{};  ///< Of one of several; empty for the only one.
  std::optional<device_information> device{};
  const g4lidar::model* model = nullptr;  ///< Null: not known yet.
  nlohmann::ordered_json settings{};
};

/// The contents of the first message, which is sent again when it changes.
struct page_hello {
  std::string source;
  std::vector<page_lidar> lidars{};  ///< The only one, or those of merged scans.
  bool allows_set = false;
  bool allows_record = false;
  std::optional<double> recording_s{};  ///< The length of a recording.
};
[[nodiscard]] std::string hello_text(const page_hello& hello);
[[nodiscard]] std::string settings_text(const std::vector<page_lidar>& lidars);
/// `lidar`: of several ones; else empty.
[[nodiscard]] std::string event_text(std::string_view what, double time_s,
                                     std::string_view lidar = {});
[[nodiscard]] std::string error_text(std::string_view op, std::string_view message);

/// The recording of the server.
struct page_recording {
  std::string
      file{};  ///< The name of the file that is written, without its directory; empty: none.
  std::string last{};  ///< That of the file before it.
  std::string why{};   ///< Why that one ended by itself.
  std::uint64_t bytes = 0;
  double seconds = 0;
};

/// The contents of a status.
struct page_status {
  std::string lidar{};  ///< The name of one of several; else empty.
  reader_state state = reader_state::opening;
  std::string why{};
  std::vector<model_fact> recognised{};    ///< See reader_status::recognised.
  std::optional<double> scan_rate_hz{};    ///< Received scans per second.
  std::optional<double> sample_rate_hz{};  ///< Of the last scan.
  std::optional<double> frequency_hz{};    ///< Of the last scan.
  double loss = 0;                         ///< The ratio of lost samples in the last ten seconds.
  lidar_counts counts{};
  std::vector<stage_report> stages{};
  std::optional<playback_status> playback{};
  std::optional<page_recording> recording{};  ///< With --allow-record.
  std::vector<page_status> lidars{};          ///< Of merged scans; see merged_status().
};
/// The status of several lidars together, with that of each.
[[nodiscard]] page_status merged_status(std::vector<page_status> lidars);
[[nodiscard]] std::string status_text(const page_status& status);

/// A revolution, and what belongs to it.
struct page_scan {
  const scan& revolution;
  double stamp_s;
  std::optional<lidar_place> place{};
  bool is_upside_down = false;
  /// So many points are of each lidar, in order; empty for one lidar.
  std::span<const std::size_t> points_of_each{};
};
/// Appends the binary message of a revolution: its returns in the robot's frame, with their intensities if the model
/// has them.
void put_page_scan(const page_scan& what, std::vector<std::uint8_t>& out);

}  // namespace g4_tool
