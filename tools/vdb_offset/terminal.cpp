// SPDX-License-Identifier: Apache-2.0
#include "terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include "messages.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

constexpr int kInterrupts[] = {SIGINT, SIGTERM, SIGHUP};

/// Ends the process as the signal would have if it had not been caught, so that shells and scripts see it.
void end_by(int signal) {
  if (!remove_temporaries()) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // takes effect once the handler has returned
}

// All that the signal handler uses: the message before and behind the name of the input, and that name.
constexpr char kBeforeName[] = "vdb_offset: ",
               kBehindName[] = ", or another input: expected a file that stays as it is, got one that was cut short\n";
std::string lost_input;

void write_error(const char* text, std::size_t size) {
  const ssize_t ignored = ::write(STDERR_FILENO, text, size);
  static_cast<void>(ignored);
}

void end_for_lost_input(int) {
  write_error(kBeforeName, sizeof kBeforeName - 1);
  write_error(lost_input.data(), lost_input.size());
  write_error(kBehindName, sizeof kBehindName - 1);
  remove_temporaries();
  _exit(2);
}

/// What a stage does.
const char* in_words(Stage stage) {
  switch (stage) {
    case Stage::Read:
      return "reading";
    case Stage::Rasterise:
    case Stage::Sweep:
    case Stage::Gradient:
      return "computing distances";
    case Stage::Propagate:
      return "moving vertices";
    case Stage::Capture:
      return "making the surface";
    case Stage::Limit:
      return "keeping faces valid";
    case Stage::Refine:
      return "splitting faces";
    case Stage::Layers:
      return "stacking layers";
    case Stage::Measure:
      return "measuring";
    case Stage::Fill:
      return "filling";
    case Stage::Write:  // the bar has been told what to call it
      break;
  }
  return "writing";
}

}  // namespace

std::string time_in_words(double seconds) {
  constexpr long kMinute = 60, kHour = 60 * kMinute;
  constexpr double kShort = 10;  // seconds
  if (seconds < kShort) return fmt::format("{:.1f} s", seconds);
  const auto all = std::lround(seconds);
  if (all >= kHour) return fmt::format("{} h {:02} min", all / kHour, all % kHour / kMinute);
  if (all >= kMinute) return fmt::format("{} min {:02} s", all / kMinute, all % kMinute);
  return fmt::format("{} s", all);
}

ProgressBar::ProgressBar(bool wanted) : active_(wanted && isatty(STDERR_FILENO)) {}
ProgressBar::~ProgressBar() { clear(); }

double ProgressBar::share_of_run(Stage stage, double share) const {
  if (stage == Stage::Read) return share * read_until_;
  if (stage == Stage::Write) return work_until_ + (1 - work_until_) * share;
  const auto [from, to] = work_part_;
  return read_until_ + (work_until_ - read_until_) * (from + (to - from) * share);
}

std::string ProgressBar::time_left(double share) {
  const double now = std::chrono::duration<double>(Clock::now() - begun_).count();
  shares_.emplace_back(now, share);
  while (shares_.size() > 2 && shares_[1].first < now / 2) shares_.pop_front();
  const auto [then, share_then] = shares_.front();
  constexpr double kEarly = 1;  // second
  if (now < kEarly || !(share > share_then)) return {};
  return fmt::format(", {} left", time_in_words((1 - share) * (now - then) / (share - share_then)));
}

void ProgressBar::show(Stage stage, double share) {
  if (!active_) return;
  constexpr int kWidth = 40;  // characters
  const double of_run = shown_share_ = std::max(shown_share_, share_of_run(stage, share));
  const int filled = static_cast<int>(of_run * kWidth);
  std::string line =
      fmt::format("[{:#<{}}{:.<{}}] {:3.0f} %  {}{}", "", filled, "", kWidth - filled, std::floor(100 * of_run),
                  stage == Stage::Write ? writing_ : in_words(stage), time_left(of_run));
  if (line == shown_) return;
  print(fmt::format("\r{:{}}", line, shown_.size()));
  shown_ = std::move(line);
}

void ProgressBar::clear() {
  if (!shown_.empty()) print(fmt::format("\r{:{}}\r", "", shown_.size()));
  shown_.clear();
}

// If the terminal has been closed, nothing more is drawn, and the run goes on.
void ProgressBar::print(const std::string& text) {
  active_ = std::fwrite(text.data(), 1, text.size(), stderr) == text.size() && std::fflush(stderr) == 0;
}

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = end_by;
  for (const int signal : kInterrupts) sigaddset(&action.sa_mask, signal);
  for (const int signal : kInterrupts) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN)
      sigaction(signal, &action, nullptr);  // signals that nohup or a shell ignores stay ignored
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a file that is too large is then an error of writing like any other
}

void ignore_interrupts() {
  for (const int signal : kInterrupts) std::signal(signal, SIG_IGN);
}

void report_lost_input(const std::string& path) {
  lost_input = readable(path);
  std::signal(SIGBUS, end_for_lost_input);
}

}  // namespace vdb_offset::tool
