#include "solve/rounded_vector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solve/kernel_work.h"

namespace monolith {
namespace {

constexpr float kMost = std::numeric_limits<std::int16_t>::max();
// Smaller ones are none: their scale would have no inverse.
constexpr float kLeast = 1e-30F;
// A number below 2^22 that is added and taken away again has been rounded to a whole one.
constexpr float kRounding = 12582912.0F;

// Rounds a group to whole numbers times what is returned, their scale.
float round(float* x, std::ptrdiff_t size, std::int16_t* values) {
  float most = 0.0F;
  int wrong = 0;
#pragma omp simd reduction(max : most) reduction(| : wrong)
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    const float size_of = std::abs(x[i]);
    wrong |= size_of <= std::numeric_limits<float>::max() ? 0 : 1;
    most = most < size_of ? size_of : most;
  }
  const float scale = wrong != 0 ? std::numeric_limits<float>::quiet_NaN() : most < kLeast ? 0.0F : most / kMost;
  const float inverse = scale > 0.0F ? kMost / most : 0.0F;
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    const float whole = wrong != 0 ? 0.0F : (x[i] * inverse + kRounding) - kRounding;
    values[i] = static_cast<std::int16_t>(whole);
    x[i] = scale * whole;
  }
  return scale;
}

}  // namespace

void RoundedVector::take(const Parts& parts, std::ptrdiff_t rest, std::vector<float>& x) {
  first_.clear();
  std::ptrdiff_t groups = 0;
  for (const Part& part : parts) {
    if (part.begin >= rest) break;
    first_.push_back(groups);
    groups += (part.end - part.begin + kGroup - 1) / kGroup;
  }
  values_.resize(static_cast<std::size_t>(groups * kGroup));
  scales_.resize(static_cast<std::size_t>(groups));
  rest_.assign(x.begin() + std::min(rest, static_cast<std::ptrdiff_t>(x.size())), x.end());
  countWork(values_.size(), 5.0, 2.0 * sizeof(float) + bytes());
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < first_.size(); ++p) {
    std::ptrdiff_t group = first_[p];
    for (std::ptrdiff_t begin = parts[p].begin; begin < parts[p].end; begin += kGroup, ++group) {
      const std::ptrdiff_t size = std::min(kGroup, parts[p].end - begin);
      scales_[group] = round(x.data() + begin, size, values_.data() + group * kGroup);
    }
  }
}

void RoundedVector::addTo(const Parts& parts, std::size_t part, double a, double* y) const {
  const std::ptrdiff_t length = parts[part].end - parts[part].begin;
  if (part >= first_.size()) {
    const float* from = rest_.data() + (parts[part].begin - parts[first_.size()].begin);
    for (std::ptrdiff_t i = 0; i < length; ++i) y[i] += a * from[i];
    return;
  }
  const std::int16_t* values = values_.data() + first_[part] * kGroup;
  const float* scales = scales_.data() + first_[part];
  for (std::ptrdiff_t begin = 0; begin < length; begin += kGroup) {
    const std::ptrdiff_t size = std::min(kGroup, length - begin);
    const float scale = scales[begin / kGroup];
#pragma omp simd
    for (std::ptrdiff_t i = begin; i < begin + size; ++i) y[i] += a * (scale * static_cast<float>(values[i]));
  }
}

}  // namespace monolith
