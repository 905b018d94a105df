#include "coupling/step_operator.h"

#include <algorithm>
#include <cmath>

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
  if (c.viscous) {
    for (auto& field : x.velocity) fillHalo(l, field);
  }
  // Bodies that share a sample feel each other's motion: a stress is liquid(sample) + weight(sample) * solid(sample).
  const auto add = [&](const std::vector<BodyRow>& rows, std::vector<Vector6d>& out, auto&& liquid, auto&& weight) {
    forEachSample(rows, [&](const BodyRow* first, const BodyRow* last) {
      double solid = 0.0;
      for (const BodyRow* row = first; row != last; ++row) solid += row->coefficient.dot(x.bodies[row->body]);
      const double stress = liquid(first->sample) + weight(first->sample) * solid;
      for (const BodyRow* row = first; row != last; ++row) out[row->body] += stress * row->coefficient;
    });
  };
  const auto addNormal = [&](int a, std::vector<Vector6d>& out) {
    const auto& u = x.velocity[a];
    const auto& normal = c.normal[a];
    add(
        rows_->normal[a], out, [&](std::ptrdiff_t s) { return normal[s] * (u[s + l.stride[a]] - u[s]); },
        [&](std::ptrdiff_t s) { return normal[s]; });
    for (const BodyRow& row : rows_->drag[a]) {
      const double slip = row.coefficient.dot(x.bodies[row.body]) - u[row.sample];
      out[row.body] += row.coefficient * (c.drag[a][row.sample] * slip);
    }
  };
  const auto addShear = [&](int pair, std::vector<Vector6d>& out) {
    const auto [first, second] = kShearPairs[pair];
    const auto &v = x.velocity[first], &w = x.velocity[second];
    const auto& shear = c.shear[pair];
    const auto sv = l.stride[second], sw = l.stride[first];
    add(
        rows_->shear[pair], out,
        [&](std::ptrdiff_t s) { return shear[0][s] * (v[s] - v[s - sv]) + shear[1][s] * (w[s] - w[s - sw]); },
        [](std::ptrdiff_t) { return 1.0; });
  };
  // Kinds of rows apart from each other, their sums in order.
  const int kinds = c.viscous ? 7 : 1;
  std::vector<std::vector<Vector6d>> parts(kinds, std::vector<Vector6d>(forces.size(), Vector6d::Zero()));
#pragma omp parallel for schedule(dynamic)
  for (int kind = 0; kind < kinds; ++kind) {
    if (kind == 0) {
      for (const BodyRow& row : rows_->divergence) parts[0][row.body] -= row.coefficient * x.pressure[row.sample];
    } else if (kind <= 3) {
      addShear(kind - 1, parts[kind]);
    } else {
      addNormal(kind - 4, parts[kind]);
    }
  }
  for (std::size_t b = 0; b < forces.size(); ++b) {
    forces[b].setZero();
    for (const auto& part : parts) forces[b] += part[b];
  }
}

double StepOperator::largestDivergence(StepVector& x, std::vector<double>& divergence) const {
  const Lattice& l = coefficients_->lattice;
  for (auto& field : x.velocity) fillHalo(l, field);
  divergence.resize(l.size, 0.0);
  computeDivergence(*coefficients_, x.velocity, divergence);
  for (const BodyRow& row : rows_->divergence) {
    divergence[row.sample] += row.coefficient.dot(x.bodies[row.body]);
  }
  clearHalo(l, divergence);
  const double* values = divergence.data();
  double largest = 0.0;
#pragma omp parallel for simd schedule(static) reduction(max : largest)
  for (std::size_t i = 0; i < l.size; ++i) largest = std::max(largest, std::abs(values[i]));
  return largest;
}

}  // namespace monolith
