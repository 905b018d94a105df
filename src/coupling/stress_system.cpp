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

// Collects the rows of a StressSystem: stresses, then pressures.
class Rows {
 public:
  // Numbers the faces with an unknown.
  Rows(const StepProblem& problem, StressSystem& out)
      : problem_(problem), coefficients_(problem.coefficients), lattice_(coefficients_.lattice), out_(out) {
    std::vector<double> masses;
    for (int a = 0; a < 3; ++a) {
      std::vector<std::ptrdiff_t> at;
      forEachIndex(lattice_, [&](std::ptrdiff_t f) {
        if (coefficients_.mass[a][f] > 0.0) at.push_back(f);
      });
      face_number_[a] = numbered(lattice_, at);
      const int before = static_cast<int>(out.faces.size());
      for (int& n : face_number_[a]) n += n >= 0 ? before : 0;
      for (const auto f : at) {
        out.faces.push_back({a, f});
        masses.push_back(coefficients_.mass[a][f]);
      }
    }
    out.inverse_mass =
        Eigen::Map<const Eigen::VectorXd>(masses.data(), static_cast<Eigen::Index>(masses.size())).cwiseInverse();
  }

  void addStresses() {
    const StaggeredCoefficients<double>& c = coefficients_;
    const auto& stride = lattice_.stride;
    for (int a = 0; a < 3; ++a) {
      addSamples([&](std::ptrdiff_t s) { return c.normal[a][s]; },
                 [&](std::ptrdiff_t s) {
                   add(a, s + stride[a], 1.0);
                   add(a, s, -1.0);
                 },
                 problem_.rows.normal[a], 1.0);
      addSamples([&](std::ptrdiff_t s) { return c.drag[a][s]; }, [&](std::ptrdiff_t s) { add(a, s, 1.0); },
                 problem_.rows.drag[a], -1.0);
    }
    for (int p = 0; p < 3; ++p) {
      const auto [a, b] = kShearPairs[p];
      addSamples([&](std::ptrdiff_t s) { return c.shear[p][0][s] != 0.0 || c.shear[p][1][s] != 0.0 ? 1.0 : 0.0; },
                 [&, a = a, b = b](std::ptrdiff_t s) {
                   add(a, s, c.shear[p][0][s]);
                   add(a, s - stride[b], -c.shear[p][0][s]);
                   add(b, s, c.shear[p][1][s]);
                   add(b, s - stride[a], -c.shear[p][1][s]);
                 },
                 problem_.rows.shear[p], 1.0);
    }
  }

  // Rows of -C, which have no weight.
  void addPressures() {
    out_.stresses = count_;
    std::vector<int> number(lattice_.size, -1);
    forEachIndex(lattice_, [&](std::ptrdiff_t s) {
      if (!coefficients_.has_pressure[s]) return;
      for (int a = 0; a < 3; ++a) {
        const OpenParts<double> open = coefficients_.open(a);
        add(a, s + lattice_.stride[a], -open[s + lattice_.stride[a]]);
        add(a, s, open[s]);
      }
      number[s] = count_++;
      out_.pressure_cells.push_back(s);
    });
    addBodyRows(problem_.rows.divergence, number, -1.0);
  }

  void assemble() const {
    out_.G.resize(count_, static_cast<Eigen::Index>(out_.faces.size()));
    out_.G.setFromTriplets(G_.begin(), G_.end());
    StressSystem::Sparse of_twists(count_, problem_.coordinates.S().rows());
    of_twists.setFromTriplets(J_.begin(), J_.end());
    out_.J = of_twists * problem_.coordinates.S();
    out_.inverse_weight = Eigen::VectorXd::Zero(count_);
    for (Eigen::Index i = 0; i < out_.stresses; ++i) out_.inverse_weight[i] = 1.0 / weight_[i];
    out_.A = out_.G * out_.inverse_mass.asDiagonal() * out_.G.transpose();
    // Every diagonal entry exists, also where no face is near.
    std::vector<Triplet> diagonal;
    for (int i = 0; i < count_; ++i) diagonal.emplace_back(i, i, out_.inverse_weight[i]);
    StressSystem::Sparse Wi(count_, count_);
    Wi.setFromTriplets(diagonal.begin(), diagonal.end());
    out_.A += Wi;
  }

 private:
  // An entry of the row that is being added.
  void add(int axis, std::ptrdiff_t face, double value) {
    const int n = face_number_[axis][face];
    if (n >= 0 && value != 0.0) G_.emplace_back(count_, n, value);
  }

  // Samples of one kind, where has(sample) is a weight: their rows of G by row_of(sample), and those of J.
  template <class Has, class RowOf>
  void addSamples(Has&& has, RowOf&& row_of, const std::vector<BodyRow>& body_rows, double sign) {
    std::vector<int> number(lattice_.size, -1);
    forEachIndex(lattice_, [&](std::ptrdiff_t s) {
      const double w = has(s);
      if (!(w > 0.0)) return;
      row_of(s);
      number[s] = count_++;
      weight_.push_back(w);
    });
    addBodyRows(body_rows, number, sign);
  }

  void addBodyRows(const std::vector<BodyRow>& rows, const std::vector<int>& number, double sign) {
    for (const BodyRow& r : rows) {
      const int place = problem_.free_index[r.body];
      if (place < 0 || number[r.sample] < 0) continue;
      for (int d = 0; d < 6; ++d) J_.emplace_back(number[r.sample], 6 * place + d, sign * r.coefficient[d]);
    }
  }

  const StepProblem& problem_;
  const StaggeredCoefficients<double>& coefficients_;
  const Lattice& lattice_;
  StressSystem& out_;
  FaceField<int> face_number_;
  int count_ = 0;  // of rows
  std::vector<Triplet> G_, J_;
  std::vector<double> weight_;
};

}  // namespace

StressSystem::StressSystem(const StepProblem& problem) {
  Rows rows(problem, *this);
  if (problem.coefficients.viscous) rows.addStresses();
  rows.addPressures();
  rows.assemble();
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
