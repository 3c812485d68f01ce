// SPDX-License-Identifier: MIT
#define NCURSES_NOMACROS 1  // NOLINT: of ncurses, whose macros are names such as move
#include "screen.hpp"

#include <curses.h>
#include <langinfo.h>
#include <poll.h>
#include <pthread.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <csignal>
#include <cstdlib>
#include <string>
#include <string_view>

#include "cli/exit_code.hpp"

namespace g4_tool {
namespace {

/// Signals of which the program handles the first one.
constexpr std::array ending_signals{SIGINT, SIGTERM, SIGHUP};
/// Signals that do not end a program, or cannot be handled. All others end it at once.
constexpr std::array other_signals{SIGKILL, SIGSTOP, SIGCHLD, SIGCONT, SIGTSTP,
                                   SIGTTIN, SIGTTOU, SIGURG,  SIGWINCH};
/// Signals of a fault of the program, whose handlers (of a sanitizer) end it, too.
constexpr std::array fault_signals{SIGILL, SIGTRAP, SIGABRT, SIGBUS, SIGFPE, SIGSEGV, SIGSYS};
constexpr int signal_count = NSIG;  // from 1 on, with the real-time ones

template <std::size_t Count>
bool is_in(const std::array<int, Count>& all, int number) {
  return std::ranges::find(all, number) != all.end();
}

/// The data of the signal handlers, prepared by the constructor.
struct restoring {
  std::array<char, 256> words;
  std::size_t size;
  termios before;
  std::array<struct sigaction, signal_count> actions;  // as they were, by signal
  std::array<bool, signal_count> is_handled;
};
restoring saved{};
volatile std::sig_atomic_t is_ending = 0;
sigset_t mask_before{};

/// The control sequence of a capability; empty if the terminal has none.
std::string_view sequence_of(const char* capability) {
  const char* const word = ::tigetstr(capability);
  const bool is_none = word == nullptr || word == reinterpret_cast<const char*>(-1);  // NOLINT
  return is_none ? std::string_view() : std::string_view(word);
}

void add_sequence(const char* capability) {
  const std::string_view text = sequence_of(capability);
  if (saved.size + text.size() > saved.words.size()) return;
  std::ranges::copy(text, saved.words.begin() + static_cast<std::ptrdiff_t>(saved.size));
  saved.size += text.size();
}

void restore() noexcept {
  [[maybe_unused]] const auto ignored = ::write(STDOUT_FILENO, saved.words.data(), saved.size);
  ::tcsetattr(STDOUT_FILENO, TCSANOW, &saved.before);
}

void restore_and_raise(int number) {
  restore();
  std::signal(number, SIG_DFL);
  ::raise(number);
}

/// Passes the first signal to the handler of the program; a second one ends the program.
void handle_ending_signal(int number) {
  if (is_ending != 0) return restore_and_raise(number);
  is_ending = 1;
  const auto before = saved.actions[static_cast<std::size_t>(number)].sa_handler;
  before == SIG_DFL ? restore_and_raise(number) : before(number);
}

/// Before each signal that ends the program. What is ignored (as under nohup) remains so, and what has a handler that
/// need not end the program (of a profiler).
void handle_signals() {
  for (int number = 1; number < signal_count; ++number) {
    struct sigaction& before = saved.actions[static_cast<std::size_t>(number)];
    bool& is_handled = saved.is_handled[static_cast<std::size_t>(number)];
    is_handled = false;
    if (is_in(other_signals, number) || ::sigaction(number, nullptr, &before) != 0) continue;
    const bool ends_later = is_in(ending_signals, number);
    const bool is_free = before.sa_handler == SIG_DFL || ends_later || is_in(fault_signals, number);
    if (before.sa_handler == SIG_IGN || !is_free) continue;
    struct sigaction action{};
    action.sa_handler = ends_later ? handle_ending_signal : restore_and_raise;
    action.sa_flags = SA_NODEFER;
    is_handled = ::sigaction(number, &action, nullptr) == 0;
  }
}

/// By ink: the attribute, and the colour on terminals that have colours (-1: the default).
constexpr std::array<std::pair<attr_t, short>, ink_count> looks{{{A_NORMAL, -1},
                                                                 {A_DIM, -1},
                                                                 {A_DIM, COLOR_CYAN},
                                                                 {A_NORMAL, COLOR_GREEN},
                                                                 {A_NORMAL, COLOR_GREEN},
                                                                 {A_BOLD, COLOR_YELLOW},
                                                                 {A_BOLD, COLOR_RED},
                                                                 {A_BOLD, -1}}};

void set_look(ink what) {
  const auto at = static_cast<std::size_t>(what);
  const short pair =
      ::has_colors() && looks[at].second >= 0 ? static_cast<short>(at + 1) : short{0};
  ::attr_set(looks[at].first, pair, nullptr);
}

}  // namespace

screen::screen(bool colored) {
  const char* const name = std::getenv("TERM");
  const bool has_terminal = ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0 &&
                            ::tcgetattr(STDOUT_FILENO, &saved.before) == 0;
  if (!has_terminal) {
    throw failure(exit_code::usage,
                  "view needs a terminal. With --once it prints one picture to any output.");
  }
  SCREEN* const made = name == nullptr ? nullptr : ::newterm(name, stdout, stdin);
  const bool can_move = name != nullptr && !sequence_of("cup").empty();  // also if newterm() failed
  if (made == nullptr) {
    throw failure(exit_code::usage,
                  can_move ? "the screen cannot be prepared: is the terminal too large? Make it "
                             "smaller, or use --once."
                           : "the type of this terminal is not known. Set TERM, or use --once.");
  }
  if (!can_move) {
    ::endwin();
    ::delscreen(made);
    throw failure(exit_code::usage, "a terminal of the type " + std::string(name) +
                                        " cannot move its cursor. Set TERM, or use --once.");
  }
  saved.size = 0;
  for (const char* word : {"sgr0", "op", "rmkx", "cnorm", "rmcup"}) add_sequence(word);
  is_ending = 0;
  handle_signals();
  ::cbreak();
  ::noecho();
  ::nonl();
  ::curs_set(0);
  ::nodelay(::stdscr, true);
  ::keypad(::stdscr, true);
  if (!colored || !::has_colors()) return;
  ::start_color();
  ::use_default_colors();
  for (std::size_t i = 0; i < looks.size(); ++i) {
    ::init_pair(static_cast<short>(i + 1), looks[i].second, -1);
  }
}

screen::~screen() {
  ::endwin();
  for (int number = 1; number < signal_count; ++number) {
    const bool stays =
        is_ending != 0 && is_in(ending_signals, number);  // a second one ends the program
    if (!saved.is_handled[static_cast<std::size_t>(number)] || stays) continue;
    ::sigaction(number, &saved.actions[static_cast<std::size_t>(number)], nullptr);
  }
}

int screen::columns() const { return ::getmaxx(::stdscr); }
int screen::rows() const { return ::getmaxy(::stdscr); }

void screen::show(const canvas& picture) {
  ::erase();
  std::string words;
  for (int row = 0; row < picture.rows(); ++row) {
    ::move(row, 0);
    for (int column = 0; column < picture.columns();) {
      const ink what = picture.at(column, row).what;
      words.clear();
      for (; column < picture.columns(); ++column) {
        const canvas_cell cell = picture.at(column, row);
        if (cell.glyph != U' ' && cell.what != what) break;
        add_utf8(words, cell.glyph);
      }
      set_look(what);
      ::addstr(words.c_str());
    }
  }
  ::refresh();
}

int screen::key() {
  const int pressed = ::getch();
  if (pressed == KEY_RESIZE) return resized;
  return pressed > resized && pressed < 0x80 ? pressed : 0;
}

bool screen::is_gone() const {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  return ::poll(&input, 1, 0) > 0 && (input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

bool screen::has_utf8() {
  std::setlocale(LC_CTYPE, "");
  return std::string_view(::nl_langinfo(CODESET)) == "UTF-8";
}

blocked_signals::blocked_signals() {
  sigset_t all{};
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &mask_before);
}
blocked_signals::~blocked_signals() { ::pthread_sigmask(SIG_SETMASK, &mask_before, nullptr); }

}  // namespace g4_tool
