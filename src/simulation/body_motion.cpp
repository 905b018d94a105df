#include "simulation/body_motion.h"

#include "rigid/rotation.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

double approach(const std::vector<RigidBody>& bodies, const Contact& c) {
  double rate = bodies[c.body_a].velocityAt(c.point).dot(c.normal);
  if (c.body_b != Contact::kWall) rate -= bodies[c.body_b].velocityAt(c.point).dot(c.normal);
  return rate;
}

// Marks the bodies of a contact that fits, and all that hang together with them by contacts.
template <class Predicate>
std::vector<char> markBodies(std::size_t count, const std::vector<Contact>& contacts, const Predicate& fits) {
  std::vector<char> marked(count, 0);
  for (const Contact& c : contacts) {
    if (!fits(c)) continue;
    marked[c.body_a] = 1;
    if (c.body_b != Contact::kWall) marked[c.body_b] = 1;
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const Contact& c : contacts) {
      if (c.body_b == Contact::kWall || marked[c.body_a] == marked[c.body_b]) continue;
      marked[c.body_a] = marked[c.body_b] = 1;
      changed = true;
    }
  }
  return marked;
}

}  // namespace

std::vector<char> closingBodies(const std::vector<RigidBody>& bodies, const std::vector<Contact>& contacts, double dt,
                                double gap_tolerance) {
  return markBodies(bodies.size(), contacts, [&](const Contact& c) {
    const double rate = approach(bodies, c);
    return rate < 0.0 && c.gap + dt * rate < -gap_tolerance;
  });
}

std::vector<char> touchingBodies(std::size_t count, const std::vector<Contact>& contacts, double gap_tolerance) {
  return markBodies(count, contacts, [&](const Contact& c) { return c.gap <= gap_tolerance; });
}

namespace {

// Where a point of the body goes.
Vector3d carriedPoint(const RigidBody& from, const RigidBody& to, const Vector3d& point) {
  return to.p_WBcm + to.q_WB * (from.q_WB.conjugate() * (point - from.p_WBcm));
}

void movePoints(const std::vector<RigidBody>& from, const std::vector<RigidBody>& to, std::vector<Contact>& contacts) {
  for (Contact& c : contacts) {
    const Vector3d a = carriedPoint(from[c.body_a], to[c.body_a], c.point);
    c.point = c.body_b == Contact::kWall ? a : 0.5 * (a + carriedPoint(from[c.body_b], to[c.body_b], c.point));
  }
}

}  // namespace

BodyPlan planEuler(const std::vector<RigidBody>& bodies, const Vector3d& gravity, const std::vector<Wrench>& wrenches,
                   double time, double dt) {
  BodyPlan plan;
  plan.bodies = bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidBody& body = bodies[b];
    plan.free_twists.push_back(body.motion == BodyMotion::kFree         ? freeTwist(body, gravity, wrenches[b], dt)
                               : body.motion == BodyMotion::kPrescribed ? prescribedTwist(body, time + 0.5 * dt)
                                                                        : Vector6d(Vector6d::Zero()));
  }
  return plan;
}

BodyPlan planSecondOrder(const std::vector<RigidBody>& bodies, const Vector3d& gravity,
                         const std::vector<Wrench>& wrenches, const BodyPast& past, double time,
                         const StepWeights& weights, const std::vector<char>& closing,
                         const std::vector<char>& by_euler, std::vector<Contact>& contacts) {
  const double dt = weights.dt;
  BodyPlan plan;
  plan.bodies = bodies;
  plan.by_euler = by_euler;
  plan.closing = closing;
  plan.free_twists.assign(bodies.size(), Vector6d::Zero());
  plan.motion.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    RigidBody& body = plan.bodies[b];
    if (body.motion == BodyMotion::kPrescribed) {
      // The pose by the twist half-way, the velocity of the end.
      body.twist = prescribedTwist(body, time + 0.5 * dt);
      advancePose(body, dt);
      body.twist = prescribedTwist(body, time + dt);
      plan.free_twists[b] = body.twist;
      plan.motion[b].q_WB = body.q_WB;
      // Liquid that sticks to it brings what the body had.
      body.twist = bodies[b].twist + weights.carry * dt * past.acceleration[b];
    }
    if (body.motion != BodyMotion::kFree) continue;
    Wrench held = wrenches[b];
    held.force += weights.carry * past.liquid[b].force;
    held.torque += weights.carry * past.liquid[b].torque;
    if (plan.by_euler[b]) {
      plan.free_twists[b] = freeTwist(body, gravity, held, dt);
      continue;
    }
    const Vector3d expected = (1.0 - weights.carry) * past.liquid[b].torque + past.contact[b].torque;
    plan.motion[b] = freeMotion(body, gravity, held, expected, dt);
    plan.free_twists[b] = plan.motion[b].twist;
    advancePose(body, dt);
    body.twist += weights.carry * dt * past.acceleration[b];
  }
  movePoints(bodies, plan.bodies, contacts);
  return plan;
}

void finishEuler(const std::vector<Vector6d>& twists, double dt, std::vector<RigidBody>& bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].twist = twists[b];
    advancePose(bodies[b], dt);
  }
}

void finishSecondOrder(const BodyPlan& plan, const std::vector<Vector6d>& twists, double dt,
                       std::vector<RigidBody>& bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    RigidBody& body = bodies[b];
    if (body.motion == BodyMotion::kPrescribed) {
      body.p_WBcm = plan.bodies[b].p_WBcm;
      body.q_WB = plan.bodies[b].q_WB;
      body.twist = twists[b];
    } else if (plan.by_euler[b]) {
      // What touches and does not close goes on touching by the mean of both twists, too, and slides or rolls as far as
      // it should.
      body.twist = plan.closing[b] ? twists[b] : Vector6d(0.5 * (body.twist + twists[b]));
      advancePose(body, dt);
      body.twist = twists[b];
    } else if (body.motion == BodyMotion::kFree) {
      finishMotion(plan.motion[b], twists[b], dt, body);
    }
  }
}

}  // namespace monolith
