#include "coupling/packed_system.h"

#include <algorithm>
#include <cmath>

#include "coupling/body_schur.h"
#include "solve/kernel_work.h"

namespace monolith {
namespace {

// A decade that takes this many times the iterations that it took when the bodies' resistance was fresh has lost some,
// and so many in all, for each unknown of the bodies, are worth estimating it anew.
constexpr double kStaleIterations = 1.2;
constexpr double kWorthRenewing = 0.7;
// So is a viscous number that has changed by this factor. Sub-steps and the order of a step change it by less all the
// time; until then it is followed as the resistance of a sphere would.
constexpr double kStaleNumber = 4.0;
// Fewer decades tell nothing about what one costs.
constexpr double kLeastDecades = 1.0;
constexpr double kLeastCost = 1.5;  // iterations a decade, below which none is too many

// By how much a sphere of `radius` cells is harder to move at viscous number `to` than at `from`: added mass, 2/3 pi r^3, and
// Stokes' drag, 6 pi N r.
double resistanceRatio(double radius, double from, double to) {
  const double added = radius * radius / 9.0;
  return from == to ? 1.0 : (added + to) / (added + from);
}

}  // namespace

void PackedSystem::set(StepProblem& problem) {
  problem_ = &problem;
  const StepProblem& p = problem;
  const long last_faces = faces_.build(), last_cells = cells_.build();
  buildFaceBlocks(p.coefficients, faces_, &transfer_, &impulse_, &p.steady);
  buildCellBlocks(p.coefficients, cells_, &p.steady);
  if (faces_.follows(last_faces) && cells_.follows(last_cells)) {
    std::vector<std::ptrdiff_t> lost;
    const auto size = static_cast<std::ptrdiff_t>(lattice().size);
    for (const auto& block : faces_.lost()) lost.push_back(block.component * size + block.place);
    for (const auto& block : cells_.lost()) lost.push_back(3 * size + block.place);
    krylov_.lose(lost, kLanes);
  } else {
    krylov_.forget();
  }
  faces_.convertTo(faces_single_);
  cells_.convertTo(cells_single_);
  flux_weight_ = std::max(1.0, 2.0 * p.viscous_number);
  preconditioner_.set(p, faces_single_, cells_single_, transfer_, impulse_);
  scale_.resize(bodySize());
  for (std::size_t i = 0; i < p.free.size(); ++i) scale_.segment<6>(6 * i) = p.twist_scale[i];
  columns_.set(p, scale_);
  columns_single_.convert(columns_);
  bodies_ = Eigen::MatrixXd::Zero(bodySize(), bodySize());
  for (std::size_t i = 0; i < p.free.size(); ++i) bodies_.block<6, 6>(6 * i, 6 * i) = p.inertia[i];
  bodies_ = (scale_.cwiseInverse().asDiagonal() * bodies_ * scale_.cwiseInverse().asDiagonal()).eval();
  S_ = bodies_;
  iterations_ = 0;
  decades_ = 0.0;
  bodies_ += columns_.ownResistance();
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
    fresh_cost_ = lost_ = 0.0;
    stale_ = false;
  }
  Eigen::VectorXd weight = scale_.cwiseInverse();
  for (std::size_t i = 0; i < p.free.size(); ++i) {
    weight.segment<6>(6 * i) *= std::sqrt(resistanceRatio(p.radius[i], resistance_number_, p.viscous_number));
  }
  S_ = weight.asDiagonal() * resistance_ * weight.asDiagonal();
  S_ += bodies_ - columns_.ownResistance();
  S_inverse_ = S_.ldlt().solve(Eigen::MatrixXd::Identity(bodySize(), bodySize()));
}

void PackedSystem::judgeAge() {
  if (decades_ < kLeastDecades || bodySize() == 0) return;
  const double cost = iterations_ / decades_;
  if (fresh_cost_ == 0.0) fresh_cost_ = std::max(cost, kLeastCost);
  if (cost > kStaleIterations * fresh_cost_) lost_ += iterations_ - fresh_cost_ * decades_;
  stale_ = lost_ > kWorthRenewing * static_cast<double>(bodySize());
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
  return inverse.asDiagonal() * S_inverse_ * inverse.asDiagonal();
}

void PackedSystem::setBorder(const ContactBorder& physical, const Eigen::VectorXd& compliance, double proximity) {
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  border_R_ = (physical.R * inverse.asDiagonal()).sparseView();
  border_C_ = (inverse.asDiagonal() * physical.C).sparseView();
  const Eigen::Index k = physical.count();
  border_compliance_.resize(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    border_compliance_[i] = compliance[physical.entry[i]] * (1.0 + proximity) + physical.mobility[i];
  }
  if (k == 0) return;
  const Eigen::MatrixXd moved = border_R_ * S_inverse_;
  Eigen::MatrixXd response = moved * border_C_;
  response.diagonal() += border_compliance_;
  border_response_.compute(response);
}

template <class Real>
void PackedSystem::apply(const FaceBlocks<Real>& faces, const CellBlocks<Real>& cells, const BodyColumns<Real>& columns,
                         std::vector<Real>& x, std::vector<Real>& y) const {
  const Lattice& l = lattice();
  const std::size_t size = l.size, liquid = liquidSize();
  Real* from = x.data();
  Real* to = y.data();
  for (int field = 0; field < 4; ++field) fillHalo(l, from + field * size);
  const Faces<const Real> U{from, from + size, from + 2 * size};
  applyMomentum(l, faces, problem_->coefficients.viscous, U, static_cast<const Real*>(from + 3 * size),
                Faces<Real>{to, to + size, to + 2 * size});
  applyDivergence(l, cells, U, Real(0), static_cast<const Real*>(nullptr), to + 3 * size);
  if (bodySize() > 0) columns.addMotion(from + liquid, to);
  if (flux_weight_ != 1.0) {
    const Real weight = static_cast<Real>(flux_weight_);
    Real* flux = to + 3 * size;
    countWork(size, 1.0, 2.0 * sizeof(Real));
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < size; ++i) flux[i] *= weight;
  }
  applyBodies(columns, x, y);
}

template <class Real>
void PackedSystem::applyBodies(const BodyColumns<Real>& columns, const std::vector<Real>& x,
                               std::vector<Real>& y) const {
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  const Eigen::Index n = bodySize(), k = border_compliance_.size();
  if (n == 0) return;
  const std::size_t liquid = liquidSize();
  const Real* from = x.data();
  Real* to = y.data();
  const Eigen::VectorXd v = Eigen::Map<const Vector>(from + liquid, n).template cast<double>();
  Eigen::VectorXd force = bodies_ * v + columns.forces(from);
  if (k > 0) {
    const Eigen::VectorXd r = Eigen::Map<const Vector>(from + liquid + n, k).template cast<double>();
    force -= border_C_ * r;
    Eigen::Map<Vector>(to + liquid + n, k) =
        (-(border_R_ * v) - border_compliance_.cwiseProduct(r)).template cast<Real>();
  }
  Eigen::Map<Vector>(to + liquid, n) = force.template cast<Real>();
}

void PackedSystem::precondition(const std::vector<float>& from, std::vector<float>& to) {
  preconditioner_.apply(from.data(), 1.0f / static_cast<float>(flux_weight_), to.data());
  preconditionBodies(from, to);
}

void PackedSystem::preconditionBodies(const std::vector<float>& from, std::vector<float>& to) const {
  const Eigen::Index n = bodySize(), k = border_compliance_.size();
  if (n == 0) return;
  const float* r = from.data() + liquidSize();
  float* out = to.data() + liquidSize();
  // Bodies feel what the liquid has just been given.
  Eigen::VectorXd force = Eigen::Map<const Eigen::VectorXf>(r, n).cast<double>() - columns_single_.forces(to.data());
  if (k > 0) {
    const Eigen::VectorXd free = S_inverse_ * force;
    const Eigen::VectorXd y =
        -border_response_.solve(Eigen::Map<const Eigen::VectorXf>(r + n, k).cast<double>() + border_R_ * free);
    Eigen::Map<Eigen::VectorXf>(out + n, k) = y.cast<float>();
    force += border_C_ * y;
  }
  Eigen::Map<Eigen::VectorXf>(out, n) = (S_inverse_ * force).cast<float>();
}

// Of planes from below upwards, their fields one after the other: what each thread has of the stencils.
Parts PackedSystem::liquidParts() const {
  const Lattice& l = lattice();
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  const Planes faces = faces_.planes(), cells = cells_.planes();
  const int first = std::min(faces.first, cells.first), end = std::max(faces.end, cells.end);
  const int at_once = static_cast<int>(std::max<std::ptrdiff_t>(1, kSumBlock / l.stride[2]));
  Parts parts;
  for (int k = first; k < end; k += at_once) {
    for (int field = 0; field < 4; ++field) {
      const std::ptrdiff_t shift = field * size;
      appendParts(shift + l.planeBegin(k), shift + l.planeBegin(std::min(end, k + at_once)), parts);
    }
  }
  return parts;
}

KrylovMaps PackedSystem::maps() {
  return {[this](auto& from, auto& to) { apply(faces_, cells_, columns_, from, to); },
          [this](auto& from, auto& to) { apply(faces_single_, cells_single_, columns_single_, from, to); },
          [this](auto& from, auto& to) { precondition(from, to); },
          liquidSize(),
          liquidParts(),
          [this](const auto& from, auto& to) { applyBodies(columns_, from, to); },
          [this](const auto& from, auto& to) { preconditionBodies(from, to); }};
}

Eigen::VectorXd PackedSystem::improvedTwists(const std::vector<double>& rhs, std::vector<double>& x) {
  const std::vector<float>& z = krylov_.firstDirection(maps(), rhs, x);
  const Eigen::VectorXf change = Eigen::Map<const Eigen::VectorXf>(z.data() + liquidSize(), bodySize());
  return twists(x) + change.cast<double>().cwiseQuotient(scale_);
}

KrylovReport PackedSystem::solve(const std::vector<double>& rhs, std::vector<double>& x, double goal, double part,
                                 const CoupledOptions& options, CoupledReport& report, KrylovPast past) {
  KrylovOptions k;
  k.absolute_tolerance = goal;
  k.relative_tolerance = part;
  k.maximum_iterations = options.maximum_iterations;
  // Where viscosities differ by orders of magnitude every direction counts.
  if (!problem_->cell_viscosity.empty()) k.shortest_cycle = k.longest_cycle;
  const KrylovReport done = krylov_.solve(maps(), rhs, x, k, past);
  report.iterations += done.iterations;
  ++report.solves;
  if (iterations_ == 0 && done.iterations > 0 && done.residual > 0.0) {
    iterations_ = done.iterations;
    decades_ = std::log10(done.initial_residual / done.residual);
  }
  return done;
}

}  // namespace monolith
