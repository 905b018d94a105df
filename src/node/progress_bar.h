#pragma once
// How far a bounded run is, on stderr: a bar on a terminal, elsewhere a line every tenth.

#include <chrono>

namespace monolith {

class ProgressBar {
 public:
  explicit ProgressBar(double duration);  // s, simulated
  // Ends the bar's line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(double elapsed, double real_time_factor);

 private:
  void draw(double fraction, double elapsed, double real_time_factor);

  double duration_;
  bool terminal_;
  bool drawn_ = false;
  int last_tenth_ = 0;
  std::chrono::steady_clock::time_point last_draw_{};
};

}  // namespace monolith
