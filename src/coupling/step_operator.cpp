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

void computeStress(const StaggeredCoefficients<double>& c, const BodyRows& rows, const StepVector& x,
                   StressSamples<double>& stress) {
  computeStress(c, x.velocity, stress);
  for (int a = 0; a < 3; ++a) {
    for (const BodyRow& row : rows.normal[a]) {
      stress.normal[a][row.sample] += c.normal[a][row.sample] * row.coefficient.dot(x.bodies[row.body]);
    }
    for (const BodyRow& row : rows.shear[a]) {
      stress.shear[a][row.sample] += row.coefficient.dot(x.bodies[row.body]);
    }
    fillHalo(c.lattice, stress.normal[a]);
    fillHalo(c.lattice, stress.shear[a]);
  }
}

void addStressToBodies(const BodyRows& rows, const StressSamples<double>& stress, std::vector<Vector6d>& forces) {
  for (int a = 0; a < 3; ++a) {
    for (const BodyRow& row : rows.normal[a]) forces[row.body] += row.coefficient * stress.normal[a][row.sample];
    for (const BodyRow& row : rows.shear[a]) forces[row.body] += row.coefficient * stress.shear[a][row.sample];
  }
}

void StepOperator::apply(StepVector& x, StepVector& y) {
  const StaggeredCoefficients<double>& c = *coefficients_;
  const Lattice& l = c.lattice;
  y.resize(l, x.bodies.size());
  for (auto& force : y.bodies) force.setZero();
  for (auto& field : x.velocity) fillHalo(l, field);
  fillHalo(l, x.pressure);

  if (c.viscous) computeStress(c, *rows_, x, stress_);
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
  addStressToBodies(*rows_, stress_, y.bodies);
  for (int a = 0; a < 3; ++a) {
    for (const BodyRow& row : rows_->drag[a]) {
      const double solid = row.coefficient.dot(x.bodies[row.body]);
      const double drag = c.drag[a][row.sample];
      y.velocity[a][row.sample] -= drag * solid;
      y.bodies[row.body] += row.coefficient * (drag * (solid - x.velocity[a][row.sample]));
    }
  }
}

void StepOperator::bodyForces(StepVector& x, std::vector<Vector6d>& forces) const {
  const StaggeredCoefficients<double>& c = *coefficients_;
  const Lattice& l = c.lattice;
  for (auto& force : forces) force.setZero();
  for (const BodyRow& row : rows_->divergence) forces[row.body] -= row.coefficient * x.pressure[row.sample];
  if (!c.viscous) return;
  for (auto& field : x.velocity) fillHalo(l, field);
  for (int a = 0; a < 3; ++a) {
    const auto& u = x.velocity[a];
    for (const BodyRow& row : rows_->normal[a]) {
      const double stress = c.normal[a][row.sample] * (u[row.sample + l.stride[a]] - u[row.sample]);
      forces[row.body] += row.coefficient * stress;
    }
    for (const BodyRow& row : rows_->drag[a]) {
      forces[row.body] -= row.coefficient * (c.drag[a][row.sample] * u[row.sample]);
    }
    const auto [first, second] = kShearPairs[a];
    const auto& v = x.velocity[first];
    const auto& w = x.velocity[second];
    for (const BodyRow& row : rows_->shear[a]) {
      const auto e = row.sample;
      const double stress = c.shear[a][0][e] * (v[e] - v[e - l.stride[second]]) +
                            c.shear[a][1][e] * (w[e] - w[e - l.stride[first]]);
      forces[row.body] += row.coefficient * stress;
    }
  }
}

}  // namespace monolith
