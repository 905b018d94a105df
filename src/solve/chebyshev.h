#pragma once
// Chebyshev iteration (Golub & Varga 1961) as a smoother: damps the part of the spectrum of D^-1 A in
// [largest / ratio, largest]. Needs matrix-vector products only, so it runs at memory speed on any thread count and
// gives the same bits on all of them.

namespace monolith {

struct ChebyshevRange {
  float largest = 2.0f;
  float ratio = 6.0f;
};

// Coefficients of the recurrence: first correction d = scale * D^-1 r, then d = keep * d + scale * D^-1 r.
class ChebyshevRecurrence {
 public:
  explicit ChebyshevRecurrence(const ChebyshevRange& range) {
    const float smallest = range.largest / range.ratio;
    const float theta = 0.5f * (range.largest + smallest);
    delta_ = 0.5f * (range.largest - smallest);
    sigma_ = theta / delta_;
    rho_ = 1.0f / sigma_;
    scale_ = 1.0f / theta;
  }
  void next() {
    const float rho = 1.0f / (2.0f * sigma_ - rho_);
    keep_ = rho * rho_;
    scale_ = 2.0f * rho / delta_;
    rho_ = rho;
  }
  float keep() const { return keep_; }
  float scale() const { return scale_; }

 private:
  float delta_, sigma_, rho_, scale_, keep_ = 0.0f;
};

}  // namespace monolith
