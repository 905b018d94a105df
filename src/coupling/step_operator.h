#pragma once
// Matrix-free action of one step's operator on liquid and bodies, from coefficients and body rows.

#include <vector>

#include "coupling/body_rows.h"

namespace monolith {

// Unknowns, or forces on them, in the dimensionless units of stokes_coefficients.h. One twist for every body.
struct StepVector {
  FaceField<double> velocity;
  std::vector<double> pressure;
  std::vector<Vector6d> bodies;

  void resize(const Lattice& lattice, std::size_t body_count);
  void setZero();
};

// Stress samples of liquid and bodies; x's halo must be filled, that of the stress is filled on return.
void computeStress(const StaggeredCoefficients<double>& coefficients, const BodyRows& rows, const StepVector& x,
                       StressSamples<double>& stress);
// Adds what the stress does to each body.
void addStressToBodies(const BodyRows& rows, const StressSamples<double>& stress, std::vector<Vector6d>& forces);

class StepOperator {
 public:
  // Both must outlive the operator.
  void set(const StaggeredCoefficients<double>* coefficients, const BodyRows* rows) {
    coefficients_ = coefficients;
    rows_ = rows;
  }

  // y = [A_uu U + A_uv v - C_u^T p,  A_vu U + (A_vv - M) v - C_v^T p,  -(C_u U + C_v v)]; without the bodies' inertia.
  // Fills the halos of x on periodic axes.
  void apply(StepVector& x, StepVector& y);

  // The bodies' part of apply(), at the cost of the bodies' rows alone; and the largest entry of its divergence, which
  // is returned, too.
  void bodyForces(StepVector& x, std::vector<Vector6d>& forces) const;
  double largestDivergence(StepVector& x, std::vector<double>& divergence) const;

 private:
  const StaggeredCoefficients<double>* coefficients_ = nullptr;
  const BodyRows* rows_ = nullptr;
  StressSamples<double> stress_;
};

}  // namespace monolith
