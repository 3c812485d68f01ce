// SPDX-License-Identifier: MIT
// The verb set: settings, each shown before and after.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exit_code.hpp"
#include "interrupt.hpp"
#include "manners.hpp"
#include "output.hpp"
#include "settings.hpp"
#include "talk.hpp"
#include "verbs.hpp"

namespace g4_dump {
namespace {

struct set_options {
  shared_options common = std::make_shared<common_options>();
  std::shared_ptr<bool> json = std::make_shared<bool>(false);
  std::vector<wish> wishes;
};

void add_wish(set_options& options, const std::string& word) {
  if (!is_wish(word)) throw bad_value(fmt::format("'{}' is no NAME=VALUE such as rate=9k", word));
  const wish added = wish_of(word);
  for (const wish& earlier : options.wishes) {
    if (earlier.which == added.which) {
      throw bad_value(fmt::format("{} is given twice", name_of(added.which)));
    }
  }
  options.wishes.push_back(added);
}

using maybe_answer = std::optional<g4lidar::answer>;

class settings_writer {
 public:
  settings_writer(output& out, bool json) : out_(out), json_(json) {
    if (!json_) row("NAME", "BEFORE", "AFTER");
  }

  void write(const wish& wanted, const maybe_answer& before, const maybe_answer& after) {
    if (!json_) return row(name_of(wanted.which), text_of(before), text_of(after));
    nlohmann::ordered_json all;
    all["name"] = name_of(wanted.which);
    all["before"] = json_of(before);
    all["wanted"] = json_of(wanted.value);
    all["after"] = json_of(after);
    write_line(out_, all);
    out_.flush();
  }

 private:
  void row(std::string_view name, std::string_view before, std::string_view after) {
    out_.write(fmt::format("{:<11} {:<8} {}\n", name, before, after));
    out_.flush();
  }

  output& out_;
  bool json_;
};

/// Sets one; what is not reached is written as far as it came, and ends the command.
maybe_answer carry_out(g4lidar::lidar& lidar, const wish& wanted, settings_writer& writer) {
  const maybe_answer before = read_setting(lidar, wanted.which);
  const auto given = lidar.ask(wanted.how);
  if (!given) {
    if (!given.error().is_fatal()) {
      writer.write(wanted, before, read_setting(lidar, wanted.which));
    }
    throw failure(given.error());
  }
  writer.write(wanted, before, *given);
  return before;
}

/// What is good to know about what has been set.
void tell_notes(const std::vector<wish>& wishes) {
  tell("A G4 may forget this when it restarts or has no power.\n");
  const bool is_protected = std::any_of(wishes.begin(), wishes.end(), [](const wish& each) {
    return each.value == g4lidar::answer(g4lidar::power_down_protection::on);
  });
  if (is_protected) {
    tell(
        "With protection on it stops 3 s after the last A5 60: dump and scan feed it, start does "
        "not.\n");
  }
}

int set(const set_options& options) {
  if (options.wishes.empty()) throw bad_value("say what to set, such as rate=9k");
  output out("-");
  talking_source source(*options.common, g4lidar::task::configuring);
  settings_writer writer(out, *options.json);
  for (const wish& each : options.wishes) {
    if (interrupt() != 0) return 128 + interrupt();
    carry_out(source.lidar(), each, writer);
  }
  out.commit();
  tell_notes(options.wishes);
  return static_cast<int>(exit_code::ok);
}

constexpr const char* details =
    R"(  rate=4k|8k|9k       measurements a second (also 4000, 8000, 9000)
  freq=5..12          revolutions a second, in steps of 0.1
  direction=cw|ccw    which way it turns, seen from above
  constant=on|off     whether it holds its frequency
  idle=on|off         whether the motor rests while it does not scan (also low-power=)
  protection=on|off   whether it stops 3 s after its host has fallen silent

Nothing is set before all words have been understood. Each setting is read, set, and read back: a
line with NAME, BEFORE and AFTER, or with --json an object with name, before, wanted, after. A G4
can be asked for neither constant nor protection: what they were before is unknown, what they are
is what it answered. Where the device refuses, AFTER is how far it went, what follows is not set,
and the exit code is 8.

A device that is found scanning is stopped first; that is told. A G4 may forget its settings when it
restarts or has no power.)";

}  // namespace

verb make_set_verb() {
  const auto options = std::make_shared<set_options>();
  verb made;
  made.name = "set";
  made.summary = "Settings, each shown before and after";
  argument_row source = source_argument(options->common);
  source.help = "The lidar (the only G4)";
  source.take = [options, as_source = source.take](const std::string& word) {
    is_wish(word) ? add_wish(*options, word) : as_source(word);
  };
  made.arguments.push_back(std::move(source));
  made.arguments.push_back(
      {.name = "NAME=VALUE",
       .help = "What to set, one or more",
       .take = [options](const std::string& word) { add_wish(*options, word); },
       .repeatable = true});
  made.options.push_back(json_row(options->json));
  append(made.options, device_rows(options->common));
  made.details = details;
  made.examples = {"g4-dump set rate=9k freq=10", "g4-dump set /dev/ttyUSB0 protection=on",
                   "g4-dump set sim: rate=4k freq=7.5 direction=ccw --json"};
  made.exits = talk_exits();
  made.run = [options] { return set(*options); };
  return made;
}

}  // namespace g4_dump
