// SPDX-License-Identifier: MIT
#include "text_input.hpp"

#include <fmt/format.h>

#include "cli/exit_code.hpp"
#include "cli/logger.hpp"
#include "io/input.hpp"
#include "io/interrupt.hpp"

namespace g4_tool {
namespace {

/// The layout of samples with the values of `now` and with those of `text`.
sample_layout layout_with(sample_layout now, const point_lines& text) {
  using enum sample_layout;
  const bool has_flags = text.has_sample_flags() || has_sample_flags(now);
  const bool has_intensity = text.has_intensity() || intensity_bits(now) > 0;
  if (has_flags) return has_intensity ? intensity_8 : flagged_mm;
  return longest_range_mm(now) > longest_range_mm(quarter_mm) ? intensity_16 : intensity_10;
}

/// The model of the points in `input`: the one that `common` names, else a G4; with samples of another layout
/// if the first line shows that the points have an intensity or flags that those of the model do not
/// have. Reads ahead. Reports where no model is named and the G4 has to be taken for another lidar.
g4lidar::model model_of_text(input& input, text_source form, const common_options& common) {
  const g4lidar::model* const named = common.expected.model;
  g4lidar::model made = named == nullptr ? g4_model : *named;
  point_lines lines(form, g4lidar::frame::vendor, made);
  static_cast<void>(lines.read(input.first_line(common)));
  if (lines.unexpected().empty()) {
    if (named == nullptr && common.frame == g4lidar::frame::robot) {
      logger::info(
          fmt::format("{} does not name a lidar: its points are turned as those of {} {}; "
                      "--model names another\n",
                      input.title(), article_of(made), made.name));
    }
    return made;
  }
  if (named == nullptr) {
    logger::info(
        fmt::format("{} has {}, which {} {} does not measure; its directions are read as those of "
                    "{} {}; --model names another\n",
                    input.title(), lines.unexpected(), article_of(made), made.name,
                    article_of(made), made.name));
  }
  made.samples.layout = layout_with(made.samples.layout, lines);
  return made;
}

/// Reports the counts of the text `title`, whose points are those of a lidar like `model`. Throws a failure if it has
/// no points, or values in later lines that the first one does not announce.
void report_text(const text_points& text, const std::string& title, const g4lidar::model& model) {
  if (!text.unexpected().empty()) {
    throw failure(
        exit_code::bad_file,
        fmt::format("{} has {} only in later lines, and {} {} does not measure it. Name the "
                    "lidar that measured these points with --model.",
                    title, text.unexpected(), article_of(model), model.name));
  }
  const auto& [line, column] = text.first_bad_line();
  const std::string first_bad =
      column.empty() ? "" : fmt::format("line {} has no valid {}", line, column);
  if (text.points() == 0 && interrupt() == 0) {
    throw failure(exit_code::bad_file,
                  title +
                      (text.is_foreign() ? " has no columns angle_deg and range_mm or range_m. "
                                         : " holds no points. ") +
                      (first_bad.empty() ? "" : "Its " + first_bad + ". ") +
                      "Give points as g4-dump writes them, one in each line.");
  }
  logger::info(fmt::format("{}, {} without one{}\n", counted(text.points(), "point"),
                           counted(text.bad_lines(), "line"),
                           first_bad.empty() ? "" : ": " + first_bad));
}

}  // namespace

int convert_text(const point_options& options, text_source form, g4lidar::frame in) {
  const common_options& common = *options.common;
  input from(path_of_source(common.source), "Give csv or jsonl as g4-dump writes it.");
  point_output to(options, time_origin::written);
  const g4lidar::model which = model_of_text(from, form, common);
  to.open(from.is_file());
  to.use_model(which);
  text_points way(form, in, to.writer(), to.out(), which);
  from.pump(to.out(),
            {.take =
                 [&](std::span<const std::uint8_t> got) {
                   way.take({reinterpret_cast<const char*>(got.data()), got.size()});
                 },
             .is_done = [&] { return to.writer().is_done(); }},
            common);
  if (!to.writer().is_done()) way.finish();
  report_text(way, from.title(), which);
  const bool has_something = to.writer().has_taken();
  if (!has_something && interrupt() == 0)
    throw nothing_to_write(from.title(), to.writer().takes_scans());
  if (has_something) to.commit();
  to.report();
  return exit_code_now();
}

}  // namespace g4_tool
