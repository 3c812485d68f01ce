// SPDX-License-Identifier: MIT
// Raw bytes of a lidar, from a file or a pipe, as a connector: with times, so that a driver can
// decode them and a recording can be made of them; and the message in which recordings keep them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/recording/stream_head.hpp"
#include "g4lidar/transport/connector.hpp"

namespace g4lidar {

/// Opens the file at `path`, or standard input for "-". The connector returns one transport, once;
/// it ends with end_of_input, and no device answers.
///
/// A regular file contains no times, so they are counted: its packets arrive at the rate of their
/// samples, `sample_rate_hz` (1 to 1,000,000; nothing: first_rate_hz() of the model), each packet as a whole with its last sample; the
/// first sample has the modification time of the file as its wall-clock time. It is played like a
/// recording; the times begin at 1 s. At speed 0 calls do not wait, and now_ns() is the time of the bytes
/// read last. Bytes of a pipe, a terminal or a
/// device have the time at which they are read. *Allocates on open.*
///
/// `is_cancelled` is called at least once for each 64 KiB of a regular file, by the thread that reads, if
/// it is set: while it returns true, reading fails with cancelled.
///
/// `model`: what sent the bytes; valid as long as the connector. Null: recognised_in() of a regular
/// file. Of everything else the first bytes are read while it is opened, as stream_head states: so this
/// waits until the lidar sends, at most 10 s, and up to 1 s longer; `is_cancelled` ends it: with cancelled if nothing has
/// been read, else what was read decides.
///
/// Fails with bad_option and system; and where `model` is null, for text with bad_file, and for the frames of another
/// maker with other_device. Reading fails with bad_file if a pipe contains a recording.
[[nodiscard]] G4LIDAR_API result<std::unique_ptr<connector>> open_raw_bytes(
    const std::string& path, std::optional<std::uint32_t> sample_rate_hz,
    const playback_options& options = {}, std::function<bool()> is_cancelled = {},
    const model* model = nullptr);

/// What sent the bytes in the regular file at `path`, or in that from which standard input comes for
/// "-": what layout_recogniser finds in the first 64 KiB, and in up to 1 MiB until the size of a
/// sample is decided. The G4 if that shows nothing, and of everything that is not a regular file.
/// Nothing is taken from standard input. Allocates.
[[nodiscard]] G4LIDAR_API recognised_model recognised_in(const std::string& path);
/// The model that recognised_in() finds. Valid forever. Allocates.
[[nodiscard]] G4LIDAR_API const model& model_of_bytes(const std::string& path);

/// What `data` is: text, frames of another maker, bytes that were changed on the way, also where some packets are left.
/// Sentences for the user; empty: packets of a lidar, or not known. Allocates.
[[nodiscard]] G4LIDAR_API std::string what_is(bytes data);

/// The topic under which recordings keep the bytes of the lidar. A file in MCAP with these messages,
/// by any program, is a recording.
inline constexpr std::string_view recorded_bytes_topic = "/g4lidar/from_device";
/// The definition of these messages.
[[nodiscard]] G4LIDAR_API message_schema recorded_bytes_schema() noexcept;
/// Appends such a message to `out`, in CDR: `data` was read, and its last byte arrived at `time_ns`, by
/// the clock of the transport. Allocates beyond the capacity of `out`.
G4LIDAR_API void put_recorded_bytes(bytes data, std::int64_t time_ns,
                                    std::vector<std::uint8_t>& out);

}  // namespace g4lidar
