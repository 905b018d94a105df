#pragma once
// How far a series of runs is, on stderr: a bar on a terminal, elsewhere a line for each run.

#include <chrono>
#include <string>

namespace monolith {

class RunProgress {
 public:
  explicit RunProgress(int runs);
  void begin(const std::string& what);
  void show(double part);  // of the present run, 0 to 1
  // Clears the bar, for results to be printed.
  void end();

 private:
  void draw(double part);

  int runs_;
  int done_ = 0;
  bool terminal_;
  std::string what_;
  std::chrono::steady_clock::time_point last_draw_{};
};

}  // namespace monolith
