#include "coupling/contact_rows.h"

#include <map>

namespace monolith {
namespace {

// A body that is already inside another is pushed out by this part of its depth in one step, or in this time (s) if
// that is longer: the speed that it takes stays.
constexpr double kRecovery = 0.5;
constexpr double kRecoveryTime = 0.02;
// Contacts of two steps are the same one if they are closer than this and push in about the same direction.
constexpr double kSamePlace = 0.5;   // cell widths
constexpr double kSameNormal = 0.9;  // cosine
// What is prescribed may leave another body no room, and the impulses that jam it grow until the contacts' compliance
// lets them: so large that round-off of the normals would throw it aside. This much softer it only gives way; a contact
// that can hold gives by less than any tolerance still.
constexpr double kSoftness = 1000.0;

// Two directions normal to n, the same for the same n.
Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector3d& n) {
  Eigen::Index least;
  n.cwiseAbs().minCoeff(&least);
  Eigen::Matrix<double, 3, 2> t;
  t.col(0) = n.cross(Eigen::Vector3d::Unit(least)).normalized();
  t.col(1) = n.cross(t.col(0));
  return t;
}

// m/s, that a gap (m) lets its contact close with.
double gapBias(double gap, double dt) { return gap < 0.0 ? kRecovery * gap / std::max(dt, kRecoveryTime) : gap / dt; }

}  // namespace

ContactRows buildContactRows(const StepProblem& problem, const std::vector<Contact>& contacts,
                             const std::vector<ContactLaw>& laws, const std::vector<JointStop>& stops,
                             double resting_speed) {
  const auto m = static_cast<Eigen::Index>(contacts.size() + stops.size());
  ContactRows out;
  out.stops = stops;
  Eigen::MatrixXd of_twists = Eigen::MatrixXd::Zero(3 * m, problem.coordinates.S().rows());
  out.bias = Eigen::VectorXd::Zero(3 * m);
  out.friction = Eigen::VectorXd::Zero(m);
  out.softness = Eigen::VectorXd::Ones(3 * m);
  std::map<std::pair<int, int>, int> pairs;
  for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(contacts.size()); ++c) {
    const Contact& contact = contacts[c];
    const auto number = static_cast<int>(pairs.size());
    out.pair.push_back(pairs.try_emplace({contact.body_a, contact.body_b}, number).first->second);
    out.friction[c] = laws[c].friction;
    out.tangents.push_back(tangentBasis(contact.normal));
    const Eigen::Index row[3] = {c, m + 2 * c, m + 2 * c + 1};
    const Eigen::Vector3d axis[3] = {contact.normal, out.tangents[c].col(0), out.tangents[c].col(1)};
    double approach = 0.0;  // gap rate at the start of the step
    for (const auto& [body, sign] : {std::pair(contact.body_a, 1.0), std::pair(contact.body_b, -1.0)}) {
      if (body == Contact::kWall) continue;
      const Eigen::Vector3d point = sign > 0.0 ? contact.point : contact.pointOnB();
      const RigidBody& rigid = (*problem.bodies)[body];
      approach += sign * rigid.velocityAt(point).dot(contact.normal);
      if (rigid.motion == BodyMotion::kPrescribed) {
        for (const Eigen::Index i : row) out.softness[i] = kSoftness;
      }
      for (int d = 0; d < 3; ++d) {
        Vector6d j;
        j.head<3>() = sign * axis[d];
        j.tail<3>() = sign * (point - rigid.p_WBcm).cross(axis[d]);
        const int place = problem.free_index[body];
        out.bias[row[d]] += j.dot(problem.given[body]);
        if (place >= 0) of_twists.block<1, 6>(row[d], 6 * place) += j.transpose();
      }
    }
    out.bias[c] += gapBias(contact.gap, problem.dt);
    // An impact within this step: it separates at the given part of its speed. What merely rests does not bounce.
    const bool closes = contact.gap + approach * problem.dt <= 0.0;
    if (laws[c].restitution > 0.0 && closes && approach < -resting_speed) {
      out.bias[c] = std::min(out.bias[c], 0.0) + laws[c].restitution * approach;
    }
  }
  out.J = of_twists * problem.coordinates.S();
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const auto c = static_cast<Eigen::Index>(contacts.size() + i);
    const JointStop& stop = stops[i];
    out.J.row(c) = stop.sign * stop.radius * Eigen::RowVectorXd(problem.coordinates.jointRow(stop.body).transpose());
    out.bias[c] = stop.radius * gapBias(stop.gap, problem.dt);
    out.pair.push_back(static_cast<int>(pairs.size() + i));
  }
  return out;
}

Eigen::VectorXd warmStart(const StepProblem& problem, const ContactRows& rows, const std::vector<Contact>& contacts,
                          const ContactForces& last_forces) {
  const std::vector<ContactForce>& last = last_forces.contacts;
  const Eigen::Index m = rows.count();
  Eigen::VectorXd r = Eigen::VectorXd::Zero(3 * m);
  const double impulse = problem.dt / problem.impulse_scale;
  std::vector<char> taken(last.size(), 0);  // no force counts twice
  for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(contacts.size()); ++c) {
    std::size_t at = last.size();
    double least = kSamePlace * problem.grid.h;
    for (std::size_t i = 0; i < last.size(); ++i) {
      const Contact& old = last[i].contact;
      if (taken[i] || old.body_a != contacts[c].body_a || old.body_b != contacts[c].body_b) continue;
      // In a corner one point touches several faces.
      if (old.normal.dot(contacts[c].normal) < kSameNormal) continue;
      const double distance = (old.point - contacts[c].point).norm();
      if (distance < least) {
        least = distance;
        at = i;
      }
    }
    if (at == last.size()) continue;
    taken[at] = 1;
    r[c] = impulse * last[at].normal;
    r.segment<2>(m + 2 * c) = impulse * rows.tangents[c].transpose() * last[at].friction;
  }
  for (std::size_t i = 0; i < rows.stops.size(); ++i) {
    const JointStop& stop = rows.stops[i];
    for (const StopForce& old : last_forces.stops) {
      if (old.body != stop.body || old.sign != stop.sign) continue;
      r[static_cast<Eigen::Index>(contacts.size() + i)] = impulse * old.effort / stop.radius;
    }
  }
  return r;
}

void distributeImpulses(const StepProblem& problem, const ContactRows& rows, const std::vector<Contact>& contacts,
                        const Eigen::VectorXd& r, ContactForces& forces, std::vector<Wrench>& wrenches) {
  const Eigen::Index m = rows.count();
  const double newton = problem.impulse_scale / problem.dt;
  forces = ContactForces();
  wrenches.assign(problem.bodies->size(), Wrench());
  for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(contacts.size()); ++c) {
    ContactForce at;
    at.contact = contacts[c];
    at.normal = newton * std::max(r[c], 0.0);
    at.friction = newton * rows.tangents[c] * r.segment<2>(m + 2 * c);
    const Eigen::Vector3d force = at.normal * contacts[c].normal + at.friction;
    for (const auto& [body, sign] : {std::pair(contacts[c].body_a, 1.0), std::pair(contacts[c].body_b, -1.0)}) {
      if (body == Contact::kWall) continue;
      const Eigen::Vector3d point = sign > 0.0 ? contacts[c].point : contacts[c].pointOnB();
      wrenches[body].force += sign * force;
      wrenches[body].torque += sign * (point - (*problem.bodies)[body].p_WBcm).cross(force);
    }
    forces.contacts.push_back(at);
  }
  for (std::size_t i = 0; i < rows.stops.size(); ++i) {
    const JointStop& stop = rows.stops[i];
    const double push = std::max(r[static_cast<Eigen::Index>(contacts.size() + i)], 0.0);
    forces.stops.push_back({stop.body, stop.sign, newton * stop.radius * push});
  }
}

}  // namespace monolith
