#pragma once
// Anderson acceleration (1965, J. ACM 12, 547; Walker & Ni 2011, SIAM J. Numer. Anal. 49, 1715) of a fixed point
// y = G(y): with f_k = G(y_k) - y_k and the differences dY, dF of the last few iterates,
//   theta = argmin |f_k - dF theta|_w,    y_{k+1} = y_k + damping f_k - (dY + damping dF) theta.
// Same bits at any thread count.

#include <vector>

namespace monolith {

class Anderson {
 public:
  // depth: iterates kept. damping in (0, 1]: makes y + damping f a contraction where G alone is none.
  Anderson(int depth, double damping) : depth_(depth), damping_(damping) {}

  // y: y_k on entry, y_{k+1} on return. image: G(y_k). weight: squared, one per entry, >= 0.
  void advance(const std::vector<double>& image, const std::vector<double>& weight, std::vector<double>& y);
  // The next step is a plain damped one.
  void forget();

 private:
  int depth_;
  double damping_;
  std::vector<double> last_y_, last_f_;
  std::vector<std::vector<double>> dy_, df_;
};

}  // namespace monolith
