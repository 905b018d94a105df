#include "coupling/packed_system.h"

#include <algorithm>
#include <cmath>

#include "coupling/body_schur.h"
#include "solve/blocked_sum.h"
#include "solve/kernel_work.h"
#include "solve/whole_fields.h"

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

// By how much a sphere of `radius` cells is harder to move at viscous number `to` than at `from`: added mass,
// 2/3 pi r^3, and Stokes' drag, 6 pi N r.
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
  problem.coarse.release();
  scale_ = p.unknown_scale;
  Eigen::VectorXd twist_scale(6 * static_cast<Eigen::Index>(p.free.size()));
  for (std::size_t i = 0; i < p.free.size(); ++i) twist_scale.segment<6>(6 * i) = p.twist_scale[i];
  twists_of_ = p.coordinates.S();
  for (Eigen::Index j = 0; j < twists_of_.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(twists_of_, j); it; ++it) {
      it.valueRef() *= twist_scale[it.row()] / scale_[j];
    }
  }
  columns_.set(p, twist_scale);
  columns_single_.convert(columns_);
  bodies_ = p.bodyInertia();
  bodies_ = (scale_.cwiseInverse().asDiagonal() * bodies_ * scale_.cwiseInverse().asDiagonal()).eval();
  S_ = bodies_;
  iterations_ = 0;
  decades_ = 0.0;
  own_resistance_ = twists_of_.transpose() * columns_.ownResistance() * twists_of_;
  bodies_ += own_resistance_;
  border_compliance_.resize(0);  // that of the last step: apply() has none now
  together_.set(p, scale_, [this](auto& x, auto& y) { apply(faces_, cells_, columns_, x, y); });
}

void PackedSystem::updateSchur() {
  const StepProblem& p = *problem_;
  const bool same = resistance_of_ == p.free && resistance_number_ >= 0.0 &&
                    p.viscous_number <= kStaleNumber * resistance_number_ &&
                    resistance_number_ <= kStaleNumber * p.viscous_number && !stale_;
  if (!same) {
    resistance_ = scale_.asDiagonal() * BodySchur::resistance(lattice(), columns_single_, twists_of_, preconditioner_) *
                  scale_.asDiagonal();
    const Eigen::SparseMatrix<double>& mix = p.coordinates.Q_inverse();
    resistance_ = (mix.transpose() * resistance_ * mix).eval();
    resistance_of_ = p.free;
    resistance_number_ = p.viscous_number;
    fresh_cost_ = lost_ = 0.0;
    stale_ = false;
  }
  const Eigen::VectorXd weight = resistanceWeight();
  const Eigen::MatrixXd mixed = p.coordinates.Q().transpose() * resistance_ * p.coordinates.Q();
  S_ = weight.asDiagonal() * mixed * weight.asDiagonal();
  S_ += bodies_ - own_resistance_;
  S_inverse_ = S_.ldlt().solve(Eigen::MatrixXd::Identity(bodySize(), bodySize()));
}

Eigen::VectorXd PackedSystem::resistanceWeight() const {
  const StepProblem& p = *problem_;
  Eigen::VectorXd weight = scale_.cwiseInverse();
  for (const BodyCoordinates::Assembly& assembly : p.coordinates.assemblies()) {
    double radius = 0.0;
    bool touched = false;
    for (const int b : assembly.bodies) {
      const int i = p.free_index[b];
      if (i < 0) continue;
      radius = std::max(radius, p.radius[i]);
      touched = touched || p.touched[i];
    }
    // A body that has left the liquid is as light as it is.
    weight.segment(assembly.first, assembly.count) *=
        touched ? std::sqrt(resistanceRatio(radius, resistance_number_, p.viscous_number)) : 0.0;
  }
  return weight;
}

void PackedSystem::adoptResponse(const Eigen::MatrixXd& K) {
  const Eigen::MatrixXd inverse = scale_.asDiagonal() * K * scale_.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(inverse);
  if (factor.info() != Eigen::Success) return;
  S_inverse_ = inverse;
  S_ = factor.solve(Eigen::MatrixXd::Identity(bodySize(), bodySize()));
  Eigen::VectorXd weight = resistanceWeight();
  for (double& w : weight) w = w > 0.0 ? 1.0 / w : 0.0;
  resistance_ = weight.asDiagonal() * (S_ - bodies_ + own_resistance_) * weight.asDiagonal();
  const BodyCoordinates& unknowns = problem_->coordinates;
  resistance_ = (unknowns.Q_inverse().transpose() * resistance_ * unknowns.Q_inverse()).eval();
  fresh_cost_ = lost_ = 0.0;
  stale_ = false;
}

void PackedSystem::judgeAge() {
  if (decades_ < kLeastDecades || bodySize() == 0) return;
  const double cost = iterations_ / decades_;
  if (fresh_cost_ == 0.0) fresh_cost_ = std::max(cost, kLeastCost);
  if (cost > kStaleIterations * fresh_cost_) lost_ += iterations_ - fresh_cost_ * decades_;
  stale_ = lost_ > kWorthRenewing * static_cast<double>(bodySize());
}

BorderedVector PackedSystem::forces(StepVector& v) const {
  BorderedVector out{&v.velocity, &v.pressure, std::vector<double>(bodySize())};
  setForces(problem_->coordinates.gatherForces(v.bodies), out);
  double square = 0.0;
  for (const auto& field : v.velocity) square += dot(field, field);
  out.velocity_norm = std::sqrt(square);
  out.pressure_norm = std::sqrt(dot(v.pressure, v.pressure));
  return out;
}

BorderedVector PackedSystem::motion(StepVector& v) const {
  BorderedVector out{&v.velocity, &v.pressure, std::vector<double>(bodySize())};
  Eigen::Map<Eigen::VectorXd>(out.rest.data(), bodySize()) =
      problem_->coordinates.gatherMotion(v.bodies).cwiseProduct(scale_);
  return out;
}

void PackedSystem::finish(const BorderedVector& x, StepVector& v) const {
  for (double* field : x.fields()) clearHalo(lattice(), field);
  problem_->coordinates.scatterMotion(motionOf(x), v.bodies);
}

Eigen::VectorXd PackedSystem::motionOf(const BorderedVector& x) const {
  return Eigen::Map<const Eigen::VectorXd>(x.rest.data(), bodySize()).cwiseQuotient(scale_);
}

void PackedSystem::setForces(const Eigen::VectorXd& forces, BorderedVector& rhs) const {
  Eigen::Map<Eigen::VectorXd>(rhs.rest.data(), bodySize()) = forces.cwiseQuotient(scale_);
}

Eigen::MatrixXd PackedSystem::estimatedResponse() const {
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  return inverse.asDiagonal() * S_inverse_ * inverse.asDiagonal();
}

void PackedSystem::setBorder(const ContactBorder& physical, const Eigen::VectorXd& compliance) {
  const Eigen::VectorXd inverse = scale_.cwiseInverse();
  border_R_ = (physical.R * inverse.asDiagonal()).sparseView();
  border_C_ = (inverse.asDiagonal() * physical.C).sparseView();
  const Eigen::Index k = physical.count();
  border_compliance_.resize(k);
  for (Eigen::Index i = 0; i < k; ++i) {
    border_compliance_[i] = compliance[physical.entry[i]] + physical.mobility[i];
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
  const LiquidFields<Real> from = packedFields(l, x.data()), to = packedFields(l, y.data());
  for (Real* field : from) fillHalo(l, field);
  const Faces<const Real> U{from[0], from[1], from[2]};
  applyMomentum(l, faces, problem_->coefficients.viscous, U, static_cast<const Real*>(from[3]),
                Faces<Real>{to[0], to[1], to[2]});
  applyDivergence(l, cells, U, Real(0), static_cast<const Real*>(nullptr), to[3]);
  if (bodySize() > 0) columns.addMotion(columnMotion(x.data() + liquid).data(), to);
  if (flux_weight_ != 1.0) {
    const Real weight = static_cast<Real>(flux_weight_);
    Real* flux = to[3];
    countWork(size, 1.0, 2.0 * sizeof(Real));
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < size; ++i) flux[i] *= weight;
  }
  applyBodies<Real>(columns, {from[0], from[1], from[2], from[3]}, x.data() + liquid, y.data() + liquid);
}

template <class Real>
std::vector<Real> PackedSystem::columnMotion(const Real* rest) const {
  std::vector<Real> out(twists_of_.rows(), Real(0));
  for (Eigen::Index j = 0; j < twists_of_.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(twists_of_, j); it; ++it) {
      out[it.row()] += static_cast<Real>(it.value()) * rest[j];
    }
  }
  return out;
}

template <class Real>
void PackedSystem::applyBodies(const BodyColumns<Real>& columns, const LiquidFields<const Real>& fields,
                               const Real* rest, Real* out) const {
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  const Eigen::Index n = bodySize(), k = border_compliance_.size();
  if (n == 0) return;
  const Eigen::VectorXd v = Eigen::Map<const Vector>(rest, n).template cast<double>();
  Eigen::VectorXd force = bodies_ * v + columnForces(columns, fields);
  if (k > 0) {
    const Eigen::VectorXd r = Eigen::Map<const Vector>(rest + n, k).template cast<double>();
    force -= border_C_ * r;
    Eigen::Map<Vector>(out + n, k) = (-(border_R_ * v) - border_compliance_.cwiseProduct(r)).template cast<Real>();
  }
  Eigen::Map<Vector>(out, n) = force.template cast<Real>();
}

void PackedSystem::residual(const BorderedVector& rhs, const SplitVector& x, std::vector<float>& r) {
  const Lattice& l = lattice();
  const LiquidFields<double> b = rhs.fields();
  for (int field = 0; field < 4; ++field) fillHalo(l, x.pieces[field]);
  // What the bodies' motion does is small where it meets what is left of the rest: both in double precision.
  if (bodySize() > 0) columns_.takeMotion(columnMotion<double>(x.pieces[4]).data(), b, before_);
  const LiquidFields<float> to = packedFields(l, r.data());
  const Faces<const double> U{x.pieces[0], x.pieces[1], x.pieces[2]};
  momentumResidual(l, faces_, problem_->coefficients.viscous, {b[0], b[1], b[2]}, U, x.pieces[3],
                   {to[0], to[1], to[2]});
  divergenceResidual(l, cells_, b[3], U, flux_weight_, to[3]);
  if (bodySize() > 0) columns_.giveBack(before_, b);
  residualOfBodies(rhs, x, r);
}

void PackedSystem::residualOfBodies(const BorderedVector& rhs, const SplitVector& x, std::vector<float>& r) const {
  std::vector<double> out(rhs.rest.size());
  applyBodies<double>(columns_, {x.pieces[0], x.pieces[1], x.pieces[2], x.pieces[3]}, x.pieces[4], out.data());
  float* to = r.data() + liquidSize();
  for (std::size_t i = 0; i < out.size(); ++i) to[i] = static_cast<float>(rhs.rest[i] - out[i]);
}

void PackedSystem::precondition(const std::vector<float>& from, std::vector<float>& to) {
  const float flux_scale = 1.0f / static_cast<float>(flux_weight_);
  if (together_.drifts() == 0) {
    preconditioner_.apply(from.data(), flux_scale, to.data());
    preconditionBodies(from, to);
    return;
  }
  // First what liquid and bodies do together; the cycle sees what is left.
  assignZero(from.size(), common_);
  assignZero(from.size(), left_);
  together_.correct(from, common_);
  apply(faces_single_, cells_single_, columns_single_, common_, left_);
  countWork(from.size(), 2.0, 6.0 * sizeof(float));
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < from.size(); ++i) left_[i] = from[i] - left_[i];
  preconditioner_.apply(left_.data(), flux_scale, to.data());
  preconditionBodies(left_, to);
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < from.size(); ++i) to[i] += common_[i];
}

void PackedSystem::preconditionBodies(const std::vector<float>& from, std::vector<float>& to) const {
  const Eigen::Index n = bodySize(), k = border_compliance_.size();
  if (n == 0) return;
  const float* r = from.data() + liquidSize();
  float* out = to.data() + liquidSize();
  // Bodies feel what the liquid has just been given.
  Eigen::VectorXd force = Eigen::Map<const Eigen::VectorXf>(r, n).cast<double>() -
                          columnForces(columns_single_, packedFields<const float>(lattice(), to.data()));
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

SplitVector PackedSystem::split(BorderedVector& x) const {
  const LiquidFields<double> fields = x.fields();
  return {{fields[0], fields[1], fields[2], fields[3], x.rest.data()}, static_cast<std::ptrdiff_t>(lattice().size)};
}

KrylovMaps PackedSystem::maps(const BorderedVector& rhs) {
  const double rest_norm = Eigen::Map<const Eigen::VectorXd>(rhs.rest.data(), rhs.rest.size()).norm();
  return {liquidSize() + rhs.rest.size(),
          std::hypot(rhs.velocity_norm, flux_weight_ * rhs.pressure_norm, rest_norm),
          [&](const SplitVector& x, auto& r) { residual(rhs, x, r); },
          [this](auto& from, auto& to) { apply(faces_, cells_, columns_, from, to); },
          [this](auto& from, auto& to) { apply(faces_single_, cells_single_, columns_single_, from, to); },
          [this](auto& from, auto& to) { precondition(from, to); },
          liquidSize(),
          liquidParts(),
          [&](const SplitVector& x, auto& r) { residualOfBodies(rhs, x, r); },
          [this](const auto& from, auto& to) { preconditionBodies(from, to); }};
}

void PackedSystem::moveUntouched(const BorderedVector& rhs, const ContactRows& contacts, BorderedVector& x) const {
  const StepProblem& p = *problem_;
  for (const auto& [first, count, bodies, adrift] : p.coordinates.assemblies()) {
    const bool touched = std::any_of(bodies.begin(), bodies.end(),
                                     [&](int b) { return p.free_index[b] >= 0 && p.touched[p.free_index[b]]; });
    if (touched || !contacts.J.middleCols(first, count).isZero(0.0)) continue;
    const Eigen::Map<const Eigen::VectorXd> force(rhs.rest.data() + first, count);
    Eigen::Map<Eigen::VectorXd>(x.rest.data() + first, count) = S_inverse_.block(first, first, count, count) * force;
  }
}

Eigen::VectorXd PackedSystem::moveDry(const BorderedVector& rhs, BorderedVector& x) const {
  Eigen::Map<Eigen::VectorXd>(x.rest.data(), bodySize()) =
      S_inverse_ * Eigen::Map<const Eigen::VectorXd>(rhs.rest.data(), bodySize());
  return motionOf(x);
}

Eigen::VectorXd PackedSystem::improvedMotion(const BorderedVector& rhs, BorderedVector& x) {
  const std::vector<float>& z = krylov_.firstDirection(maps(rhs), split(x));
  const Eigen::VectorXf change = Eigen::Map<const Eigen::VectorXf>(z.data() + liquidSize(), bodySize());
  return motionOf(x) + change.cast<double>().cwiseQuotient(scale_);
}

KrylovReport PackedSystem::solve(const BorderedVector& rhs, BorderedVector& x, const Goal& goal,
                                 const CoupledOptions& options, CoupledReport& report, KrylovPast past) {
  KrylovOptions k;
  k.absolute_tolerance = goal.residual;
  k.relative_tolerance = goal.part;
  k.guess_tolerance = goal.of_guess;
  k.maximum_iterations = options.maximum_iterations;
  // Where viscosities differ by orders of magnitude every direction counts.
  if (!problem_->cell_viscosity.empty()) k.shortest_cycle = k.longest_cycle;
  const KrylovReport done = krylov_.solve(maps(rhs), split(x), k, past);
  report.iterations += done.iterations;
  ++report.solves;
  if (iterations_ == 0 && done.iterations > 0 && done.residual > 0.0) {
    iterations_ = done.iterations;
    decades_ = std::log10(done.initial_residual / done.residual);
  }
  return done;
}

}  // namespace monolith
