#include "coupling/step_operator.h"

#include <algorithm>

namespace monolith {

void StepVector::resize(const Lattice& lattice, std::size_t body_count) {
  for (auto& field : velocity) field.resize(lattice.size, 0.0);
  pressure.resize(lattice.size, 0.0);
  bodies.resize(body_count, Vector6d::Zero());
}

void StepVector::setZero() {
  for (auto& field : velocity) std::fill(field.begin(), field.end(), 0.0);
  std::fill(pressure.begin(), pressure.end(), 0.0);
  for (auto& twist : bodies) twist.setZero();
}

void StepOperator::apply(StepVector& x, StepVector& y) {
  const StaggeredCoefficients<double>& c = *coefficients_;
  const Lattice& l = c.lattice;
  y.resize(l, x.bodies.size());
  for (auto& force : y.bodies) force.setZero();
  for (auto& field : x.velocity) fillHalo(l, field);
  fillHalo(l, x.pressure);

  if (c.viscous) {
    computeStress(c, x.velocity, stress_);
    for (int a = 0; a < 3; ++a) {
      for (const BodyRow& row : rows_->normal[a]) {
        stress_.normal[a][row.sample] += c.normal[a][row.sample] * row.coefficient.dot(x.bodies[row.body]);
      }
      for (const BodyRow& row : rows_->shear[a]) {
        stress_.shear[a][row.sample] += row.coefficient.dot(x.bodies[row.body]);
      }
      fillHalo(l, stress_.normal[a]);
      fillHalo(l, stress_.shear[a]);
    }
  }
  applyMomentum(c, x.velocity, stress_, y.velocity);
  addPressureForce(c, x.pressure, -1.0, y.velocity);
  computeDivergence(c, x.velocity, y.pressure);
  for (const BodyRow& row : rows_->divergence) {
    y.pressure[row.sample] += row.coefficient.dot(x.bodies[row.body]);
    y.bodies[row.body] -= row.coefficient * x.pressure[row.sample];
  }
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < y.pressure.size(); ++i) y.pressure[i] = -y.pressure[i];
  if (!c.viscous) return;
  for (int a = 0; a < 3; ++a) {
    for (const BodyRow& row : rows_->normal[a]) y.bodies[row.body] += row.coefficient * stress_.normal[a][row.sample];
    for (const BodyRow& row : rows_->shear[a]) y.bodies[row.body] += row.coefficient * stress_.shear[a][row.sample];
    for (const BodyRow& row : rows_->drag[a]) {
      const double solid = row.coefficient.dot(x.bodies[row.body]);
      const double drag = c.drag[a][row.sample];
      y.velocity[a][row.sample] -= drag * solid;
      y.bodies[row.body] += row.coefficient * (drag * (solid - x.velocity[a][row.sample]));
    }
  }
}

}  // namespace monolith
