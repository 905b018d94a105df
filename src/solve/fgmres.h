#pragma once
// Flexible GMRES (Saad 1993, SIAM J. Sci. Comput. 14, 461), right preconditioned, inside iterative refinement: the
// residual b - A x is formed in double precision at each restart and kept in single, the correction is found on vectors
// half as wide as x. b stays with whoever forms the residual; x may lie in pieces. Keeping the directions P^-1 v beside
// the basis costs memory and pays: the operator sees their rounding, where a correction P^-1 (V y) formed at the end
// carries that of a large, smooth pressure into the solution. As it does, 16 bits an entry are enough for them
// (rounded_vector.h). Where single precision ends short of the goal, the cycles that follow are in double; the
// preconditioner stays single. Minimises |b - A x|_2 over each cycle; the residual that
// it reports is the recomputed one.

#include <Eigen/Dense>
#include <functional>
#include <limits>
#include <type_traits>
#include <vector>

#include "solve/blocked_sum.h"
#include "solve/rounded_vector.h"
#include "solve/split_vector.h"

namespace monolith {

struct KrylovOptions {
  double absolute_tolerance = 0.0;  // on |b - A x|_2
  double relative_tolerance = 0.0;  // or so much of what it is at first, if that is more
  // Unless the guess is as close as this, too, there is one iteration at least.
  double guess_tolerance = std::numeric_limits<double>::infinity();
  int maximum_iterations = 200;
  // Directions kept. Cycles are short, which takes little memory and less to orthogonalise, until one gains too little:
  // those after it are twice as long.
  int shortest_cycle = 12;
  int longest_cycle = 60;
};

struct KrylovReport {
  bool converged = false;
  int iterations = 0;
  double initial_residual = 0.0;
  double residual = 0.0;  // |b - A x|_2, recomputed
};

// What is to be solved. x may be changed where that doesn't change A x (halos). Entries that are no unknowns need not
// be written: they are zero before.
struct KrylovMaps {
  std::size_t size = 0;                                                       // entries
  double right_norm = 0.0;                                                    // |b|_2
  std::function<void(const SplitVector& x, std::vector<float>& r)> residual;  // r = b - A x
  std::function<void(std::vector<double>& x, std::vector<double>& y)> apply;  // y = A x, where double is needed
  std::function<void(std::vector<float>& x, std::vector<float>& y)> apply_single;
  std::function<void(std::vector<float>& x, std::vector<float>& y)> precondition;
  // Where solve() is told to go on from the call before. Entries from `rest` on are those in which the right side, and
  // of which the guess, may have changed since; the others of A x do not depend on them. May be missing.
  std::size_t rest = 0;
  // All entries before `rest` that may be unknowns, no part across pieces of x.
  Parts parts{};
  std::function<void(const SplitVector& x, std::vector<float>& r)> residual_rest{};    // these entries of b - A x
  std::function<void(const std::vector<float>& x, std::vector<float>& y)> complete{};  // these entries of P^-1 x
};

// What the last call, with the same maps, has left for solve().
enum class KrylovPast {
  kNothing,
  kResidual,   // the residual, but for its rest
  kDirection,  // from firstDirection(): it and the first direction, but for their rest
};

class Fgmres {
 public:
  // x holds the initial guess on entry, the solution on return. Work space is kept between calls.
  [[nodiscard]] KrylovReport solve(const KrylovMaps& maps, const SplitVector& x, const KrylovOptions& options,
                                   KrylovPast past = KrylovPast::kNothing);

  // P^-1 (b - A x): where a first step would go. Valid until the next call.
  [[nodiscard]] const std::vector<float>& firstDirection(const KrylovMaps& maps, const SplitVector& x);

  // The unknowns may be others from now on than those of the solves before...
  void forget();
  // ... or lack only those of `length` entries from each of these on.
  void lose(const std::vector<std::ptrdiff_t>& begins, int length);

 private:
  // V and Z = P^-1 V.
  template <class Real>
  struct Space {
    using Direction = std::conditional_t<std::is_same_v<Real, float>, RoundedVector, std::vector<Real>>;
    std::vector<std::vector<Real>> basis;
    std::vector<Direction> directions;
    std::size_t clean = 0;  // of the basis: zero where there are no unknowns
    std::vector<Real> z;    // the newest direction; the same holds for it

    std::vector<Real>& basisRoom(std::size_t index, std::size_t size);
  };

  // How threads share vectors.
  void divide(const KrylovMaps& maps);
  // Where the next basis begins: b - A x, until a cycle scales it.
  std::vector<float>& residualRoom(const KrylovMaps& maps) { return single_.basisRoom(0, maps.size); }
  double residualNorm() const;
  double residual(const KrylovMaps& maps, const SplitVector& x);
  // The same where all of it but the rest is there.
  double completedResidual(const KrylovMaps& maps, const SplitVector& x);
  // One cycle on the residual, until it is `goal` times as large; adds to x. first_known: only a rest of the first
  // direction is missing. Returns the number of directions.
  template <class Real>
  int cycle(const KrylovMaps& maps, double norm, double goal, int most, bool first_known, Space<Real>& space,
            const SplitVector& x);
  // z = P^-1 v, or only the rest of it; kept as a direction, and w = A z.
  void extend(const KrylovMaps& maps, bool known, std::vector<float>& v, RoundedVector& kept, std::vector<float>& w);
  void extend(const KrylovMaps& maps, bool known, std::vector<double>& v, std::vector<double>& kept,
              std::vector<double>& w);

  Space<float> single_;
  Space<double> double_;  // empty unless it was needed
  Parts parts_;
  std::vector<float> v_single_;
};

}  // namespace monolith
