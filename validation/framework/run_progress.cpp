#include "framework/run_progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace monolith {
namespace {

constexpr int kWidth = 30;
constexpr auto kRedraw = std::chrono::milliseconds(200);

}  // namespace

RunProgress::RunProgress(int runs) : runs_(runs), terminal_(isatty(STDERR_FILENO) != 0) {}

void RunProgress::begin(const std::string& what) {
  what_ = what;
  if (terminal_) {
    draw(0.0);
  } else {
    std::fprintf(stderr, "run %d of %d: %s\n", done_ + 1, runs_, what_.c_str());
  }
}

void RunProgress::show(double part) {
  const auto now = std::chrono::steady_clock::now();
  if (terminal_ && now - last_draw_ >= kRedraw) draw(part);
}

void RunProgress::end() {
  ++done_;
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void RunProgress::draw(double part) {
  last_draw_ = std::chrono::steady_clock::now();
  const int filled = static_cast<int>(kWidth * std::clamp(part, 0.0, 1.0));
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '-');
  std::fprintf(stderr, "\r\033[K%d/%d [%s] %s", done_ + 1, runs_, bar.c_str(), what_.c_str());
  std::fflush(stderr);
}

}  // namespace monolith
