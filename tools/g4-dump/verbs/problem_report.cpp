// SPDX-License-Identifier: MIT
#include "verbs/problem_report.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <thread>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/interrupt.hpp"
#include "io/recorder.hpp"
#include "io/source_word.hpp"
#include "verbs/dump_verbs.hpp"

namespace g4_tool {
extern const char build_version[];  // cmake/version.sh
namespace {

constexpr auto recorded_time = std::chrono::seconds(10);

/// `path`, if it can be the text of a report.
std::string text_path(const std::string& path) {
  if (path != "-" && !path.ends_with(".mcap")) return path;
  throw bad_value("--report: " + in_quotes(path) +
                  " cannot be the text of a report; its recording is put beside it");
}

/// The name of the recording beside the text, which can be written.
std::string recording_beside(const std::string& text) {
  std::string recording = std::filesystem::path(text).replace_extension(".mcap").string();
  const claimed_output checked(recording);
  return recording;
}

/// The rest of the first line of `file` that begins with `name`; empty if there is none.
std::string line_after(const char* file, std::string_view name) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(name)) return line.substr(name.size());
  }
  return {};
}

std::string versions() {
  return fmt::format("g4-dump      {}\ncompiler     {}\n", build_version, __VERSION__);
}

std::string machine() {
  utsname names{};
  ::uname(&names);  // without nodename: the name of the computer is private
  std::array<double, 3> load{};
  static_cast<void>(::getloadavg(load.data(), static_cast<int>(load.size())));
  const char* const simulated = std::getenv("G4LIDAR_SIM_DIR");
  std::string text = fmt::format(
      "kernel       {} {} {}\nsystem       {}\nprocessors   {}\nload         {:.2f} {:.2f} {:.2f} "
      "(1, 5 and 15 minutes)\n",
      names.sysname, names.release, names.machine, line_after("/etc/os-release", "PRETTY_NAME="),
      std::thread::hardware_concurrency(), load[0], load[1], load[2]);
  if (simulated != nullptr) text += fmt::format("simulated    {} (G4LIDAR_SIM_DIR)\n", simulated);
  return text;
}

/// Calls `write`, and writes its failure instead if it throws one.
template <class Write>
void attempt(output& out, Write write) {
  try {
    write();
  } catch (const failure& why) {
    out.write(fmt::format("{}\n", why.what()));
  }
}

}  // namespace

problem_report::problem_report(const common_options& source, const std::string& path)
    : source_(source),
      text_(text_path(path)),
      is_recorded_(!names_file(source.source)),
      recording_(is_recorded_ ? recording_beside(path) : path_of_source(source.source)) {
  text_.write(fmt::format(
      "A report of g4-dump doctor about a problem.\n\n"
      "This file contains: this command line; the versions and the system; the serial ports with\n"
      "their USB numbers and the programs that have them open; the diagnosis; the numbers and\n"
      "settings of the lidar. The recording {} contains what the lidar saw: the shape of\n"
      "the room. Read this file before you publish it, and remove what nobody should see.\n\n"
      "Report problems here: {}\n",
      std::filesystem::path(recording_).filename().string(), G4LIDAR_ISSUES));
  text_.write(fmt::format("\n== command\ng4-dump {}\n", fmt::join(command_line(), " ")));
  text_.write("\n== versions\n" + versions() + "\n== system\n" + machine() + "\n== ports\n");
  attempt(text_, [this] { write_ports(text_); });
  text_.write("\n== diagnosis\n");
}

void problem_report::finish() {
  text_.write("\n== settings\n");
  attempt(text_, [this] { write_facts(source_, text_); });
  text_.write("\n== recording\n");
  if (!is_recorded_) {
    text_.write("The source is a file, and is not recorded again: attach it.\n");
  } else if (interrupt() == 0) {
    attempt(text_, [this] {
      recording_job job;
      job.common = source_;
      job.path = recording_;
      job.common.duration = recorded_time;
      job.keeps_attempt = true;
      job.shows_counts = false;
      const recorded_result got = record(job);
      text_.write(fmt::format("{}: {} from the lidar, {} to it, {}\n",
                              std::filesystem::path(recording_).filename().string(),
                              counted(got.file.bytes_from_device, "byte"), got.file.bytes_to_device,
                              counted(got.file.scans, "scan")));
    });
  }
  text_.commit();
  std::error_code unimportant;
  const bool has_recording = std::filesystem::exists(recording_, unimportant);
  logger::info(fmt::format(
      "{0}{1}{2} {3} what a report of the problem needs. {0} states what it contains: read it, "
      "then "
      "attach {4}: {5}\n",
      text_.title(), has_recording ? " and " : "", has_recording ? in_quotes(recording_) : "",
      has_recording ? "are" : "is", has_recording ? "both" : "it", G4LIDAR_ISSUES));
}

}  // namespace g4_tool
