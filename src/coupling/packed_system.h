#pragma once
// The step's linear system as `fast` solves it: all unknowns in one vector - U by components, p^, lattice.size each,
// the unknowns of the bodies' motion times their scale, the impulses of the contacts in the border - and flexible GMRES
// with its preconditioner. The right side and the solution stay in the fields that hold them (BorderedVector); the
// basis of GMRES is packed. The preconditioner: the liquid's (liquid_preconditioner.h), then an approximate Schur
// complement S of the bodies, their inertia and their resistance to motion in this liquid, bordered by the contacts. S
// ages slowly and is kept while it serves.
//
// The rows of the divergence are multiplied by 2 N where that is more than one: so much of a stress does a divergence
// make, and a residual that weighs it less lets velocities pass whose strain rates are wrong.

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <limits>
#include <vector>

#include "coupling/body_columns.h"
#include "coupling/contact_states.h"
#include "coupling/liquid_preconditioner.h"
#include "coupling/rigid_modes.h"
#include "coupling/step_solver.h"
#include "solve/fgmres.h"
#include "solve/split_vector.h"

namespace monolith {

// A vector of the system over a StepVector's fields of the liquid.
struct BorderedVector {
  FaceField<double>* velocity = nullptr;
  std::vector<double>* pressure = nullptr;
  std::vector<double> rest;                         // unknowns of the free bodies, then of the border
  double velocity_norm = 0.0, pressure_norm = 0.0;  // of forces

  LiquidFields<double> fields() const {
    return {(*velocity)[0].data(), (*velocity)[1].data(), (*velocity)[2].data(), pressure->data()};
  }
};

class PackedSystem {
 public:
  // The problem must outlive its use.
  void set(StepProblem& problem);

  const Lattice& lattice() const { return problem_->grid.lattice; }
  std::size_t liquidSize() const { return 4 * lattice().size; }
  Eigen::Index bodySize() const { return problem_->bodyUnknowns(); }

  // Vectors over the fields of v, whose halos are zero, without border; forces and velocities of bodies scale
  // differently. v must outlive them.
  BorderedVector forces(StepVector& v) const;
  BorderedVector motion(StepVector& v) const;
  // Completes v, over whose fields x is, from its rest.
  void finish(const BorderedVector& x, StepVector& v) const;

  // Motion of the bodies in m/s and rad/s, by their unknowns; what is written for forces on them.
  Eigen::VectorXd motionOf(const BorderedVector& x) const;
  void setForces(const Eigen::VectorXd& forces, BorderedVector& rhs) const;

  // Response of that motion to impulses as S has it.
  Eigen::MatrixXd estimatedResponse() const;
  // S from a response that was solved for; it ages from then on.
  void adoptResponse(const Eigen::MatrixXd& K);

  // Contacts that take part, of rows with these compliances.
  void setBorder(const ContactBorder& physical, const Eigen::VectorXd& compliance);

  // What bodies do that neither liquid nor another body touches, for which S is exact: the residual of all would hide
  // theirs.
  void moveUntouched(const BorderedVector& rhs, const ContactRows& contacts, BorderedVector& x) const;
  // The motion of bodies that no liquid touches, given the forces on them: S is exact. Returns it.
  Eigen::VectorXd moveDry(const BorderedVector& rhs, BorderedVector& x) const;
  // Motion of the bodies in x after one cycle of the preconditioner on its residual. The right side is left as it was.
  Eigen::VectorXd improvedMotion(const BorderedVector& rhs, BorderedVector& x);
  // For the residual. See KrylovOptions.
  struct Goal {
    double residual = 0.0;
    double part = 0.0;  // or so much of what it was at first
    double of_guess = std::numeric_limits<double>::infinity();
  };
  // past: of the call before, improvedMotion() or solve(); nothing but the border and forces on bodies may have changed
  // since. The right side is left as it was.
  KrylovReport solve(const BorderedVector& rhs, BorderedVector& x, const Goal& goal, const CoupledOptions& options,
                     CoupledReport& report, KrylovPast past = KrylovPast::kNothing);

  // S is renewed before it is next used if solves have lost more iterations by its age than renewing it takes...
  void judgeAge();
  // ... or one failed.
  void distrust() { stale_ = true; }
  void updateSchur();

 private:
  template <class Real>
  void apply(const FaceBlocks<Real>& faces, const CellBlocks<Real>& cells, const BodyColumns<Real>& columns,
             std::vector<Real>& x, std::vector<Real>& y) const;
  // Motion of the bodies, by their unknowns, in the units of the columns.
  template <class Real>
  std::vector<Real> columnMotion(const Real* rest) const;
  Eigen::VectorXd columnForces(const BodyColumns<double>& columns, const LiquidFields<const double>& fields) const {
    return twists_of_.transpose() * columns.forces(fields);
  }
  Eigen::VectorXd columnForces(const BodyColumns<float>& columns, const LiquidFields<const float>& fields) const {
    return twists_of_.transpose() * columns.forces(fields);
  }
  // Its rows of the bodies and the border, of x with the liquid's fields and the rest apart.
  template <class Real>
  void applyBodies(const BodyColumns<Real>& columns, const LiquidFields<const Real>& fields, const Real* rest,
                   Real* out) const;
  // r = b - A x of a solution that is split()
  void residual(const BorderedVector& rhs, const SplitVector& x, std::vector<float>& r);
  void residualOfBodies(const BorderedVector& rhs, const SplitVector& x, std::vector<float>& r) const;
  void precondition(const std::vector<float>& from, std::vector<float>& to);
  // Its second half, for which `to` holds the liquid's.
  void preconditionBodies(const std::vector<float>& from, std::vector<float>& to) const;
  Parts liquidParts() const;
  KrylovMaps maps(const BorderedVector& rhs);
  // From resistance_ to its part in S.
  Eigen::VectorXd resistanceWeight() const;
  SplitVector split(BorderedVector& x) const;

  StepProblem* problem_ = nullptr;
  FaceBlocks<double> faces_;
  FaceBlocks<float> faces_single_;
  CellBlocks<double> cells_;
  CellBlocks<float> cells_single_;
  BodyColumns<double> columns_;
  BodyColumns<float> columns_single_;
  FaceRows<float> transfer_, impulse_;  // of the finest level, see buildFaceBlocks()
  LiquidPreconditioner preconditioner_;
  RigidModes together_;
  std::vector<float> common_, left_;  // their part of a direction, and of a residual what it leaves
  Fgmres krylov_;
  double flux_weight_ = 1.0;
  LiquidPlaces<double> before_;  // of the right side, where the bodies' motion is taken from it
  Eigen::VectorXd scale_;        // unknown = scale * velocity
  Eigen::SparseMatrix<double> twists_of_;  // from the unknowns to the twists, in the units of the columns
  Eigen::MatrixXd bodies_;                 // A_vv of the unknowns with inertia
  Eigen::MatrixXd own_resistance_;         // and without
  Eigen::MatrixXd resistance_;             // of the bodies to the velocities q of body_coordinates.h, physical units
  std::vector<int> resistance_of_;
  double resistance_number_ = -1.0;
  // Of the first solve since set(): later ones have fewer decades to go.
  int iterations_ = 0;
  double decades_ = 0.0;
  double fresh_cost_ = 0.0;  // iterations a decade just after S was made; 0: not known yet
  double lost_ = 0.0;        // iterations since then that a fresh S would have saved
  bool stale_ = true;
  Eigen::MatrixXd S_, S_inverse_;
  // The border in units of the unknowns; a contact involves two bodies.
  Eigen::SparseMatrix<double, Eigen::RowMajor> border_R_;
  Eigen::SparseMatrix<double> border_C_;
  Eigen::VectorXd border_compliance_;
  Eigen::PartialPivLU<Eigen::MatrixXd> border_response_;  // R S^-1 C + compliance
};

}  // namespace monolith
