// SPDX-License-Identifier: MIT
// Recordings: reading their items, and writing.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "context.hpp"
#include "enumeration_words.hpp"
#include "errors.hpp"
#include "g4lidar/recording/reader.hpp"
#include "g4lidar/recording/writer.hpp"
#include "interruption.hpp"
#include "kept_scan.hpp"
#include "process.hpp"

namespace g4lidar::python {

void bind_recording(nb::module_& module);

namespace {

using namespace nb::literals;

/// One item, with its own bytes.
struct kept_item {
  std::string_view kind;
  std::int64_t time_ns;
  std::int64_t wall_ns;
  nb::bytes data;
  std::optional<stamped_odometry> odometry;
};

std::string_view kind_of(const recorded_item& item) {
  switch (item.what) {
    case recorded_item::kind::from_device:
      return "from_device";
    case recorded_item::kind::to_device:
      return "to_device";
    case recorded_item::kind::odometry:
      return "odometry";
    case recorded_item::kind::other:
      break;
  }
  return name_of(item.other.what);
}

nb::bytes bytes_of(bytes data) { return nb::bytes(data.data(), data.size()); }

/// Python's class Recording: a reader that can be set to another place.
class recording {
 public:
  recording(path_text path, double begin, std::optional<double> end)
      : path_(std::move(path.text)), end_(end), reader_(open(begin)) {}

  /// Continues at this time since the beginning of the recording.
  void seek(double seconds) { used() = open(seconds); }
  [[nodiscard]] std::optional<kept_item> next() {
    const auto item = value_of(used().next());
    if (!item) return std::nullopt;
    kept_item made{kind_of(*item), item->time_ns, item->wall_ns, bytes_of(item->data),
                   std::nullopt};
    if (item->what == recorded_item::kind::odometry) made.odometry = item->odometry;
    return made;
  }
  [[nodiscard]] const recording_reader& reader() const { return used(); }
  /// In seconds.
  [[nodiscard]] double duration() const {
    static_cast<void>(used());
    const auto whole = value_of(recording_reader::open(path_, {.is_cancelled = handler_raises}));
    return static_cast<double>(whole.last_ns() - whole.first_ns()) * 1e-9;
  }

 private:
  [[nodiscard]] recording_reader open(double begin) const {
    reading_options how;
    how.from_ns = in_ns(begin);
    how.is_cancelled = handler_raises;
    if (end_) how.to_ns = in_ns(*end_);
    return value_of(recording_reader::open(path_, how));
  }

  // The place in the file is shared with a parent process.
  [[nodiscard]] recording_reader& used() const { return reader_.get("this Recording"); }

  std::string path_;
  std::optional<double> end_;
  of_process<recording_reader> reader_;
};

/// Python's class RecordingWriter.
class writer {
 public:
  explicit writer(recording_writer&& made) : file_(std::move(made)) {}

  /// Raises ValueError after close(), as files of Python do.
  [[nodiscard]] recording_writer& file() const {
    recording_writer& found = file_.get("this RecordingWriter");
    if (is_closed_) throw nb::value_error("this RecordingWriter is closed");
    return found;
  }
  void bytes_of(nb::handle data, std::int64_t time_ns,
                void (recording_writer::*put)(bytes, std::int64_t) noexcept) {
    (file().*put)(buffer(data).read(), time_ns);
    check();
  }
  void scan(const kept_scan& revolution) {
    const elements<point> points(revolution.points);
    g4lidar::scan whole = revolution.about;
    whole.points = points.span();
    file().scan(whole);
    check();
  }
  /// Raises ValueError for what the writer would leave out.
  void odometry(const stamped_odometry& what) {
    recording_writer& into = file();
    const auto before = into.counts();
    if (before.bytes_from_device + before.bytes_to_device == 0)
      throw nb::value_error("odometry follows the first bytes of a recording");
    into.odometry(what);
    check();
    if (into.counts().odometry == before.odometry)
      throw nb::value_error("the numbers of odometry are finite, and at most 1e6");
  }
  void close() {
    recording_writer& closed = file_.get("this RecordingWriter");
    is_closed_ = true;
    python::check(closed.close());
  }

 private:
  /// Raises what could not be written.
  void check() const {
    if (const auto why = file().take_error()) raise(*why);
  }

  of_process<recording_writer> file_;
  bool is_closed_ = false;
};

void bind_item(nb::module_& module) {
  nb::class_<kept_item>(module, "RecordedItem", "One item of a recording.")
      .def_ro("kind", &kept_item::kind,
              "'from_device' (bytes of one read), 'to_device' (bytes that were sent), 'odometry', "
              "or an event: 'opened', "
              "'closed', 'begun', 'gap', ...")
      .def_ro("time_ns", &kept_item::time_ns,
              "When, in nanoseconds of the clock of the connection.")
      .def_ro("wall_ns", &kept_item::wall_ns,
              "The same by the wall clock, in nanoseconds since 1970.")
      .def_ro("data", &kept_item::data, "The bytes, else b''.")
      .def_prop_ro(
          "pose",
          [](const kept_item& item) -> std::optional<std::tuple<double, double, double>> {
            if (!item.odometry) return std::nullopt;
            const pose_2d& pose = item.odometry->pose;
            return std::tuple(pose.x_m, pose.y_m, pose.yaw_rad);
          },
          "Of 'odometry': x and y in metres, and the yaw in radians.");
}

void bind_reader(nb::module_& module) {
  nb::class_<recording>(module, "Recording",
                        "The items of a recording, in order; an iterator. For its scans and points "
                        "use open(path). One thread at a time.")
      .def(nb::init<path_text, double, std::optional<double>>(), "path"_a, "begin"_a = 0.0,
           "end"_a = nb::none(),
           "Only what was recorded from `begin` up to `end`, in seconds since the beginning. "
           "Raises BadFile.")
      .def(
          "__iter__", [](nb::handle self) { return nb::borrow(self); },
          nb::sig("def __iter__(self) -> Recording"))
      .def(
          "__next__",
          [](recording& from) {
            auto item = from.next();
            if (!item) throw nb::stop_iteration();
            return *std::move(item);
          },
          "The next item.")
      .def("seek", &recording::seek, "seconds"_a,
           "Continues at this time since the beginning of the recording: by the index, if the file "
           "has one.")
      .def_prop_ro("duration", &recording::duration,
                   "In seconds; of a file that was cut off, up to the last part that can be read.")
      .def_prop_ro(
          "serial_number",
          [](const recording& from) -> std::optional<std::string> {
            const auto& known = from.reader().device();
            if (!known || !known->information.is_known()) return std::nullopt;
            return std::string(known->information.serial_number());
          },
          "Of the recorded lidar; None if not known so far.")
      .def_prop_ro(
          "model", [](const recording& from) { return from.reader().model().word; },
          "The word of the model of the lidar: 'g4'.")
      .def_prop_ro(
          "is_damaged", [](const recording& from) { return from.reader().damage().any(); },
          "Whether damage was found so far. All intact parts are read nevertheless.")
      .def_prop_ro(
          "bytes_skipped",
          [](const recording& from) { return from.reader().damage().bytes_skipped; },
          "Bytes of the file, so far, that belong to no intact part.")
      .def_prop_ro(
          "position", [](const recording& from) { return from.reader().position(); },
          "In the file, in bytes.")
      .def_prop_ro(
          "size", [](const recording& from) { return from.reader().size(); },
          "Of the file, in bytes.");
}

void make_writer(writer* made, const path_text& path, bool overwrite, packing packed,
                 scan_order order, const std::string& topic, const std::string& frame_id,
                 const std::string& points_topic, no_return_as no_return, bool mark_near,
                 bool near_is_minus_infinity, const std::optional<std::string>& model) {
  recording_options how;
  how.model = model_of(model);
  how.overwrite = overwrite;
  how.packed = packed;
  how.order = order;
  how.topic = topic;
  how.frame_id = frame_id;
  how.points_topic = points_topic;
  how.grid.no_return = no_return;
  how.grid.near_is_minus_infinity = near_is_minus_infinity;
  if (mark_near) how.near = near_limits{};
  new (made) writer(value_of(recording_writer::create(path.text, how)));
}

void bind_writing(nb::class_<writer>& made) {
  made.def(
          "from_device",
          [](writer& into, nb::handle data, std::int64_t time_ns) {
            into.bytes_of(data, time_ns, &recording_writer::from_device);
          },
          "data"_a, "time_ns"_a,
          nb::sig("def from_device(self, data: bytes | bytearray | memoryview | "
                  "numpy.typing.NDArray[numpy.uint8], time_ns: int) -> None"),
          "Records bytes of one read and their arrival, in nanoseconds of the monotonic clock.")
      .def(
          "to_device",
          [](writer& into, nb::handle data, std::int64_t time_ns) {
            into.bytes_of(data, time_ns, &recording_writer::to_device);
          },
          "data"_a, "time_ns"_a,
          nb::sig("def to_device(self, data: bytes | bytearray | memoryview | "
                  "numpy.typing.NDArray[numpy.uint8], time_ns: int) -> None"),
          "The same for bytes that were sent.")
      .def("scan", &writer::scan, "scan"_a, "Records a revolution, as LaserScan and PointCloud2.")
      .def(
          "odometry",
          [](writer& into, std::int64_t time_ns, double x_m, double y_m, double yaw_rad,
             const twist_2d& twist) { into.odometry({time_ns, {x_m, y_m, yaw_rad}, twist}); },
          "time_ns"_a, "x_m"_a, "y_m"_a, "yaw_rad"_a, "twist"_a = twist_2d{},
          "Records the pose of the robot in a fixed frame, and its velocity. Raises ValueError "
          "before the first bytes, and for numbers that are not finite or above 1e6.")
      .def(
          "set_wall_clock",
          [](writer& into, std::int64_t ahead_ns) { into.file().set_wall_clock(ahead_ns); },
          "ahead_ns"_a,
          "From now on the wall clock is the time of the items plus this, in nanoseconds.");
}

}  // namespace

void bind_recording(nb::module_& module) {
  bind_item(module);
  bind_reader(module);
  nb::class_<writer> made(
      module, "RecordingWriter",
      "Writes a recording (MCAP) of bytes, scans and odometry; open(..., record=path) does it for "
      "a lidar. Raises System "
      "if the disk is full; what was written before stays valid. One thread at a time.");
  made.def("__init__", &make_writer, "path"_a, nb::kw_only(), "overwrite"_a = false,
           "packing"_a = packing::none, "order"_a = scan_order::angle, "topic"_a = "/scan",
           "frame_id"_a = "laser", "points_topic"_a = "", "no_return"_a = no_return_as::infinity,
           "mark_near"_a = false, "near_is_minus_infinity"_a = false, "model"_a = nb::none(),
           "Creates the file. `packing` 'zstd' compresses it. `topic` is that of the LaserScan "
           "messages, `points_topic` "
           "that of PointCloud2 messages ('': none). `no_return`: what ranges without return are; "
           "`mark_near`: whether directions are flagged as by ScanShaper. `model`: what sends "
           "the "
           "bytes, 'x4'; None: what the lidar that is recorded states, else 'g4'.");
  bind_writing(made);
  made.def(
          "flush", [](writer& into) { check(into.file().flush()); },
          "Passes everything to the system.")
      .def("close", &writer::close,
           "Ends the file with its summary. A second call does nothing; every other call then "
           "raises ValueError.");
  bind_context(made, "def __enter__(self) -> RecordingWriter", &writer::close);
}

}  // namespace g4lidar::python
