// SPDX-License-Identifier: MIT
#include "border.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <string>

#include "core/number_text.hpp"
#include "g4lidar/lidar_options.hpp"
#include "g4lidar/recording/writer.hpp"
#include "g4lidar/version.hpp"

namespace g4lidar::c {
namespace {

// The numbers of the C interface never change: a problem that is added becomes the last one there.
static_assert(problem_count == 30 && result_of(problem::bad_option) == G4LIDAR_BAD_OPTION);
static_assert(result_of(problem::permission) == G4LIDAR_PERMISSION);
static_assert(result_of(problem::cannot_connect) == G4LIDAR_CANNOT_CONNECT);
static_assert(result_of(problem::does_not_stop) == G4LIDAR_DOES_NOT_STOP);
static_assert(result_of(problem::timeout) == G4LIDAR_TIMEOUT);
static_assert(result_of(problem::bad_setting) == G4LIDAR_BAD_SETTING);
static_assert(result_of(problem::reconnecting) == G4LIDAR_RECONNECTING);
static_assert(result_of(problem::interference) == G4LIDAR_INTERFERENCE);
static_assert(result_of(problem::end_of_input) == G4LIDAR_END_OF_INPUT);
static_assert(result_of(problem::system) == G4LIDAR_SYSTEM);
static_assert(static_cast<int>(task::stopping) + 1 == G4LIDAR_STOPPING);

constexpr bool is_problem(int result) noexcept {
  return result > 0 && static_cast<std::size_t>(result) <= problem_count;
}

void fill(g4lidar_error& out, int code, int doing, std::string_view message,
          std::string_view advice) noexcept {
  out.code = code;
  out.task = doing;
  out.system_errno = 0;
  out.is_fatal = code == G4LIDAR_OK ? 0 : 1;
  out.subject[0] = '\0';
  copy_text(out.message, message);
  copy_text(out.advice, advice);
}

/// The sentence without the advice; without memory only the description.
void fill_message(g4lidar_error& out, const error& why) noexcept {
  copy_text(out.message, description_of(why.code()));
  try {
    const std::string text = why.message();
    copy_text(out.message, std::string_view(text).substr(0, text.size() - why.advice().size() - 1));
  } catch (const std::bad_alloc&) {
    return;  // the description stays
  }
}

}  // namespace

void copy_text(std::span<char> to, std::string_view text) noexcept {
  std::size_t size = std::min(text.size(), to.size() - 1);
  if (size < text.size()) {
    const auto continues = [&] {
      return (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U;
    };
    while (size > 0 && continues()) --size;
  }
  std::copy_n(text.begin(), size, to.begin());
  to[size] = '\0';
}

int succeed(g4lidar_error* out) noexcept {
  if (out != nullptr) fill(*out, G4LIDAR_OK, G4LIDAR_NO_TASK, {}, {});
  return G4LIDAR_OK;
}

int no_memory(g4lidar_error* out) noexcept {
  return fail(out, G4LIDAR_NO_MEMORY, G4LIDAR_NO_TASK, "no memory is left", "Free some memory.");
}

int fail(g4lidar_error* out, const error& why) noexcept {
  if (why.system_errno() == ENOMEM) return no_memory(out);
  const int code = result_of(why.code());
  if (out == nullptr) return code;
  fill(*out, code, static_cast<int>(why.doing()) + 1, {}, why.advice());
  fill_message(*out, why);
  out->system_errno = why.system_errno();
  out->is_fatal = why.is_fatal() ? 1 : 0;
  copy_text(out->subject, why.subject());
  return code;
}

int fail(g4lidar_error* out, g4lidar_result code, g4lidar_task doing, std::string_view message,
         std::string_view advice) noexcept {
  if (out == nullptr) return code;
  fill(*out, code, doing, message, advice);
  const std::size_t size = std::string_view(out->message).size();
  if (size + 1 < sizeof out->message) copy_text(std::span(out->message).subspan(size), ".");
  return code;
}

int refuse(g4lidar_error* out, std::string_view message) noexcept {
  fail(out, G4LIDAR_BAD_ARGUMENT, G4LIDAR_NO_TASK, message, "Correct the program.");
  if (out != nullptr) out->is_fatal = 0;
  return G4LIDAR_BAD_ARGUMENT;
}

int bad_text(g4lidar_error* out, std::size_t line, std::string_view message,
             std::string_view file) {
  std::string text = file.empty() ? "" : "reading " + std::string(file) + ": ";
  if (line != 0) text += "line " + std::to_string(line) + ": ";
  fail(out, G4LIDAR_BAD_FILE, G4LIDAR_READING, text.append(message),
       file.empty() ? "Correct the text." : "Give the path of a correct file.");
  if (out != nullptr) copy_text(out->subject, file);
  return G4LIDAR_BAD_FILE;
}

int bad_option(g4lidar_error* out, std::string_view option) noexcept {
  return fail(out, error(task::configuring, problem::bad_option, option));
}

bool take_model(const char* word, const model*& into) noexcept {
  if (word == nullptr) return true;
  into = model_named(word);
  return into != nullptr;
}

int refuse_model(g4lidar_error* out, const char* given) {
  const std::string_view word(given != nullptr ? given : "");
  const bool is_known = !why_unsupported(word).empty();
  return fail(out, G4LIDAR_BAD_OPTION, G4LIDAR_CONFIGURING,
              "model: " + (is_known ? why_no_model(word)
                                    : "there is none with the word " + in_quotes(word)),
              "Give one of " + model_words() + ".");
}

}  // namespace g4lidar::c

const char* g4lidar_result_name(int result) {
  if (g4lidar::c::is_problem(result)) {
    return g4lidar::c::literal(name_of(static_cast<g4lidar::problem>(result - 1)));
  }
  constexpr std::array names{"ok", "bad_argument", "no_memory", "nothing", "internal"};
  const bool is_known = result <= 0 && result >= G4LIDAR_INTERNAL;
  return is_known ? names[static_cast<std::size_t>(-result)] : "unknown";
}

#define G4LIDAR_TEXT_OF(number) #number
#define G4LIDAR_DOTTED(major, minor, patch) \
  G4LIDAR_TEXT_OF(major) "." G4LIDAR_TEXT_OF(minor) "." G4LIDAR_TEXT_OF(patch)
const char* g4lidar_version(void) {
  return G4LIDAR_DOTTED(G4LIDAR_VERSION_MAJOR, G4LIDAR_VERSION_MINOR, G4LIDAR_VERSION_PATCH);
}

int g4lidar_version_number(void) {
  return 10000 * G4LIDAR_VERSION_MAJOR + 100 * G4LIDAR_VERSION_MINOR + G4LIDAR_VERSION_PATCH;
}

bool g4lidar_has_feature(const char* feature) {
  const std::string_view name = g4lidar::c::text_of(feature);
  return name == "simulator" || (name == "zstd" && g4lidar::has_zstd());
}

int64_t g4lidar_now_ns(void) {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::nanoseconds(now).count();
}
