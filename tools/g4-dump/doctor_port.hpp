// SPDX-License-Identifier: MIT
// The doctor's first stages: which port, who may open it, and who has it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "doctor_words.hpp"
#include "g4lidar/transport.hpp"

namespace g4_dump {

/// Goes through the stages port, permission and holder, each told as it is done, and opens the line.
/// Nothing, where that does not go well; then all further stages are told as skipped, but the one
/// that has the reason.
[[nodiscard]] std::unique_ptr<g4lidar::transport> open_examined(
    const std::string& source, std::uint32_t baud,
    const std::function<void(const stage_report&)>& tell);

/// Whether other baud rates can make a difference there: not on a pseudo-terminal.
[[nodiscard]] bool has_baud_rates(const std::string& path);

/// The diagnosis of a line that could not be found or opened.
[[nodiscard]] diagnosis diagnosis_of(const g4lidar::error& why) noexcept;

}  // namespace g4_dump
