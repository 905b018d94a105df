#include "physics/standing_mode.h"

#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace monolith {
namespace {

using Complex = std::complex<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;
using Terms = std::vector<std::pair<int, double>>;

constexpr double kFinest = 5e-4, kCoarsest = 0.02;  // of the length
constexpr double kGrowth = 1.1;                     // from one cell to the next
constexpr int kMostIterations = 60;
constexpr double kConverged = 1e-10;

// Widths of cells that fill `length`, the finest at both ends.
std::vector<double> gradedCells(double length, double finest, double coarsest) {
  std::vector<double> half = {finest};
  double sum = finest;
  while (2.0 * sum < length) {
    half.push_back(std::min(half.back() * kGrowth, coarsest));
    sum += half.back();
  }
  std::vector<double> all = half;
  all.insert(all.end(), half.rbegin(), half.rend());
  for (double& width : all) width *= 0.5 * length / sum;
  return all;
}

// Unknowns: u at the faces between cells, w at the top of every cell, p, eta.
class Mode {
 public:
  explicit Mode(const StandingTank& tank)
      : tank_(tank),
        dx_(gradedCells(tank.length, kFinest * tank.length, kCoarsest * tank.length)),
        dz_(gradedCells(tank.depth, kFinest * tank.length, kCoarsest * tank.length)),
        nx_(static_cast<int>(dx_.size())),
        nz_(static_cast<int>(dz_.size())) {
    addViscosity();
    addInertia();
    addPressure();
    addSurface();
  }

  Complex rateNear(Complex shift) const {
    const int size = eta(nx_);
    Eigen::SparseMatrix<Complex> operators(size, size), inertia(size, size);
    operators.setFromTriplets(stiffness_.begin(), stiffness_.end());
    inertia.setFromTriplets(mass_.begin(), mass_.end());
    Eigen::SparseMatrix<Complex> shifted = operators - shift * inertia;
    shifted.makeCompressed();
    Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factors(shifted);
    if (factors.info() != Eigen::Success) throw std::runtime_error("standing wave: no factors");
    Eigen::VectorXcd v = Eigen::VectorXcd::Zero(size);
    double x = 0.0;
    for (int i = 0; i < nx_; ++i) {
      v[eta(i)] = std::cos(M_PI * (x + 0.5 * dx_[i]) / tank_.length);
      x += dx_[i];
    }
    v.normalize();
    Complex last = 0.0;
    for (int i = 0; i < kMostIterations; ++i) {
      const Eigen::VectorXcd next = factors.solve(inertia * v);
      const Complex rate = shift + 1.0 / v.dot(next);
      if (std::abs(rate - last) < kConverged * std::abs(rate)) return rate;
      last = rate;
      v = next.normalized();
    }
    throw std::runtime_error("standing wave: no eigenvalue");
  }

 private:
  int u(int i, int j) const { return (i - 1) * nz_ + j; }
  int w(int i, int j) const { return (nx_ - 1) * nz_ + i * nz_ + j - 1; }
  int p(int i, int j) const { return (2 * nx_ - 1) * nz_ + i * nz_ + j; }
  int eta(int i) const { return (3 * nx_ - 1) * nz_ + i; }
  // Between cell centres, or from one to the end.
  static double between(const std::vector<double>& d, int i) {
    const int n = static_cast<int>(d.size());
    return 0.5 * ((i > 0 ? d[i - 1] : 0.0) + (i < n ? d[i] : 0.0));
  }

  // A rate of strain, times what its square dissipates: -weight terms^T terms.
  void dissipate(const Terms& terms, double weight) {
    for (const auto& [row, a] : terms) {
      for (const auto& [column, b] : terms) stiffness_.emplace_back(row, column, -weight * a * b);
    }
  }

  void addViscosity() {
    const double nu = tank_.viscosity;
    for (int i = 0; i < nx_; ++i) {
      for (int j = 0; j < nz_; ++j) {
        const double volume = dx_[i] * dz_[j];
        Terms along_x, along_z = {{w(i, j + 1), 1.0 / dz_[j]}};
        if (i + 1 < nx_) along_x.emplace_back(u(i + 1, j), 1.0 / dx_[i]);
        if (i > 0) along_x.emplace_back(u(i, j), -1.0 / dx_[i]);
        if (j > 0) along_z.emplace_back(w(i, j), -1.0 / dz_[j]);
        dissipate(along_x, 2.0 * nu * volume);
        dissipate(along_z, 2.0 * nu * volume);
      }
    }
    // Shear: none at the surface but in the corner, where the wall holds half a cell of it.
    for (int i = 0; i <= nx_; ++i) {
      const bool wall = i == 0 || i == nx_;
      if (wall && !tank_.walls_hold) continue;
      const double x = between(dx_, i);
      for (int j = 0; j <= nz_; ++j) {
        const double z = between(dz_, j);
        Terms shear;
        if (j > 0 && (wall || j < nz_)) {
          if (i < nx_) shear.emplace_back(w(i, j), 1.0 / x);
          if (i > 0) shear.emplace_back(w(i - 1, j), -1.0 / x);
        }
        if (!wall && j < nz_) {
          shear.emplace_back(u(i, j), 1.0 / z);
          if (j > 0) shear.emplace_back(u(i, j - 1), -1.0 / z);
        }
        dissipate(shear, nu * x * z);
      }
    }
  }

  void addInertia() {
    for (int i = 0; i < nx_; ++i) {
      for (int j = 0; j < nz_; ++j) {
        if (i > 0) mass_.emplace_back(u(i, j), u(i, j), between(dx_, i) * dz_[j]);
        mass_.emplace_back(w(i, j + 1), w(i, j + 1), dx_[i] * between(dz_, j + 1));
      }
    }
  }

  void addPressure() {
    const auto couple = [this](int face, int cell, double area) {
      stiffness_.emplace_back(face, cell, area);
      stiffness_.emplace_back(cell, face, area);
    };
    for (int i = 0; i < nx_; ++i) {
      for (int j = 0; j < nz_; ++j) {
        if (i + 1 < nx_) couple(u(i + 1, j), p(i, j), dz_[j]);
        if (i > 0) couple(u(i, j), p(i, j), -dz_[j]);
        couple(w(i, j + 1), p(i, j), dx_[i]);
        if (j > 0) couple(w(i, j), p(i, j), -dx_[i]);
      }
    }
  }

  void addSurface() {
    for (int i = 0; i < nx_; ++i) {
      stiffness_.emplace_back(w(i, nz_), eta(i), -tank_.gravity * dx_[i]);
      stiffness_.emplace_back(eta(i), w(i, nz_), tank_.gravity * dx_[i]);
      mass_.emplace_back(eta(i), eta(i), tank_.gravity * dx_[i]);
    }
  }

  StandingTank tank_;
  std::vector<double> dx_, dz_;
  int nx_, nz_;
  Triplets stiffness_, mass_;
};

}  // namespace

double inviscidFrequency(const StandingTank& tank) {
  const double k = M_PI / tank.length;
  return std::sqrt(tank.gravity * k * std::tanh(k * tank.depth));
}

std::complex<double> boundaryLayerRate(const StandingTank& tank) {
  const double omega = inviscidFrequency(tank), k = M_PI / tank.length, kh = k * tank.depth;
  const double s = std::sqrt(0.5 * tank.viscosity * omega), part = 2.0 * kh / std::sinh(2.0 * kh);
  const double layers = s * k / std::sinh(2.0 * kh) + (tank.walls_hold ? s / tank.length * (1.0 - part) : 0.0);
  return {-2.0 * tank.viscosity * k * k - layers, omega - layers};
}

std::complex<double> standingRate(const StandingTank& tank) { return Mode(tank).rateNear(boundaryLayerRate(tank)); }

}  // namespace monolith
