// SPDX-License-Identifier: MIT
#include "errors.hpp"

#include "g4lidar/error.hpp"
#include "g4lidar/lidar_options.hpp"
#include "gil.hpp"

namespace g4lidar::python {
namespace {

/// "no_port": the class NoPort.
std::string class_name(std::string_view problem) {
  std::string name;
  bool begins = true;
  for (const char letter : problem) {
    if (letter != '_') {
      name.push_back(begins && letter >= 'a' && letter <= 'z'
                         ? static_cast<char>(letter - 'a' + 'A')
                         : letter);
    }
    begins = letter == '_';
  }
  return name;
}

nb::str text(std::string_view from) { return nb::str(from.data(), from.size()); }

/// Raises an object of a class of g4lidar.errors, which is made in Python.
template <class... Arguments>
[[noreturn]] void raise_as(const std::string& name, const Arguments&... arguments) {
  in_python([&] {
    const nb::object kind = nb::module_::import_("g4lidar.errors").attr(name.c_str());
    const nb::object made = kind(arguments...);
    PyErr_SetObject(kind.ptr(), made.ptr());
  });
  throw nb::python_error();
}

}  // namespace

void raise(const error& why) {
  // A handler of a signal raised, which ended the call.
  if (why == problem::cancelled && PyErr_Occurred() != nullptr) throw nb::python_error();
  const std::string name = class_name(name_of(why.code()));
  const std::string message = why.message();
  using namespace nb::literals;
  raise_as(name, text(message), "doing"_a = text(name_of(why.doing())),
           "subject"_a = text(why.subject()), "system_errno"_a = why.system_errno(),
           "advice"_a = text(why.advice()), "is_fatal"_a = why.is_fatal());
}

const model* model_of(const std::optional<std::string>& word) {
  if (!word) return nullptr;
  const model* const found = model_named(*word);
  if (found == nullptr) raise_bad_option("model: " + why_no_model(*word));
  return found;
}

const model& model_or_g4(const std::optional<std::string>& word) {
  const model* const found = model_of(word);
  return found == nullptr ? g4_model : *found;
}

std::vector<std::string_view> words_of(std::span<const model* const> which) {
  std::vector<std::string_view> words;
  for (const model* const each : which) words.push_back(each->word);
  return words;
}

void raise_bad_option(const std::string& sentence) {
  const error like(task::opening, problem::bad_option, sentence);
  using namespace nb::literals;
  raise_as("BadOption", text(sentence), "doing"_a = text(name_of(like.doing())),
           "advice"_a = text(like.advice()));
}

void bind_errors(nb::module_& module) {
  nb::dict all;
  for (std::size_t i = 0; i < problem_count; ++i) {
    const auto code = static_cast<problem>(i);
    const std::string name = class_name(name_of(code));
    all[text(name)] = text(description_of(code));
  }
  module.attr("_problems") = all;
}

}  // namespace g4lidar::python
