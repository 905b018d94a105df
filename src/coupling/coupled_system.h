#pragma once
// The operator of one step and its solve: liquid velocity U, twists v of the free bodies, pressure p and the impulses
// lambda of the active contacts, all implicit in one saddle-point system (DESIGN 1.2 with the stress eliminated):
//
//   [ A_uu  A_uv  -C_u^T        ] [ U      ]   [ m U*           ]
//   [ A_vu  A_vv  -C_v^T  -J^T  ] [ v      ] = [ M v* + wrench  ]     A = mass + D^T W D over (U, v)
//   [ -C_u  -C_v                ] [ p^     ]   [ prescribed flux ]
//   [        -J           -eps  ] [ lambda ]   [ gap/dt         ]
//
// in the units of coupling/stokes_coefficients.h; bodies by M^ = M/(rho h^3). Symmetric, indefinite. Solved by
// flexible GMRES with the projection preconditioner (Griffith 2009; Cai, Nonaka, Bell, Griffith & Donev 2014): one
// multigrid cycle on A_uu, one on L = C mass^-1 C^T with p^ = phi + 2 N g (Cahouet & Chabard 1988), and the bodies by an
// approximate Schur complement, their resistance to motion in this liquid, which ages slowly and is kept while it serves.
// Contacts that press are rows of the same system; which ones do is found by a small LCP on that Schur complement and
// verified on the full solution.

#include <memory>
#include <string>
#include <vector>

#include "coupling/pressure_regions.h"
#include "coupling/solid_fractions.h"
#include "coupling/stokes_coefficients.h"
#include "rigid/contact.h"
#include "rigid/integration.h"

namespace monolith {

struct CoupledOptions {
  double tolerance = 1e-6;       // |b - A x|_2 relative to |b|_2
  int maximum_iterations = 200;  // Krylov iterations of one linear solve
  int maximum_rounds = 20;       // linear solves until the set of pressing contacts is right
};

struct CoupledReport {
  enum class Status { kNotRun, kConverged, kNotConverged, kInconsistent };
  Status status = Status::kNotRun;
  std::string message;
  int iterations = 0;
  int solves = 0;
  double residual = 0.0;    // relative, recomputed
  double divergence = 0.0;  // 1/s, largest over cells with pressure
};

// In: initial guess. Out: solution, if the report says so; otherwise untouched.
struct CoupledState {
  FaceField<double> velocity;        // m/s, zero where there is no unknown
  std::vector<double> pressure;      // Pa
  std::vector<Vector6d> twists;      // of all bodies
  std::vector<Wrench> liquid;        // mean over the step, on each body
  std::vector<Wrench> contact;
};

class CoupledSystem {
 public:
  explicit CoupledSystem(const MacGrid& grid);
  ~CoupledSystem();

  // Geometry and material of the step; liquid_distance in cell widths with its halo filled. Bodies and distance must
  // outlive the solve; in `solids` the liquid that sticks to the bodies is moved to them (sticking_liquid.h).
  void assemble(SolidFractions& solids, const std::vector<RigidBody>& bodies,
                const std::vector<double>& liquid_distance, double density, double viscosity, double dt);

  // free_velocity: u*, gravity included. free_twists: v* of free bodies, the prescribed twist of the others. Gravity (m/s^2)
  // is what acts on the liquid that sticks to bodies.
  [[nodiscard]] CoupledReport solve(const FaceField<double>& free_velocity, const std::vector<Vector6d>& free_twists,
                                    const std::vector<Contact>& contacts, const Eigen::Vector3d& gravity,
                                    const CoupledOptions& options, CoupledState& state);

  const StaggeredCoefficients<double>& coefficients() const;
  const BodyRows& bodyRows() const;
  // Kinetic energy (J) and momentum (kg m/s) of the liquid that sticks to the bodies, when these have `twists`.
  double stickingEnergy(const std::vector<Vector6d>& twists) const;
  Eigen::Vector3d stickingMomentum(const std::vector<Vector6d>& twists) const;
  int coupledBodies() const;  // bodies with at least one coupling row

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace monolith
