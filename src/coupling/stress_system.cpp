#include "coupling/stress_system.h"

namespace monolith {
namespace {

using Triplet = Eigen::Triplet<double>;

// Periodic images have the number of what they are images of.
std::vector<int> numbered(const Lattice& l, const std::vector<std::ptrdiff_t>& at) {
  std::vector<int> number(l.size, -1);
  for (std::size_t i = 0; i < at.size(); ++i) number[at[i]] = static_cast<int>(i);
  fillHalo(l, number);
  return number;
}

template <class Function>
void forEachIndex(const Lattice& l, Function&& f) {
  for (int k = 0; k < l.faceEnd(2); ++k) {
    for (int j = 0; j < l.faceEnd(1); ++j) {
      for (int i = 0; i < l.faceEnd(0); ++i) f(l.index(i, j, k));
    }
  }
}

}  // namespace

StressSystem::StressSystem(const StepProblem& problem) {
  const StaggeredCoefficients<double>& c = problem.coefficients;
  const Lattice& l = c.lattice;
  FaceField<int> face_number;
  std::vector<double> masses;
  for (int a = 0; a < 3; ++a) {
    std::vector<std::ptrdiff_t> at;
    forEachIndex(l, [&](std::ptrdiff_t f) {
      if (c.mass[a][f] > 0.0) at.push_back(f);
    });
    face_number[a] = numbered(l, at);
    const int before = static_cast<int>(faces.size());
    for (int& n : face_number[a]) n += n >= 0 ? before : 0;
    for (const auto f : at) {
      faces.push_back({a, f});
      masses.push_back(c.mass[a][f]);
    }
  }
  inverse_mass = Eigen::Map<const Eigen::VectorXd>(masses.data(), static_cast<Eigen::Index>(masses.size())).cwiseInverse();

  std::vector<Triplet> g, j;
  std::vector<double> weight;
  int row = 0;
  const auto add = [&](int axis, std::ptrdiff_t face, double value) {
    const int n = face_number[axis][face];
    if (n >= 0 && value != 0.0) g.emplace_back(row, n, value);
  };
  // Samples of one kind: their rows of G, and the number of each for the bodies' rows.
  const auto addSamples = [&](auto&& has, auto&& rows_of, const std::vector<BodyRow>& body_rows, double sign) {
    std::vector<int> number(l.size, -1);
    forEachIndex(l, [&](std::ptrdiff_t s) {
      const double w = has(s);
      if (!(w > 0.0)) return;
      rows_of(s);
      number[s] = row++;
      weight.push_back(w);
    });
    for (const BodyRow& r : body_rows) {
      const int place = problem.free_index[r.body];
      if (place < 0 || number[r.sample] < 0) continue;
      for (int d = 0; d < 6; ++d) j.emplace_back(number[r.sample], 6 * place + d, sign * r.coefficient[d]);
    }
  };
  if (c.viscous) {
    for (int a = 0; a < 3; ++a) {
      addSamples([&](std::ptrdiff_t s) { return c.normal[a][s]; },
                 [&](std::ptrdiff_t s) {
                   add(a, s + l.stride[a], 1.0);
                   add(a, s, -1.0);
                 },
                 problem.rows.normal[a], 1.0);
      addSamples([&](std::ptrdiff_t s) { return c.drag[a][s]; }, [&](std::ptrdiff_t s) { add(a, s, 1.0); },
                 problem.rows.drag[a], -1.0);
    }
    for (int p = 0; p < 3; ++p) {
      const auto [a, b] = kShearPairs[p];
      addSamples([&](std::ptrdiff_t s) { return c.shear[p][0][s] != 0.0 || c.shear[p][1][s] != 0.0 ? 1.0 : 0.0; },
                 [&, a = a, b = b](std::ptrdiff_t s) {
                   add(a, s, c.shear[p][0][s]);
                   add(a, s - l.stride[b], -c.shear[p][0][s]);
                   add(b, s, c.shear[p][1][s]);
                   add(b, s - l.stride[a], -c.shear[p][1][s]);
                 },
                 problem.rows.shear[p], 1.0);
    }
  }
  stresses = row;
  // Pressures: rows of -C, which have no weight.
  std::vector<int> number(l.size, -1);
  forEachIndex(l, [&](std::ptrdiff_t s) {
    if (!c.has_pressure[s]) return;
    for (int a = 0; a < 3; ++a) {
      add(a, s + l.stride[a], -c.open[a][s + l.stride[a]]);
      add(a, s, c.open[a][s]);
    }
    number[s] = row++;
    pressure_cells.push_back(s);
  });
  for (const BodyRow& r : problem.rows.divergence) {
    const int place = problem.free_index[r.body];
    if (place < 0) continue;
    for (int d = 0; d < 6; ++d) j.emplace_back(number[r.sample], 6 * place + d, -r.coefficient[d]);
  }

  G.resize(row, static_cast<Eigen::Index>(faces.size()));
  G.setFromTriplets(g.begin(), g.end());
  J.resize(row, problem.bodyUnknowns());
  J.setFromTriplets(j.begin(), j.end());
  inverse_weight = Eigen::VectorXd::Zero(row);
  for (Eigen::Index i = 0; i < stresses; ++i) inverse_weight[i] = 1.0 / weight[i];
  A = G * inverse_mass.asDiagonal() * G.transpose();
  // Every diagonal entry exists, also where no face is near.
  std::vector<Triplet> diagonal;
  for (Eigen::Index i = 0; i < row; ++i) diagonal.emplace_back(static_cast<int>(i), static_cast<int>(i), inverse_weight[i]);
  Sparse Wi(row, row);
  Wi.setFromTriplets(diagonal.begin(), diagonal.end());
  A += Wi;
}

Eigen::VectorXd StressSystem::faceForces(const StepVector& rhs) const {
  Eigen::VectorXd f(static_cast<Eigen::Index>(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i) f[i] = rhs.velocity[faces[i].axis][faces[i].at];
  return f;
}

Eigen::VectorXd StressSystem::flux(const StepVector& rhs) const {
  Eigen::VectorXd b = Eigen::VectorXd::Zero(unknowns());
  for (std::size_t i = 0; i < pressure_cells.size(); ++i) b[stresses + i] = rhs.pressure[pressure_cells[i]];
  return b;
}

void StressSystem::velocityAndPressure(const Eigen::VectorXd& x, const Eigen::VectorXd& face_forces,
                                       StepVector& out) const {
  const Eigen::VectorXd U = inverse_mass.cwiseProduct(face_forces - G.transpose() * x);
  for (auto& field : out.velocity) std::fill(field.begin(), field.end(), 0.0);
  std::fill(out.pressure.begin(), out.pressure.end(), 0.0);
  for (std::size_t i = 0; i < faces.size(); ++i) out.velocity[faces[i].axis][faces[i].at] = U[i];
  for (std::size_t i = 0; i < pressure_cells.size(); ++i) out.pressure[pressure_cells[i]] = x[stresses + i];
}

Eigen::VectorXd StressSystem::unknownsOf(const StepVector& from, const Eigen::VectorXd& free_twists) const {
  Eigen::VectorXd x = (G * faceForces(from) + J * free_twists);
  for (Eigen::Index i = 0; i < stresses; ++i) x[i] /= inverse_weight[i];
  for (std::size_t i = 0; i < pressure_cells.size(); ++i) x[stresses + i] = from.pressure[pressure_cells[i]];
  return x;
}

}  // namespace monolith
