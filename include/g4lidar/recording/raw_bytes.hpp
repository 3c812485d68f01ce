// SPDX-License-Identifier: MIT
// Raw bytes of a lidar, from a file or a pipe, as a connector: with times, so that a driver can
// decode them and a recording can be made of them; the message in which recordings keep them; and copies of them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "g4lidar/core/bytes.hpp"
#include "g4lidar/core/layout_recogniser.hpp"
#include "g4lidar/core/model.hpp"
#include "g4lidar/core/reply_watch.hpp"
#include "g4lidar/core/stream_parser.hpp"
#include "g4lidar/detail/api.hpp"
#include "g4lidar/detail/saturating.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/message/ros_messages.hpp"
#include "g4lidar/recording/player.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/settings.hpp"
#include "g4lidar/transport/transport.hpp"

namespace g4lidar {

/// What sends bytes, and how this is known.
struct recognised_model {
  const model* which = &g4_model;  ///< Valid forever.
  recognised_by basis = recognised_by::nothing;
  std::uint32_t rate_hz = 0;        ///< Samples per second, as measured; 0: not known.
  std::uint32_t frequency_chz = 0;  ///< In 0.01 Hz, from which the rate follows. See may_measure().

  /// Whether other models send such bytes, too.
  [[nodiscard]] constexpr bool is_usual() const noexcept {
    return basis == recognised_by::size || basis == recognised_by::flags;
  }
};

/// Whether `data` begins as a recording does. *Pure.*
[[nodiscard]] constexpr bool begins_recording(bytes data) noexcept {
  constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
  return data.size() >= magic.size() && std::equal(magic.begin(), magic.end(), data.begin());
}

/// Holds bytes that cannot be read again until layout_recogniser has recognised their model. It is
/// complete when the bytes name the model, 1 s after the first packet, after 10 s without a packet, or
/// with 64 KiB; with 1 MiB as long as the size of a sample is not decided; and at once for a recording.
/// *Single thread.* Allocates.
class stream_head {
 public:
  /// Begins at `now_ns`, by any clock.
  explicit stream_head(std::int64_t now_ns) noexcept
      : due_ns_(detail::saturating_add(now_ns, longest_silence_ns)) {}

  /// Adds bytes that were read at `now_ns`.
  void take(bytes data, std::int64_t now_ns) {
    held_.insert(held_.end(), data.begin(), data.end());
    seen_.take(data);
    if (has_packet_ || !seen_.has_packet()) return;
    has_packet_ = true;
    due_ns_ = detail::saturating_add(now_ns, longest_wait_ns);
  }
  /// The input has ended, or nobody waits any longer.
  void finish() noexcept {
    seen_.finish();
    is_finished_ = true;
  }

  /// Whether nothing more needs to be held back.
  [[nodiscard]] bool is_complete(std::int64_t now_ns) const noexcept {
    if (is_finished_ || now_ns >= due_ns_ || begins_recording(held_)) return true;
    if (seen_.sample_bytes() == 0) return held_.size() >= most_undecided;
    return held_.size() >= enough || seen_.basis() == recognised_by::number;
  }
  /// When it is complete even if nothing arrives.
  [[nodiscard]] std::int64_t due_ns() const noexcept { return due_ns_; }
  /// All bytes that were added. Valid until the next call.
  [[nodiscard]] bytes held() const noexcept { return held_; }
  /// What sends them, as far as they show it: if it is complete and not decided, as if they ended here.
  [[nodiscard]] recognised_model found() const noexcept {
    if (seen_.sample_bytes() != 0 || begins_recording(held_)) {
      return {&seen_.most_likely(), seen_.basis(), seen_.rate_hz(), seen_.frequency_chz()};
    }
    layout_recogniser ended = seen_;
    ended.finish();
    return {&ended.most_likely(), ended.basis(), ended.rate_hz(), ended.frequency_chz()};
  }

 private:
  static constexpr std::int64_t longest_wait_ns = 1'000'000'000;
  static constexpr std::int64_t longest_silence_ns = 10'000'000'000;
  static constexpr std::size_t enough = std::size_t{64} << 10U;
  static constexpr std::size_t most_undecided = std::size_t{1} << 20U;

  layout_recogniser seen_;
  std::vector<std::uint8_t> held_;
  std::int64_t due_ns_;
  bool has_packet_ = false;
  bool is_finished_ = false;
};

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

/// Copies what a lidar has sent to raw bytes, as it came. A reader of raw bytes knows neither the commands nor what came
/// before the part that is copied. So answers are repeated that decide how points are read, and that it would not find:
/// at the beginning of a part the device information, with model and firmware, but not that of a G4; and behind a scan
/// header the answer to command 93. *Single thread, allocates.*
class G4LIDAR_API raw_copy {
 public:
  /// Of a lidar like `model`, valid as long as this; `information`: what is known of it before the first bytes.
  explicit raw_copy(const model& model, const device_information& information = {});

  /// Whether the answers before a part matter for reading it, so that they must be passed, too.
  [[nodiscard]] bool needs_begin() const noexcept {
    return which_->zero_angle_divisor != 0 || which_->old_firmware.last_version != 0;
  }

  /// Passes what was received, in order: appends it to `out` if it is wanted, with what is repeated.
  void received(bytes data, bool is_wanted, std::vector<std::uint8_t>& out);
  /// Passes an item of a recording in the same way.
  void take(const recorded_item& item, bool is_wanted, std::vector<std::uint8_t>& out);

 private:
  /// What is known of the lidar by its bytes.
  struct known_lidar {
    const model* like;
    device_information who{};
    reply_watch replies{};
    zero_offset zero{};

    void take(const event& found, const model& named) noexcept;
  };

  void take(const event& found, bool is_wanted);
  [[nodiscard]] bool is_zero_missing() const noexcept;
  void put_information(std::vector<std::uint8_t>& out);
  void put_zero(bool with_header, std::vector<std::uint8_t>& out);

  const model* which_;
  stream_parser parser_;
  known_lidar source_;
  known_lidar reader_;
  bool begins_within_ = false;  // there is something before the first bytes that are copied
  bool has_begun_ = false;
};

}  // namespace g4lidar
