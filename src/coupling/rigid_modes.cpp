#include "coupling/rigid_modes.h"

#include <algorithm>

#include "solve/kernel_work.h"

namespace monolith {
namespace {

// Below this viscous number what a cycle leaves is no more than the mass.
constexpr double kLeastNumber = 10.0;
constexpr double kRoundOff = 1e-10;  // of the largest: a mode that moves nothing
constexpr std::size_t kRunsWorthSharing = 64;

// What the motion (velocity, rotation) gives axis a at offset x: the part that does not change along the x-axis, and
// the change.
std::pair<double, double> alongRun(const Eigen::Matrix<double, 6, 1>& motion, int a, const Eigen::Vector3d& first) {
  const Eigen::Vector3d v = motion.head<3>(), w = motion.tail<3>();
  const double slope = a == 1 ? w[2] : a == 2 ? -w[1] : 0.0;
  return {v[a] + w.cross(first)[a], slope};
}

}  // namespace

RigidModes::Drift RigidModes::makeDrift(int number, const std::vector<std::int32_t>& numbers,
                                        const Eigen::VectorXd& scale) const {
  const StepProblem& p = *problem_;
  const Lattice& l = p.grid.lattice;
  Eigen::AlignedBox3i box;
  for (const PressureRegion& liquid : p.regions) {
    if (liquid.drift != number) continue;
    for (const PressureRegion::Run& run : liquid.runs) {
      for (const std::ptrdiff_t c : {run.begin, run.end - 1}) {
        const std::array<int, 3> at = l.cell(c);
        box.extend(Eigen::Vector3i(at[0], at[1], at[2]));
      }
    }
  }
  const Eigen::Vector3d low = p.grid.cellCenter(box.min()[0], box.min()[1], box.min()[2]);
  const Eigen::Vector3d high = p.grid.cellCenter(box.max()[0], box.max()[1], box.max()[2]);
  const Eigen::Vector3d centre = 0.5 * (low + high);
  const double size = std::max(0.5 * (high - low).norm(), p.grid.h);
  Drift out;
  out.step = p.grid.h / size;
  const auto end = [&](int axis) { return std::min(box.max()[axis] + 2, l.faceEnd(axis)); };
  for (int a = 0; a < 3; ++a) {
    for (int k = box.min()[2]; k < end(2); ++k) {
      for (int j = box.min()[1]; j < end(1); ++j) {
        bool before = false;
        for (int i = box.min()[0]; i < end(0); ++i) {
          const auto f = l.index(i, j, k);
          const bool at_it = numbers[f] == number || numbers[f - l.stride[a]] == number;
          const bool here = at_it && p.coefficients.mass[a][f] > 0.0;
          if (here && !before) out.faces[a].push_back({f, f, (p.grid.faceCenter(a, i, j, k) - centre) / size});
          if (here) out.faces[a].back().end = f + 1;
          before = here;
        }
      }
    }
  }
  std::vector<char> in_it(p.bodies->size(), 0);
  for (const BodyRow& row : p.rows.divergence) {
    if (numbers[row.sample] == number) in_it[row.body] = 1;
  }
  for (const BodyCoordinates::Assembly& assembly : p.coordinates.assemblies()) {
    const bool inside = std::any_of(assembly.bodies.begin(), assembly.bodies.end(), [&](int b) { return in_it[b]; });
    if (!inside || !assembly.adrift) continue;
    // v = v_c + w x (x - c)/size, and the body turns with w/size.
    Eigen::Matrix<double, Eigen::Dynamic, 6> unknowns(assembly.count, 6);
    for (int q = 0; q < 6; ++q) {
      std::vector<Vector6d> twists(p.bodies->size(), Vector6d::Zero());
      for (const int b : assembly.bodies) {
        const Eigen::Vector3d x = ((*p.bodies)[b].p_WBcm - centre) / size;
        if (q < 3) {
          twists[b][q] = 1.0;
        } else {
          twists[b].head<3>() = Eigen::Vector3d::Unit(q - 3).cross(x);
          twists[b][q] = 1.0 / size;
        }
      }
      unknowns.col(q) = p.coordinates.gatherMotion(twists).segment(assembly.first, assembly.count);
    }
    out.bodies.emplace_back(assembly.first, scale.segment(assembly.first, assembly.count).asDiagonal() * unknowns);
  }
  return out;
}

template <class Real>
RigidModes::Amplitudes RigidModes::project(const Drift& drift, const std::vector<Real>& r) const {
  const std::size_t size = problem_->grid.lattice.size;
  Amplitudes out = Amplitudes::Zero();
  for (int a = 0; a < 3; ++a) {
    const std::vector<Run>& runs = drift.faces[a];
    const Real* field = r.data() + a * size;
    std::vector<std::pair<double, double>> sums(runs.size());  // and of the moments along x
#pragma omp parallel for schedule(static) if (runs.size() >= kRunsWorthSharing)
    for (std::size_t n = 0; n < runs.size(); ++n) {
      const Real* from = field + runs[n].begin;
      const auto count = static_cast<int>(runs[n].end - runs[n].begin);
      Real sum = 0, moment = 0;
#pragma omp simd reduction(+ : sum, moment)
      for (int i = 0; i < count; ++i) {
        sum += from[i];
        moment += static_cast<Real>(i) * from[i];
      }
      sums[n] = {sum, drift.step * static_cast<double>(moment)};
    }
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(a);
    for (std::size_t n = 0; n < runs.size(); ++n) {
      out[a] += sums[n].first;
      // w . (x cross e_a)
      out.tail<3>() +=
          runs[n].first.cross(axis) * sums[n].first + Eigen::Vector3d::UnitX().cross(axis) * sums[n].second;
    }
  }
  for (const auto& [first, unknowns] : drift.bodies) {
    using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
    const Eigen::Map<const Vector> force(r.data() + 4 * size + first, unknowns.rows());
    out += unknowns.transpose() * force.template cast<double>();
  }
  return out;
}

template <class Real>
void RigidModes::add(const Drift& drift, const Amplitudes& amplitudes, std::vector<Real>& z) const {
  const std::size_t size = problem_->grid.lattice.size;
  for (int a = 0; a < 3; ++a) {
    const std::vector<Run>& runs = drift.faces[a];
    Real* field = z.data() + a * size;
#pragma omp parallel for schedule(static) if (runs.size() >= kRunsWorthSharing)
    for (std::size_t n = 0; n < runs.size(); ++n) {
      const auto [at_first, slope] = alongRun(amplitudes, a, runs[n].first);
      const auto constant = static_cast<Real>(at_first), change = static_cast<Real>(slope * drift.step);
      Real* to = field + runs[n].begin;
      const auto count = static_cast<int>(runs[n].end - runs[n].begin);
#pragma omp simd
      for (int i = 0; i < count; ++i) to[i] += constant + change * static_cast<Real>(i);
    }
  }
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  for (const auto& [first, unknowns] : drift.bodies) {
    Eigen::Map<Vector>(z.data() + 4 * size + first, unknowns.rows()) += (unknowns * amplitudes).template cast<Real>();
  }
}

void RigidModes::findEnergies(const Apply& apply, std::size_t size) {
  const Lattice& l = problem_->grid.lattice;
  std::vector<double> x(size), y(size);
  std::vector<Matrix6d> energy(drifts_.size());
  for (int q = 0; q < 6; ++q) {
    std::fill(x.begin(), x.end(), 0.0);
    for (const Drift& drift : drifts_) add(drift, Amplitudes::Unit(q), x);
    apply(x, y);
    for (std::size_t i = 0; i < drifts_.size(); ++i) energy[i].col(q) = project(drifts_[i], y);
  }
  // Around a periodic axis nothing turns.
  std::vector<int> used = {0, 1, 2};
  for (int q = 0; q < 3; ++q) {
    if (!l.periodic[(q + 1) % 3] && !l.periodic[(q + 2) % 3]) used.push_back(3 + q);
  }
  for (std::size_t i = 0; i < drifts_.size(); ++i) {
    Eigen::MatrixXd part = energy[i](used, used);
    part = (0.5 * (part + part.transpose())).eval();
    part.diagonal().array() += kRoundOff * part.diagonal().maxCoeff();
    const Eigen::LLT<Eigen::MatrixXd> factor(part);
    if (factor.info() != Eigen::Success) continue;  // no correction
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(part.rows(), part.cols());
    const Eigen::MatrixXd inverse = factor.solve(identity);
    drifts_[i].inverse(used, used) = inverse;
  }
}

void RigidModes::set(const StepProblem& problem, const Eigen::VectorXd& scale, const Apply& apply) {
  problem_ = &problem;
  drifts_.clear();
  int count = 0;
  for (const PressureRegion& liquid : problem.regions) count = std::max(count, liquid.drift + 1);
  if (problem.viscous_number < kLeastNumber || count == 0) return;
  const Lattice& l = problem.grid.lattice;
  std::vector<std::int32_t> numbers(l.size, -1);
  for (const PressureRegion& liquid : problem.regions) {
    if (liquid.drift < 0) continue;
    for (const PressureRegion::Run& run : liquid.runs) {
      std::fill(numbers.begin() + run.begin, numbers.begin() + run.end, liquid.drift);
    }
  }
  fillHalo(l, numbers);
  for (int number = 0; number < count; ++number) drifts_.push_back(makeDrift(number, numbers, scale));
  findEnergies(apply, 4 * l.size + static_cast<std::size_t>(scale.size()));
}

void RigidModes::correct(const std::vector<float>& r, std::vector<float>& z) const {
  for (const Drift& drift : drifts_) {
    std::size_t faces = 0;
    for (const auto& runs : drift.faces) {
      for (const Run& run : runs) faces += static_cast<std::size_t>(run.end - run.begin);
    }
    countWork(faces, 6.0, 3.0 * sizeof(float));
    add(drift, drift.inverse * project(drift, r), z);
  }
}

}  // namespace monolith
