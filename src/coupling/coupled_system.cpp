#include "coupling/coupled_system.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "coupling/body_schur.h"
#include "coupling/liquid_preconditioner.h"
#include "coupling/step_operator.h"
#include "coupling/sticking_liquid.h"
#include "solve/fgmres.h"
#include "solve/lcp.h"

namespace monolith {
namespace {

// Compliance of a contact relative to that of its bodies: keeps redundant contacts (four corners of a box) solvable
// and unique, at a penetration speed far below any tolerance.
constexpr double kContactCompliance = 1e-9;
// A body that is already inside another is pushed out by this part of its depth in one step.
constexpr double kRecovery = 0.5;
// The bodies' resistance is estimated anew when the solve takes this many times the iterations that it took when fresh...
constexpr double kStaleIterations = 1.4;
// ... or the viscous number has changed by this factor.
constexpr double kStaleNumber = 1.5;

// From this viscous number on a time step resolves the film between a body and the nearest faces: no slip there.
// Below, the liquid next to the body is free to slip and viscosity only drags it along.
constexpr double kStickingNumber = 0.05;

struct ContactRow {
  int a = 0;  // index among the free bodies, or -1
  int b = -1;
  Vector6d on_a = Vector6d::Zero();
  Vector6d on_b = Vector6d::Zero();
  double bias = 0.0;  // constraint: J v + bias >= 0, m/s
};

}  // namespace

struct CoupledSystem::Impl {
  MacGrid grid;
  StaggeredCoefficients<double> coefficients;
  BodyRows rows;
  std::vector<PressureRegion> regions;
  std::vector<StaggeredCoefficients<float>> levels;
  LiquidPreconditioner preconditioner;
  StepOperator op;
  Fgmres krylov;
  const std::vector<RigidBody>* bodies = nullptr;
  double viscous_number = 0.0;
  double impulse_scale = 1.0;   // rho h^3: dimensionless impulse -> N s
  double pressure_scale = 1.0;  // rho h/dt: p^ -> Pa
  double dt = 1.0;
  std::vector<int> free;                     // bodies whose twist is unknown
  std::vector<int> free_index;               // body -> place in `free`, or -1
  std::vector<Eigen::DiagonalMatrix<double, 6>> scaling;  // Krylov unknown = scaling * twist
  std::vector<Matrix6d> inertia;             // M^ of free bodies with the liquid that sticks to them
  std::vector<Matrix6d> solid_inertia;       // M^ of free bodies by themselves
  std::vector<StickingLiquid> sticking;      // fraction is that of liquid: times W_L
  Eigen::MatrixXd resistance;                // of `free`, see BodySchur
  std::vector<int> resistance_of;
  double resistance_number = -1.0;
  int fresh_iterations = 0;
  bool stale = true;
  StepVector in, out;

  std::size_t liquidSize() const { return 4 * grid.lattice.size; }

  void updateResistance() {
    const bool same = resistance_of == free && resistance_number >= 0.0 &&
                      viscous_number <= kStaleNumber * resistance_number &&
                      resistance_number <= kStaleNumber * viscous_number && !stale;
    if (same) return;
    resistance = BodySchur::resistance(op, preconditioner, grid.lattice, bodies->size(), free);
    resistance_of = free;
    resistance_number = viscous_number;
    fresh_iterations = 0;
    stale = false;
  }

  // Inertia plus resistance in Krylov units.
  Eigen::MatrixXd schur() const {
    const auto n = static_cast<Eigen::Index>(6 * free.size());
    Eigen::MatrixXd S = resistance;
    Eigen::VectorXd inverse(n);
    for (std::size_t i = 0; i < free.size(); ++i) {
      S.block<6, 6>(6 * i, 6 * i) += inertia[i];
      inverse.segment<6>(6 * i) = scaling[i].diagonal().cwiseInverse();
    }
    return inverse.asDiagonal() * S * inverse.asDiagonal();
  }

  // Krylov vector <-> fields. Tail: bodies, then active contacts.
  void unpack(const std::vector<double>& x, StepVector& v) const {
    const std::size_t size = grid.lattice.size;
    for (int a = 0; a < 3; ++a) std::copy_n(x.begin() + a * size, size, v.velocity[a].begin());
    std::copy_n(x.begin() + 3 * size, size, v.pressure.begin());
    for (auto& twist : v.bodies) twist.setZero();
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Eigen::Map<const Vector6d> part(x.data() + liquidSize() + 6 * i);
      v.bodies[free[i]] = scaling[i].inverse() * part;
    }
  }
  void pack(const StepVector& v, std::vector<double>& x, bool forces) const {
    const std::size_t size = grid.lattice.size;
    for (int a = 0; a < 3; ++a) std::copy_n(v.velocity[a].begin(), size, x.begin() + a * size);
    std::copy_n(v.pressure.begin(), size, x.begin() + 3 * size);
    for (std::size_t i = 0; i < free.size(); ++i) {
      Eigen::Map<Vector6d> part(x.data() + liquidSize() + 6 * i);
      part = forces ? Vector6d(scaling[i].inverse() * v.bodies[free[i]]) : Vector6d(scaling[i] * v.bodies[free[i]]);
    }
  }

  std::vector<ContactRow> contactRows(const std::vector<Contact>& contacts, const std::vector<Vector6d>& twists) const {
    std::vector<ContactRow> out_rows;
    for (const Contact& contact : contacts) {
      ContactRow row;
      row.bias = contact.gap * (contact.gap < 0.0 ? kRecovery : 1.0) / dt;
      const auto add = [&](int body, double sign, int& place, Vector6d& coefficient) {
        place = -1;
        if (body == Contact::kWall) return;
        Vector6d J;
        J.head<3>() = sign * contact.normal;
        J.tail<3>() = sign * (contact.point - (*bodies)[body].p_WBcm).cross(contact.normal);
        place = free_index[body];
        if (place < 0) {
          row.bias += J.dot(twists[body]);
        } else {
          coefficient = scaling[place].inverse() * J;
        }
      };
      add(contact.body_a, 1.0, row.a, row.on_a);
      add(contact.body_b, -1.0, row.b, row.on_b);
      out_rows.push_back(row);
    }
    return out_rows;
  }

  Eigen::MatrixXd contactJacobian(const std::vector<ContactRow>& contacts) const {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(contacts.size()),
                                              static_cast<Eigen::Index>(6 * free.size()));
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      if (contacts[c].a >= 0) J.block<1, 6>(c, 6 * contacts[c].a) += contacts[c].on_a.transpose();
      if (contacts[c].b >= 0) J.block<1, 6>(c, 6 * contacts[c].b) += contacts[c].on_b.transpose();
    }
    return J;
  }

  // Sealed regions: the prescribed flux must leave the volume as it is; round-off is removed from the right side.
  std::string balanceSealedRegions(std::vector<double>& rhs) const {
    const std::size_t offset = 3 * grid.lattice.size;
    for (const PressureRegion& region : regions) {
      if (!region.null_mode) continue;
      double sum = 0.0, size = 0.0;
      for (const auto c : region.cells) {
        sum += rhs[offset + c];
        size += std::abs(rhs[offset + c]);
      }
      if (std::abs(sum) > 1e-7 * size && size > 1e-12) {
        std::ostringstream text;
        text << "a sealed region of liquid (" << region.cells.size() << " cells, "
             << static_cast<double>(region.cells.size()) * grid.cellVolume() << " m^3) would have to change its volume by "
             << sum * grid.h * grid.h << " m^3/s under the prescribed motion of";
        std::vector<char> named(bodies->size(), 0);
        std::vector<char> inside(grid.lattice.size, 0);
        for (const auto c : region.cells) inside[c] = 1;
        for (const BodyRow& row : rows.divergence) {
          if (!inside[row.sample] || named[row.body] || free_index[row.body] >= 0) continue;
          named[row.body] = 1;
          text << " '" << (*bodies)[row.body].name << "'";
        }
        text << "; an incompressible liquid cannot";
        return text.str();
      }
      for (const auto c : region.cells) rhs[offset + c] -= sum / static_cast<double>(region.cells.size());
    }
    return {};
  }
};

CoupledSystem::CoupledSystem(const MacGrid& grid) : impl_(std::make_unique<Impl>()) { impl_->grid = grid; }
CoupledSystem::~CoupledSystem() = default;

const StaggeredCoefficients<double>& CoupledSystem::coefficients() const { return impl_->coefficients; }
const BodyRows& CoupledSystem::bodyRows() const { return impl_->rows; }

double CoupledSystem::stickingEnergy(const std::vector<Vector6d>& twists) const {
  double sum = 0.0;
  for (const StickingLiquid& s : impl_->sticking) {
    const double u = velocityRow(s.axis, s.position, (*impl_->bodies)[s.body].p_WBcm).dot(twists[s.body]);
    sum += 0.5 * s.fraction * u * u;
  }
  return impl_->impulse_scale * sum;
}

Eigen::Vector3d CoupledSystem::stickingMomentum(const std::vector<Vector6d>& twists) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const StickingLiquid& s : impl_->sticking) {
    sum[s.axis] += s.fraction * velocityRow(s.axis, s.position, (*impl_->bodies)[s.body].p_WBcm).dot(twists[s.body]);
  }
  return impl_->impulse_scale * sum;
}

int CoupledSystem::coupledBodies() const {
  std::vector<char> coupled(impl_->free_index.size(), 0);
  for (const BodyRow& row : impl_->rows.divergence) coupled[row.body] = 1;
  return static_cast<int>(std::count(coupled.begin(), coupled.end(), 1));
}

void CoupledSystem::assemble(SolidFractions& solids, const std::vector<RigidBody>& bodies,
                             const std::vector<double>& liquid_distance, double density, double viscosity, double dt) {
  Impl& m = *impl_;
  const MacGrid& grid = m.grid;
  m.bodies = &bodies;
  m.dt = dt;
  m.viscous_number = viscosity * dt / (density * grid.h * grid.h);
  m.impulse_scale = density * grid.cellVolume();
  m.pressure_scale = density * grid.h / dt;

  m.sticking.clear();
  if (m.viscous_number >= kStickingNumber) {
    attachStickingLiquid(grid, solids, m.sticking);
    for (StickingLiquid& s : m.sticking) {
      s.fraction *= liquidPart(liquid_distance[s.face - grid.lattice.stride[s.axis]], liquid_distance[s.face]);
    }
  }
  const StokesGeometry geometry{&solids.fluid, &solids.distance, &liquid_distance};
  buildCoefficients(grid.lattice, geometry, m.viscous_number, m.coefficients);
  buildBodyRows(grid, solids, bodies, geometry, m.coefficients, m.rows);
  m.op.set(&m.coefficients, &m.rows);

  std::vector<char> moves(bodies.size(), 0);
  m.free.clear();
  m.free_index.assign(bodies.size(), -1);
  m.scaling.clear();
  m.inertia.clear();
  m.solid_inertia.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].motion != BodyMotion::kFree) continue;
    moves[b] = 1;
    m.free_index[b] = static_cast<int>(m.free.size());
    m.free.push_back(static_cast<int>(b));
    Matrix6d M = Matrix6d::Zero();
    M.topLeftCorner<3, 3>() = bodies[b].mass * Eigen::Matrix3d::Identity();
    M.bottomRightCorner<3, 3>() = bodies[b].worldInertia();
    M /= m.impulse_scale;
    m.inertia.push_back(M);
    m.solid_inertia.push_back(M);
    // A light body moves with the liquid that it displaces: that is its scale then.
    double displaced = 0.0;
    for (const double part : solids.bodies[b].cell) displaced += part;
    const double radius2 = std::pow(3.0 * displaced / (4.0 * M_PI), 2.0 / 3.0) * grid.h * grid.h;
    Vector6d scale;
    for (int d = 0; d < 6; ++d) scale[d] = std::sqrt(M(d, d) + displaced * (d < 3 ? 1.0 : 0.4 * radius2));
    m.scaling.emplace_back(scale);
  }
  for (const StickingLiquid& s : m.sticking) {
    if (m.free_index[s.body] < 0) continue;
    const Vector6d row = velocityRow(s.axis, s.position, bodies[s.body].p_WBcm);
    m.inertia[m.free_index[s.body]] += s.fraction * row * row.transpose();
  }
  m.regions = findPressureRegions(m.coefficients, m.rows, moves);

  std::vector<StaggeredCoefficients<float>> levels = m.preconditioner.takeLevels();
  if (levels.empty()) levels.resize(1);
  buildCoarseLevels(grid.lattice, geometry, m.viscous_number, levels);
  levels[0] = convertCoefficients<float>(m.coefficients);
  m.preconditioner.set(std::move(levels), m.viscous_number, &m.regions);
}

CoupledReport CoupledSystem::solve(const FaceField<double>& free_velocity, const std::vector<Vector6d>& free_twists,
                                   const std::vector<Contact>& contacts, const Eigen::Vector3d& gravity,
                                   const CoupledOptions& options, CoupledState& state) {
  Impl& m = *impl_;
  const Lattice& l = m.grid.lattice;
  const std::size_t liquid = m.liquidSize();
  const std::size_t tail = liquid + 6 * m.free.size();
  const std::size_t body_count = m.bodies->size();
  CoupledReport report;
  m.in.resize(l, body_count);
  m.out.resize(l, body_count);

  // Right side: momentum of liquid and bodies, less what the prescribed motions do.
  std::vector<double> rhs(tail, 0.0);
  StepVector prescribed;
  prescribed.resize(l, body_count);
  bool any_prescribed = false;
  for (std::size_t b = 0; b < body_count; ++b) {
    if (m.free_index[b] >= 0 || free_twists[b].isZero(0.0)) continue;
    prescribed.bodies[b] = free_twists[b];
    any_prescribed = true;
  }
  if (any_prescribed) {
    m.op.apply(prescribed, m.out);
    for (auto& field : m.out.velocity) clearHalo(l, field);
    clearHalo(l, m.out.pressure);
    for (int a = 0; a < 3; ++a) {
      for (std::size_t i = 0; i < l.size; ++i) rhs[a * l.size + i] = -m.out.velocity[a][i];
    }
    for (std::size_t i = 0; i < l.size; ++i) rhs[3 * l.size + i] = -m.out.pressure[i];
  }
  for (int a = 0; a < 3; ++a) {
    std::vector<double> mass = m.coefficients.mass[a];
    clearHalo(l, mass);
    for (std::size_t i = 0; i < l.size; ++i) rhs[a * l.size + i] += mass[i] * free_velocity[a][i];
  }
  // The sticking liquid has moved with its body: its momentum is not that of the face, which is slower.
  const auto stickingVelocity = [&](const StickingLiquid& s, const Vector6d& row) {
    return row.dot((*m.bodies)[s.body].twist) + m.dt * gravity[s.axis];
  };
  // Momentum of the bodies by themselves, and that of the liquid which sticks to them.
  std::vector<Vector6d> momentum(body_count, Vector6d::Zero());
  for (std::size_t i = 0; i < m.free.size(); ++i) momentum[m.free[i]] = m.solid_inertia[i] * free_twists[m.free[i]];
  for (const StickingLiquid& s : m.sticking) {
    const Vector6d row = velocityRow(s.axis, s.position, (*m.bodies)[s.body].p_WBcm);
    momentum[s.body] += s.fraction * stickingVelocity(s, row) * row;
  }
  for (std::size_t i = 0; i < m.free.size(); ++i) {
    Eigen::Map<Vector6d> part(rhs.data() + liquid + 6 * i);
    Vector6d force = momentum[m.free[i]];
    if (any_prescribed) force -= m.out.bodies[m.free[i]];
    part = m.scaling[i].inverse() * force;
  }
  report.message = m.balanceSealedRegions(rhs);
  if (!report.message.empty()) {
    report.status = CoupledReport::Status::kInconsistent;
    return report;
  }
  double rhs_norm = 0.0;
  for (const double r : rhs) rhs_norm += r * r;
  rhs_norm = std::sqrt(rhs_norm);

  // Initial guess.
  std::vector<double> x(tail, 0.0);
  for (int a = 0; a < 3; ++a) {
    std::vector<double> start = state.velocity[a];
    clearHalo(l, start);
    for (std::size_t i = 0; i < l.size; ++i) {
      m.in.velocity[a][i] = m.coefficients.mass[a][i] > 0.0 ? start[i] : 0.0;
    }
    clearHalo(l, m.in.velocity[a]);
  }
  for (std::size_t i = 0; i < l.size; ++i) {
    m.in.pressure[i] = m.coefficients.has_pressure[i] ? state.pressure[i] / m.pressure_scale : 0.0;
  }
  clearHalo(l, m.in.pressure);
  m.in.bodies = state.twists;
  m.pack(m.in, x, false);

  m.updateResistance();
  const Eigen::MatrixXd S = m.schur();
  const std::vector<ContactRow> contact_rows = m.contactRows(contacts, free_twists);
  const Eigen::MatrixXd J = m.contactJacobian(contact_rows);
  const auto n_contacts = static_cast<Eigen::Index>(contact_rows.size());
  const auto n_bodies = static_cast<Eigen::Index>(6 * m.free.size());
  Eigen::VectorXd bias(n_contacts);
  for (Eigen::Index c = 0; c < n_contacts; ++c) bias[c] = contact_rows[c].bias;
  Eigen::MatrixXd K;  // contact compliance on the approximate Schur complement
  double compliance = 0.0;
  if (n_contacts > 0) {
    K = J * S.ldlt().solve(J.transpose());
    K = 0.5 * (K + K.transpose()).eval();
    compliance = kContactCompliance * std::max(K.diagonal().maxCoeff(), 1e-300);
    K.diagonal().array() += compliance;
  }

  std::vector<int> active;
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(n_contacts);
  Eigen::PartialPivLU<Eigen::MatrixXd> small;
  const auto factorSmall = [&] {
    const auto n_active = static_cast<Eigen::Index>(active.size());
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n_bodies + n_active, n_bodies + n_active);
    M.topLeftCorner(n_bodies, n_bodies) = S;
    for (Eigen::Index i = 0; i < n_active; ++i) {
      M.block(n_bodies + i, 0, 1, n_bodies) = -J.row(active[i]);
      M.block(0, n_bodies + i, n_bodies, 1) = -J.row(active[i]).transpose();
      M(n_bodies + i, n_bodies + i) = -compliance;
    }
    if (M.size() > 0) small.compute(M);
  };

  const LinearMap apply = [&](const std::vector<double>& from, std::vector<double>& to) {
    to.resize(from.size());
    m.unpack(from, m.in);
    m.op.apply(m.in, m.out);
    for (std::size_t i = 0; i < m.free.size(); ++i) m.out.bodies[m.free[i]] += m.inertia[i] * m.in.bodies[m.free[i]];
    for (auto& field : m.out.velocity) clearHalo(l, field);
    clearHalo(l, m.out.pressure);
    m.pack(m.out, to, true);
    const Eigen::Map<const Eigen::VectorXd> v(from.data() + liquid, n_bodies);
    Eigen::Map<Eigen::VectorXd> force(to.data() + liquid, n_bodies);
    for (std::size_t i = 0; i < active.size(); ++i) {
      force -= J.row(active[i]).transpose() * from[tail + i];
      to[tail + i] = -J.row(active[i]).dot(v) - compliance * from[tail + i];
    }
  };
  const LinearMap precondition = [&](const std::vector<double>& from, std::vector<double>& to) {
    to.resize(from.size());
    m.unpack(from, m.in);
    m.preconditioner.apply(m.in, m.out);
    // Bodies feel what the liquid has just been given.
    m.op.bodyForces(m.out, m.in.bodies);
    for (auto& field : m.out.velocity) clearHalo(l, field);
    clearHalo(l, m.out.pressure);
    m.pack(m.out, to, false);
    const auto n = n_bodies + static_cast<Eigen::Index>(active.size());
    if (n == 0) return;
    Eigen::VectorXd r = Eigen::Map<const Eigen::VectorXd>(from.data() + liquid, n);
    for (std::size_t i = 0; i < m.free.size(); ++i) {
      r.segment<6>(6 * i) -= m.scaling[i].inverse() * m.in.bodies[m.free[i]];
    }
    Eigen::Map<Eigen::VectorXd>(to.data() + liquid, n) = small.solve(r);
  };

  // Which contacts press, from an approach velocity J v + bias at impulses lambda.
  const auto pressing = [&](const Eigen::VectorXd& v, LcpReport& lcp) {
    Eigen::VectorXd q = J * v + bias + compliance * lambda - K * lambda;
    Eigen::VectorXd next;
    lcp = solveLcp(K, q, next);
    std::vector<int> set;
    for (Eigen::Index c = 0; c < n_contacts; ++c) {
      if (next[c] > 0.0) set.push_back(static_cast<int>(c));
    }
    return set;
  };

  KrylovOptions krylov;
  krylov.absolute_tolerance = options.tolerance * rhs_norm;
  krylov.maximum_iterations = options.maximum_iterations;
  if (n_contacts > 0) {
    // One cycle on the whole residual says roughly how the bodies would move without contact.
    factorSmall();
    std::vector<double> r(tail), z(tail);
    apply(x, r);
    for (std::size_t i = 0; i < tail; ++i) r[i] = rhs[i] - r[i];
    precondition(r, z);
    const Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(x.data() + liquid, n_bodies) +
                              Eigen::Map<const Eigen::VectorXd>(z.data() + liquid, n_bodies);
    LcpReport lcp;
    active = pressing(v, lcp);
  }
  bool settled = false;
  KrylovReport last;
  for (int round = 0; round < options.maximum_rounds && !settled; ++round) {
    factorSmall();
    rhs.resize(tail + active.size());
    x.resize(tail + active.size());
    for (std::size_t i = 0; i < active.size(); ++i) {
      rhs[tail + i] = bias[active[i]];
      x[tail + i] = lambda[active[i]];
    }
    last = m.krylov.solve(apply, precondition, rhs, x, krylov);
    report.iterations += last.iterations;
    ++report.solves;
    if (!last.converged) break;
    lambda.setZero();
    for (std::size_t i = 0; i < active.size(); ++i) lambda[active[i]] = x[tail + i];
    if (n_contacts == 0) {
      settled = true;
      break;
    }
    const Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(x.data() + liquid, n_bodies);
    const Eigen::VectorXd w = J * v + bias;
    // Complementarity to the solve's own accuracy.
    const double speed_tolerance = 1e-9 + 10.0 * options.tolerance * (bias.cwiseAbs().maxCoeff() + w.cwiseAbs().maxCoeff());
    const double impulse_tolerance = 10.0 * options.tolerance * std::max(lambda.cwiseAbs().maxCoeff(), 1e-300);
    settled = lambda.minCoeff() >= -impulse_tolerance;
    std::vector<char> is_active(n_contacts, 0);
    for (const int c : active) is_active[c] = 1;
    for (Eigen::Index c = 0; c < n_contacts; ++c) settled = settled && (is_active[c] || w[c] >= -speed_tolerance);
    if (settled) break;
    LcpReport lcp;
    std::vector<int> next = pressing(v, lcp);
    if (next == active || !lcp.solved) {
      // The approximate compliance sees no change: drop what pulls, add what penetrates.
      next.clear();
      for (Eigen::Index c = 0; c < n_contacts; ++c) {
        if (is_active[c] ? lambda[c] > 0.0 : w[c] < -speed_tolerance) next.push_back(static_cast<int>(c));
      }
    }
    active = next;
  }

  report.residual = rhs_norm > 0.0 ? last.residual / rhs_norm : 0.0;
  if (!settled || !std::isfinite(last.residual)) {
    m.stale = true;
    report.status = CoupledReport::Status::kNotConverged;
    std::ostringstream text;
    if (!last.converged) {
      text << "the coupled solve stopped at a relative residual of " << report.residual << " after " << last.iterations
           << " iterations; wanted " << options.tolerance;
    } else {
      text << "the set of pressing contacts did not settle in " << report.solves << " solves (" << n_contacts
           << " contacts)";
    }
    report.message = text.str();
    return report;
  }
  if (report.solves > 0 && n_bodies > 0) {
    const int iterations = report.iterations / report.solves;
    if (m.fresh_iterations == 0) m.fresh_iterations = std::max(iterations, 5);
    m.stale = iterations > kStaleIterations * m.fresh_iterations + 1;
  }

  // The solution, the forces that it implies on every body, and its divergence.
  m.unpack(x, m.in);
  for (std::size_t b = 0; b < body_count; ++b) {
    if (m.free_index[b] < 0) m.in.bodies[b] = free_twists[b];
  }
  m.op.apply(m.in, m.out);
  for (const double d : m.out.pressure) report.divergence = std::max(report.divergence, std::abs(d) / m.grid.h);
  state.velocity = m.in.velocity;
  for (std::size_t i = 0; i < l.size; ++i) state.pressure[i] = m.in.pressure[i] * m.pressure_scale;
  state.twists = m.in.bodies;
  state.liquid.assign(body_count, Wrench());
  state.contact.assign(body_count, Wrench());
  const double force_scale = m.impulse_scale / m.dt;
  for (const StickingLiquid& s : m.sticking) {
    const Vector6d row = velocityRow(s.axis, s.position, (*m.bodies)[s.body].p_WBcm);
    m.out.bodies[s.body] += s.fraction * (row.dot(m.in.bodies[s.body]) - stickingVelocity(s, row)) * row;
  }
  for (std::size_t b = 0; b < body_count; ++b) {
    state.liquid[b].force = -force_scale * m.out.bodies[b].head<3>();
    state.liquid[b].torque = -force_scale * m.out.bodies[b].tail<3>();
  }
  for (Eigen::Index c = 0; c < n_contacts; ++c) {
    const Eigen::Vector3d force = force_scale * std::max(lambda[c], 0.0) * contacts[c].normal;
    const auto push = [&](int body, const Eigen::Vector3d& f) {
      if (body == Contact::kWall) return;
      state.contact[body].force += f;
      state.contact[body].torque += (contacts[c].point - (*m.bodies)[body].p_WBcm).cross(f);
    };
    push(contacts[c].body_a, force);
    push(contacts[c].body_b, -force);
  }
  report.status = CoupledReport::Status::kConverged;
  return report;
}


}  // namespace monolith
