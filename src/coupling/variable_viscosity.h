#pragma once
// Viscosity that differs from place to place: eta/eta_ref at every viscous sample of a step, and the step's
// coefficients scaled by it.
//
// Rates come from the step's own samples, fitted gradient and bodies included. An octant of a cell has one sample of
// each kind next to it, the cell's normal rates and one edge of each pair:
//   gamma_o^2 = 2 sum_a D_aa^2 + sum_p (2 D_p)^2.
// Its viscosity is eta(gamma_o), and a sample's is the mean over the octants that it belongs to. Away from boundaries
// this is the derivative of one convex energy, sum_o h^3/8 Phi(gamma_o), so the discrete step has one solution, too;
// and where one shear rate is all there is, each sample has the viscosity of its own rate. Cells without a normal
// sample - in the air, in solids - do not count.
//
// Logarithms of the ratios are stored in one array: cells, edges of the three pairs, slivers of the three axes (whose
// rate is that of the film between face and solid).

#include <vector>

#include "coupling/step_problem.h"
#include "fluid/rheology.h"

namespace monolith {

struct ViscosityField {
  std::vector<double> log_ratio;  // 7 blocks of lattice.size; 0 where there is no sample
  std::vector<double> weight;     // squared viscous force at the sample: how much its viscosity matters
  double mean_log = 0.0;          // over the cells that count
};

class VariableViscosity {
 public:
  // Keeps the coefficients of a problem that has just been assembled with the constant viscosity eta_ref (Pa s).
  void start(const StepProblem& problem, double reference);

  // Viscosities of the velocities in x, which holds the twists of all bodies.
  void evaluate(const StepProblem& problem, const ViscosityLaw& law, StepVector& x, ViscosityField& out) const;

  // Scales the problem's coefficients, body rows and multigrid levels.
  void apply(const ViscosityField& field, StepProblem& problem);

  // |A(next) x - A x| in stepNorm: what is left of the step's equations when the viscosity follows the velocity.
  double change(const StepProblem& problem, const ViscosityField& next, StepVector& x) const;

 private:
  // Of the edges of each pair: squared rates (1/s^2), and viscosities, summed over so many octants.
  struct Edges {
    FaceField<double> rate, sum, count;
  };

  // The parts of evaluate(), in this order.
  void measureEdges(const MacGrid& grid, const FaceField<double>& stress, Edges& edges, ViscosityField& out) const;
  void evaluateCells(const StepProblem& problem, const ViscosityLaw& law, const FaceField<double>& stress, Edges& edges,
                     ViscosityField& out) const;
  void evaluateEdges(const Lattice& lattice, const ViscosityLaw& law, Edges& edges, ViscosityField& out) const;
  void evaluateFilms(const StepProblem& problem, const ViscosityLaw& law, const StepVector& x,
                     ViscosityField& out) const;
  double meanOfCells(const Lattice& lattice, const std::vector<double>& log_ratio) const;
  void scaleCoarse(const ViscosityField& field, StepProblem& problem) const;
  bool counts(std::ptrdiff_t cell) const;

  double reference_ = 1.0;
  StrainScales scales_;
  FaceRows<float> normal_, drag_;
  std::array<std::array<RowField<float>, 2>, 3> shear_;
  std::array<std::vector<BodyRow>, 3> shear_rows_;
  std::vector<StaggeredCoefficients<float>> coarse_;
  std::vector<double> applied_;  // log ratios
};

}  // namespace monolith
