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
    std::vector<std::uint8_t> same(kinds.size());
    for (std::size_t i = 0; i < kinds.size(); ++i) same[i] = kinds[i] != kChanging && kinds[i] == kinds_[i];
    const auto at = [&](int index, int axis) {
      return l.periodic[axis] ? (index + kReach * l.n[axis]) % l.n[axis] : std::clamp(index, 0, l.n[axis] - 1);
    };
    for (int k = 0; k <= planes; ++k) {
      for (int j = 0; j <= rows; ++j) {
        bool all = true;
        for (int dk = -kReach; all && dk <= kReach; ++dk) {
          for (int dj = -kReach; all && dj <= kReach; ++dj) {
            all = same[at(j + dj, 1) + static_cast<std::size_t>(rows) * at(k + dk, 2)] != 0;
          }
        }
        steady_[j + static_cast<std::size_t>(rows + 1) * k] = all;
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
