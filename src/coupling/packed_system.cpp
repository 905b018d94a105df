#include "coupling/packed_system.h"

#include <algorithm>

#include "coupling/body_schur.h"

namespace monolith {
namespace {

// The bodies' resistance is estimated anew when the solve takes this many times the iterations that it took when
// fresh...
constexpr double kStaleIterations = 1.4;
// ... or the viscous number has changed by this factor.
constexpr double kStaleNumber = 1.5;

}  // namespace

void PackedSystem::set(StepProblem& problem) {
  problem_ = &problem;
  const StepProblem& p = problem;
  FaceField<float> transfer, conductance;
  buildFaceBlocks(p.coefficients, faces_, &transfer, &conductance);
  buildCellBlocks(p.coefficients, cells_);
  faces_single_ = faces_.converted<float>();
  cells_single_ = cells_.converted<float>();
  flux_weight_ = std::max(1.0, 2.0 * p.viscous_number);
  preconditioner_.set(p, faces_single_, cells_single_, std::move(transfer), std::move(conductance));
  scale_.resize(bodySize());
  for (std::size_t i = 0; i < p.free.size(); ++i) scale_.segment<6>(6 * i) = p.twist_scale[i];
  columns_.set(p, scale_);
  columns_single_.convert(columns_);
  bodies_ = Eigen::MatrixXd::Zero(bodySize(), bodySize());
  for (std::size_t i = 0; i < p.free.size(); ++i) bodies_.block<6, 6>(6 * i, 6 * i) = p.inertia[i];
  bodies_ = (scale_.cwiseInverse().asDiagonal() * bodies_ * scale_.cwiseInverse().asDiagonal()).eval();
  S_ = bodies_;
  bodies_ += columns_.ownResistance();
  border_ = ContactBorder();
}

std::size_t PackedSystem::bytes() const {
  return faces_.bytes() + faces_single_.bytes() + cells_.bytes() + cells_single_.bytes() + preconditioner_.bytes() +
         krylov_.bytes();
}

void PackedSystem::updateSchur() {
  const StepProblem& p = *problem_;
  const bool same = resistance_of_ == p.free && resistance_number_ >= 0.0 &&
                    p.viscous_number <= kStaleNumber * resistance_number_ &&
                    resistance_number_ <= kStaleNumber * p.viscous_number && !stale_;
  if (!same) {
    resistance_ = scale_.asDiagonal() * BodySchur::resistance(columns_single_, preconditioner_, liquidSize()) *
                  scale_.asDiagonal();
    resistance_of_ = p.free;
    resistance_number_ = p.viscous_number;
    fresh_iterations_ = 0;
    stale_ = false;
  }
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  S_ = inverse.asDiagonal() * resistance_ * inverse.asDiagonal();
  S_ += bodies_ - columns_.ownResistance();
}

void PackedSystem::judgeAge(const CoupledReport& report) {
  if (report.solves == 0 || bodySize() == 0) return;
  const int iterations = report.iterations / report.solves;
  if (fresh_iterations_ == 0) fresh_iterations_ = std::max(iterations, 5);
  stale_ = iterations > kStaleIterations * fresh_iterations_ + 1;
}

void PackedSystem::pack(const StepVector& v, bool forces, std::vector<double>& x) const {
  const std::size_t n = lattice().size;
  x.resize(size());
  const double weight = forces ? flux_weight_ : 1.0;
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    for (int a = 0; a < 3; ++a) x[a * n + i] = v.velocity[a][i];
    x[3 * n + i] = weight * v.pressure[i];
  }
  for (int field = 0; field < 4; ++field) clearHalo(lattice(), x.data() + field * n);
  const Eigen::VectorXd b = gatherBodies(*problem_, v.bodies);
  Eigen::Map<Eigen::VectorXd>(x.data() + liquidSize(), bodySize()) =
      forces ? b.cwiseQuotient(scale_).eval() : b.cwiseProduct(scale_).eval();
}

void PackedSystem::unpackMotion(const std::vector<double>& x, StepVector& v) const {
  const std::size_t n = lattice().size;
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    for (int a = 0; a < 3; ++a) v.velocity[a][i] = x[a * n + i];
    v.pressure[i] = x[3 * n + i];
  }
  for (auto& field : v.velocity) clearHalo(lattice(), field);
  clearHalo(lattice(), v.pressure);
  scatterBodies(*problem_, twists(x), v.bodies);
}

Eigen::VectorXd PackedSystem::twists(const std::vector<double>& x) const {
  return Eigen::Map<const Eigen::VectorXd>(x.data() + liquidSize(), bodySize()).cwiseQuotient(scale_);
}

void PackedSystem::setForces(const Eigen::VectorXd& forces, std::vector<double>& rhs) const {
  Eigen::Map<Eigen::VectorXd>(rhs.data() + liquidSize(), bodySize()) = forces.cwiseQuotient(scale_);
}

Eigen::MatrixXd PackedSystem::estimatedResponse() const {
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  return inverse.asDiagonal() * S_.ldlt().solve(Eigen::MatrixXd::Identity(bodySize(), bodySize())) *
         inverse.asDiagonal();
}

void PackedSystem::setBorder(const ContactBorder& physical, const Eigen::VectorXd& compliance, double proximity) {
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  border_ = physical;
  border_.R = physical.R * inverse.asDiagonal();
  border_.C = inverse.asDiagonal() * physical.C;
  const Eigen::Index n = bodySize(), k = border_.count();
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n + k, n + k);
  M.topLeftCorner(n, n) = S_;
  M.bottomLeftCorner(k, n) = -border_.R;
  M.topRightCorner(n, k) = -border_.C;
  border_compliance_.resize(k);
  for (Eigen::Index i = 0; i < k; ++i) border_compliance_[i] = compliance[border_.entry[i]] * (1.0 + proximity);
  M.bottomRightCorner(k, k).diagonal() = -border_compliance_;
  if (M.size() > 0) small_.compute(M);
}

template <class Real>
void PackedSystem::apply(const FaceBlocks<Real>& faces, const CellBlocks<Real>& cells, const BodyColumns<Real>& columns,
                         std::vector<Real>& x, std::vector<Real>& y) const {
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  const Lattice& l = lattice();
  const std::size_t size = l.size, liquid = liquidSize();
  Real* from = x.data();
  Real* to = y.data();
  for (int field = 0; field < 4; ++field) fillHalo(l, from + field * size);
  const Faces<const Real> U{from, from + size, from + 2 * size};
  applyMomentum(l, faces, problem_->coefficients.viscous, U, static_cast<const Real*>(from + 3 * size),
                Faces<Real>{to, to + size, to + 2 * size});
  applyDivergence(l, cells, U, Real(0), static_cast<const Real*>(nullptr), to + 3 * size);
  const Eigen::Index n = bodySize(), k = border_.count();
  if (n > 0) columns.addMotion(from + liquid, to);
  if (flux_weight_ != 1.0) {
    const Real weight = static_cast<Real>(flux_weight_);
    Real* flux = to + 3 * size;
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < size; ++i) flux[i] *= weight;
  }
  if (n == 0) return;
  const Eigen::VectorXd v = Eigen::Map<const Vector>(from + liquid, n).template cast<double>();
  Eigen::VectorXd force = bodies_ * v + columns.forces(from);
  if (k > 0) {
    const Eigen::VectorXd r = Eigen::Map<const Vector>(from + liquid + n, k).template cast<double>();
    force -= border_.C * r;
    Eigen::Map<Vector>(to + liquid + n, k) =
        (-border_.R * v - border_compliance_.cwiseProduct(r)).template cast<Real>();
  }
  Eigen::Map<Vector>(to + liquid, n) = force.template cast<Real>();
}

void PackedSystem::precondition(const std::vector<float>& from, std::vector<float>& to) {
  preconditioner_.apply(from.data(), 1.0f / static_cast<float>(flux_weight_), to.data());
  const Eigen::Index n = bodySize() + border_.count();
  if (n == 0) return;
  Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXf>(from.data() + liquidSize(), n).cast<double>();
  // Bodies feel what the liquid has just been given.
  r.head(bodySize()) -= columns_single_.forces(to.data());
  Eigen::Map<Eigen::VectorXf>(to.data() + liquidSize(), n) = small_.solve(r).cast<float>();
}

std::vector<double> PackedSystem::improved(const std::vector<double>& rhs, const std::vector<double>& x) {
  std::vector<double> at(x), Ax(x.size(), 0.0);
  apply(faces_, cells_, columns_, at, Ax);
  std::vector<float> r(x.size()), z(x.size(), 0.0f);
  for (std::size_t i = 0; i < x.size(); ++i) r[i] = static_cast<float>(rhs[i] - Ax[i]);
  precondition(r, z);
  for (std::size_t i = 0; i < x.size(); ++i) at[i] = x[i] + z[i];
  return at;
}

KrylovReport PackedSystem::solve(const std::vector<double>& rhs, std::vector<double>& x, double goal,
                                 const CoupledOptions& options, CoupledReport& report) {
  KrylovOptions k;
  k.absolute_tolerance = goal;
  k.maximum_iterations = options.maximum_iterations;
  const KrylovReport done =
      krylov_.solve({[this](auto& from, auto& to) { apply(faces_, cells_, columns_, from, to); },
                     [this](auto& from, auto& to) { apply(faces_single_, cells_single_, columns_single_, from, to); },
                     [this](auto& from, auto& to) { precondition(from, to); }},
                    rhs, x, k);
  report.iterations += done.iterations;
  ++report.solves;
  return done;
}

}  // namespace monolith
