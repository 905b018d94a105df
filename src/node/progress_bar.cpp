#include "node/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>

namespace monolith {
namespace {

constexpr int kWidth = 40;
constexpr auto kRedraw = std::chrono::milliseconds(200);

}  // namespace

ProgressBar::ProgressBar(double duration) : duration_(duration), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputc('\n', stderr);
}

void ProgressBar::show(double elapsed, double real_time_factor) {
  const double fraction = std::clamp(elapsed / duration_, 0.0, 1.0);
  const int tenth = static_cast<int>(10.0 * fraction + 1e-9);
  const auto now = std::chrono::steady_clock::now();
  if (terminal_ && (now - last_draw_ >= kRedraw || tenth == 10)) {
    last_draw_ = now;
    draw(fraction, elapsed, real_time_factor);
  } else if (!terminal_ && tenth > last_tenth_) {
    std::fprintf(stderr, "simulated %.2f of %.2f s (%d %%), %.2f x real time\n", elapsed, duration_, 10 * tenth,
                 real_time_factor);
  }
  last_tenth_ = tenth;
}

void ProgressBar::draw(double fraction, double elapsed, double real_time_factor) {
  const int filled = static_cast<int>(kWidth * fraction);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '-');
  std::fprintf(stderr, "\r[%s] %3d %%  %.2f of %.2f s  %.2f x real time ", bar.c_str(),
               static_cast<int>(100.0 * fraction), elapsed, duration_, real_time_factor);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace monolith
