#include "solve/steady_rows.h"

#include <algorithm>

namespace monolith {
namespace {

// How far a row's coefficients look: what is built from what is built from coefficients that are built from cells and
// faces around.
constexpr int kReach = 4;

}  // namespace

void SteadyRows::update(const Lattice& l, const std::vector<std::uint8_t>& kinds,
                        const std::vector<double>& parameters) {
  const bool comparable = known_ && l.n == lattice_.n && l.periodic == lattice_.periodic && parameters == parameters_;
  lattice_ = l;
  parameters_ = parameters;
  ++generation_;
  const int rows = l.n[1], planes = l.n[2];
  steady_.assign(static_cast<std::size_t>(rows + 1) * (planes + 1), 0);
  if (comparable) {
    const auto at = [&](int index, int axis) {
      return l.periodic[axis] ? (index + kReach * l.n[axis]) % l.n[axis] : std::clamp(index, 0, l.n[axis] - 1);
    };
    // Along one axis after the other.
    std::vector<std::uint8_t> same(kinds.size()), along(static_cast<std::size_t>(rows + 1) * planes, 1);
    for (std::size_t i = 0; i < kinds.size(); ++i) same[i] = kinds[i] != kChanging && kinds[i] == kinds_[i];
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j <= rows; ++j) {
        for (int d = -kReach; d <= kReach; ++d) {
          along[j + static_cast<std::size_t>(rows + 1) * k] &= same[at(j + d, 1) + static_cast<std::size_t>(rows) * k];
        }
      }
    }
    std::fill(steady_.begin(), steady_.end(), 1);
    for (int k = 0; k <= planes; ++k) {
      for (int d = -kReach; d <= kReach; ++d) {
        const std::uint8_t* from = along.data() + static_cast<std::size_t>(rows + 1) * at(k + d, 2);
        std::uint8_t* to = steady_.data() + static_cast<std::size_t>(rows + 1) * k;
        for (int j = 0; j <= rows; ++j) to[j] &= from[j];
      }
    }
  }
  kinds_ = kinds;
  known_ = true;
}

void SteadyRows::forget() {
  known_ = false;
  // Two generations on, so that nothing that was built is taken for the last one's.
  generation_ += 2;
  std::fill(steady_.begin(), steady_.end(), 0);
}

}  // namespace monolith
