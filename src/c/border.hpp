// SPDX-License-Identifier: MIT
// The border between C and C++: errors for the caller, exceptions that end here, memory and texts.
#pragma once

#include <g4lidar/c/base.h>

#include <cstddef>
#include <new>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>

#include "g4lidar/core/model.hpp"
#include "g4lidar/error.hpp"
#include "g4lidar/point.hpp"
#include "versioned_options.hpp"

struct g4lidar_point;
struct g4lidar_identity;

namespace g4lidar::c {

/// The result for a problem.
[[nodiscard]] constexpr int result_of(problem what) noexcept { return static_cast<int>(what) + 1; }

/// Fills what the caller placed, if anything, and returns the code.
int succeed(g4lidar_error* out) noexcept;
int fail(g4lidar_error* out, const error& why) noexcept;
int fail(g4lidar_error* out, g4lidar_result code, g4lidar_task doing, std::string_view message,
         std::string_view advice) noexcept;
/// The same without memory.
int no_memory(g4lidar_error* out) noexcept;
/// A mistake of the caller: what is wrong with an argument.
int refuse(g4lidar_error* out, std::string_view message) noexcept;
/// What is wrong with a text, in its line; 0: in none. `file` is where it was read from, if from a file.
int bad_text(g4lidar_error* out, std::size_t line, std::string_view message,
             std::string_view file = {});
/// An option that has no valid value, in words of this interface.
int bad_option(g4lidar_error* out, std::string_view option) noexcept;

/// The result of `body`, an int or a result<void>, whatever it throws; none of `needed` is null.
template <class Body, class... Pointers>
int guarded(g4lidar_error* out, Body&& body, Pointers... needed) noexcept {
  if ((!needed || ...)) return refuse(out, "a required argument is NULL");
  try {
    if constexpr (std::is_same_v<decltype(body()), int>) {
      return body();
    } else {
      const auto done = body();
      return done ? succeed(out) : fail(out, done.error());
    }
  } catch (const std::bad_alloc&) {
    return no_memory(out);
  } catch (...) {
    return fail(out, G4LIDAR_INTERNAL, G4LIDAR_NO_TASK, "an error of the library",
                "Please report it to the developers.");
  }
}

/// The same for a function that returns a new handle: null on failure.
template <class Handle, class Body, class... Pointers>
int created(Handle** made, g4lidar_error* out, Body&& body, Pointers... needed) noexcept {
  if (made != nullptr) *made = nullptr;
  return guarded(out, std::forward<Body>(body), made, needed...);
}

/// Sets `into` to the model of this word, or leaves it for NULL; false if there is none.
[[nodiscard]] bool take_model(const char* word, const model*& into) noexcept;
/// A word that no model has.
int refuse_model(g4lidar_error* out, const char* given);

/// The same memory: the types of C have the attribute may_alias, so that both languages may use it, and
/// their layouts are compared in layout.cpp.
[[nodiscard]] inline std::span<const point> points_of(const g4lidar_point* points,
                                                      std::size_t count) noexcept {
  return {reinterpret_cast<const point*>(points), count};
}
[[nodiscard]] inline std::span<point> points_of(g4lidar_point* points, std::size_t count) noexcept {
  return {reinterpret_cast<point*>(points), count};
}

/// Copies a text, shortened to whole characters, with its zero byte.
void copy_text(std::span<char> to, std::string_view text) noexcept;

/// The texts of name_of() and describe() are literals.
[[nodiscard]] inline const char* literal(std::string_view text) noexcept {
  // NOLINTNEXTLINE(bugprone-suspicious-stringview-data-usage): ends with a zero byte
  return text.empty() ? "" : text.data();
}

/// A text that may be NULL.
[[nodiscard]] inline std::string_view text_of(const char* text) noexcept {
  return text == nullptr ? std::string_view() : std::string_view(text);
}

}  // namespace g4lidar::c
