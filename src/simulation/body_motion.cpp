#include "simulation/body_motion.h"

#include <algorithm>
#include <limits>
#include <sstream>

#include "rigid/overlap.h"
#include "scene/joint_motion.h"

namespace monolith {
namespace {

using Eigen::Vector3d;

// Of the gap, m/s.
double gapRate(const std::vector<RigidBody>& bodies, const Contact& c) {
  double rate = bodies[c.body_a].velocityAt(c.point).dot(c.normal);
  if (c.body_b != Contact::kWall) rate -= bodies[c.body_b].velocityAt(c.pointOnB()).dot(c.normal);
  return rate;
}

// How much of the velocity before an impact the motion may have, in place of that after it.
double partBefore(const std::vector<RigidBody>& before, const std::vector<Contact>& contacts,
                  const std::vector<char>& closing, const std::vector<Vector6d>& twists, double dt) {
  std::vector<RigidBody> after = before;
  for (std::size_t b = 0; b < after.size(); ++b) after[b].twist = twists[b];
  double part = 0.5;
  for (const Contact& c : contacts) {
    if (!closing[c.body_a]) continue;
    const double rate = gapRate(after, c);
    const double change = gapRate(before, c) - rate;
    if (change >= 0.0) continue;
    part = std::min(part, std::max(0.0, (std::max(c.gap, 0.0) + dt * rate) / (-dt * change)));
  }
  return part;
}

}  // namespace

std::vector<char> closingBodies(const std::vector<RigidBody>& bodies, const std::vector<Contact>& contacts,
                                const std::vector<JointStop>& stops, double dt, double gap_tolerance) {
  std::vector<char> closing(bodies.size(), 0);
  for (const Contact& c : contacts) {
    const double rate = gapRate(bodies, c);
    if (rate >= 0.0 || c.gap + dt * rate >= -gap_tolerance) continue;
    closing[c.body_a] = 1;
    if (c.body_b != Contact::kWall) closing[c.body_b] = 1;
  }
  for (const JointStop& stop : stops) {
    const double rate = stop.radius * stop.sign * bodies[stop.body].joint_velocity;
    if (rate < 0.0 && stop.radius * stop.gap + dt * rate < -gap_tolerance) closing[stop.body] = 1;
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (!bodies[b].joint) continue;
      // What is not free does not pass a jump on.
      const int parent = bodies[b].joint->parent;
      if (closing[b] == closing[parent] || bodies[parent].motion != BodyMotion::kFree) continue;
      if (bodies[b].motion != BodyMotion::kFree) continue;
      closing[b] = closing[parent] = 1;
      changed = true;
    }
    for (const Contact& c : contacts) {
      if (c.body_b == Contact::kWall || closing[c.body_a] == closing[c.body_b]) continue;
      if (bodies[closing[c.body_a] ? c.body_a : c.body_b].motion != BodyMotion::kFree) continue;
      closing[c.body_a] = closing[c.body_b] = 1;
      changed = true;
    }
  }
  return closing;
}

namespace {

// With the centres of mass, by each contact's share: the lever arm of a body that rolls stays as it is. A point that
// lagged behind would push it on.
void movePoints(const std::vector<RigidBody>& from, const std::vector<RigidBody>& to, std::vector<Contact>& contacts) {
  const auto shift = [&](int body) -> Vector3d { return to[body].p_WBcm - from[body].p_WBcm; };
  const auto isFree = [&](int body) { return from[body].motion == BodyMotion::kFree; };
  for (Contact& c : contacts) {
    if (c.body_b == Contact::kWall) {
      c.point += shift(c.body_a);
      continue;
    }
    double share = c.share_a;
    if (share < 0.0) share = !isFree(c.body_a) ? 0.0 : !isFree(c.body_b) ? 1.0 : 0.5;
    c.point += share * shift(c.body_a) + (1.0 - share) * shift(c.body_b);
  }
}

// By what acts on it, or by joints.
bool isMoved(const RigidBody& body) { return body.motion == BodyMotion::kFree || body.joint.has_value(); }

// Bodies that joints connect.
std::vector<char> jointed(const std::vector<RigidBody>& bodies) {
  std::vector<char> out(bodies.size(), 0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].joint) out[b] = out[bodies[b].joint->parent] = 1;
  }
  return out;
}

// v* of a body that joints hold, in the pose that it is solved in: what `held` makes of its momentum and angular
// momentum; the joints' part is the solve's.
Vector6d heldTwist(const RigidBody& before, const RigidBody& after, const Vector3d& gravity, const Wrench& held,
                   double dt) {
  Vector6d twist;
  twist.head<3>() = before.twist.head<3>() + dt * (gravity + held.force / before.mass);
  const Vector3d spin = before.worldInertia() * before.twist.tail<3>() + dt * held.torque;
  twist.tail<3>() = after.worldInertia().ldlt().solve(spin);
  return twist;
}

}  // namespace

BodyPlan planEuler(const std::vector<RigidBody>& bodies, const Vector3d& gravity, const std::vector<Wrench>& wrenches,
                   double time, double dt) {
  BodyPlan plan;
  plan.bodies = bodies;
  const std::vector<char> held_by_joints = jointed(bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidBody& body = bodies[b];
    plan.free_twists.push_back(held_by_joints[b] && isMoved(body) ? heldTwist(body, body, gravity, wrenches[b], dt)
                               : body.motion == BodyMotion::kFree ? freeTwist(body, gravity, wrenches[b], dt)
                               : body.motion == BodyMotion::kPrescribed ? meanPrescribedTwist(body, time, dt)
                                                                        : Vector6d(Vector6d::Zero()));
    plan.joint_end.push_back(body.joint_position);
    if (body.joint && body.joint->prescribed) {
      const double mean = meanPrescribedVelocity(*body.joint->prescribed, time, dt);
      plan.bodies[b].joint_velocity = mean;
      plan.joint_end[b] += dt * mean;
    }
  }
  return plan;
}

BodyPlan planSecondOrder(const std::vector<RigidBody>& bodies, const Vector3d& gravity,
                         const std::vector<Wrench>& wrenches, const BodyPast& past, double time,
                         const StepWeights& weights, const std::vector<char>& closing, const Vector3d& period,
                         std::vector<Contact>& contacts) {
  const double dt = weights.dt;
  BodyPlan plan;
  plan.bodies = bodies;
  plan.closing = closing;
  plan.free_twists.assign(bodies.size(), Vector6d::Zero());
  plan.motion.resize(bodies.size());
  const std::vector<char> held_by_joints = jointed(bodies);
  std::vector<Wrench> holds(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    RigidBody& body = plan.bodies[b];
    plan.joint_end.push_back(body.joint_position);
    if (body.motion == BodyMotion::kPrescribed && !body.joint) {
      // The pose by the mean, the velocity of the end.
      body.twist = meanPrescribedTwist(body, time, dt);
      advancePose(body, dt);
      body.twist = prescribedTwist(body, time + dt);
      plan.free_twists[b] = body.twist;
      plan.motion[b].q_WB = body.q_WB;
      // Liquid that sticks to it brings what the body had.
      body.twist = bodies[b].twist + weights.carry * dt * past.acceleration[b];
    }
    if (!isMoved(body)) continue;
    const bool closes = plan.closing[b] && body.motion == BodyMotion::kFree;
    Wrench held = wrenches[b];
    held.force += weights.carry * past.liquid[b].force;
    held.torque += weights.carry * past.liquid[b].torque;
    held.force += weights.carry * past.joints[b].force;
    held.torque += weights.carry * past.joints[b].torque;
    if (body.joint && body.joint->prescribed) {
      const double mean = meanPrescribedVelocity(*body.joint->prescribed, time, dt);
      plan.joint_end[b] += dt * mean;
      body.joint_velocity = closes ? mean : prescribedVelocity(*body.joint->prescribed, time + dt);
      if (!closes) body.joint_position = plan.joint_end[b];
    } else if (body.joint && !closes) {
      body.joint_position += dt * body.joint_velocity;
    }
    holds[b] = held;
    if (closes) {
      if (!held_by_joints[b]) plan.free_twists[b] = freeTwist(body, gravity, held, dt);
      continue;
    }
    const Vector3d expected = (1.0 - weights.carry) * past.liquid[b].torque + past.contact[b].torque;
    if (held_by_joints[b]) {
      advancePose(body, dt);
      plan.motion[b].q_WB = body.q_WB;
      plan.motion[b].angular_velocity = body.twist.tail<3>();
    } else {
      plan.motion[b] = freeMotion(body, gravity, held, expected, dt);
      plan.free_twists[b] = plan.motion[b].twist;
      advancePose(body, dt);
    }
    body.twist += weights.carry * dt * past.acceleration[b];
  }
  placeOnJoints(period, plan.bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!held_by_joints[b] || !isMoved(bodies[b])) continue;
    plan.free_twists[b] = heldTwist(bodies[b], plan.bodies[b], gravity, holds[b], dt);
  }
  movePoints(bodies, plan.bodies, contacts);
  return plan;
}

namespace {

// `old_part` of the motion has the joint's velocity before, the rest the new one.
void finishJoint(const BodyPlan& plan, std::size_t b, const std::vector<Vector6d>& twists, double old_part, double dt,
                 RigidBody& body) {
  if (!body.joint) return;
  if (!body.joint->prescribed) {
    const double velocity = jointVelocity(plan.bodies, b, twists);
    body.joint_position += dt * (old_part * body.joint_velocity + (1.0 - old_part) * velocity);
    body.joint_velocity = velocity;
    return;
  }
  body.joint_position = plan.joint_end[b];
  body.joint_velocity = plan.bodies[b].joint_velocity;
}

// Bodies that joints hold, after their motion: to where the joints put them, with the angular momentum that they were
// solved for in other poses. Kept in place of it their rate would add to what they have, step after step.
void finishAssemblies(const BodyPlan& plan, const Vector3d& period, std::vector<RigidBody>& bodies) {
  placeOnJoints(period, bodies);
  const std::vector<char> held_by_joints = jointed(bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!held_by_joints[b] || !isMoved(bodies[b])) continue;
    const Vector3d spin = plan.bodies[b].worldInertia() * bodies[b].twist.tail<3>();
    bodies[b].twist.tail<3>() = bodies[b].worldInertia().ldlt().solve(spin);
  }
}

}  // namespace

void finishEuler(const BodyPlan& plan, const std::vector<Vector6d>& twists, double dt, const Vector3d& period,
                 std::vector<RigidBody>& bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    bodies[b].twist = twists[b];
    advancePose(bodies[b], dt);
    finishJoint(plan, b, twists, 0.0, dt, bodies[b]);
  }
  finishAssemblies(plan, period, bodies);
}

void finishSecondOrder(const BodyPlan& plan, const std::vector<Contact>& contacts, bool rebound,
                       const std::vector<Vector6d>& twists, double dt, const Vector3d& period,
                       std::vector<RigidBody>& bodies) {
  const double part = rebound ? partBefore(bodies, contacts, plan.closing, twists, dt) : 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    RigidBody& body = bodies[b];
    if (body.motion == BodyMotion::kPrescribed) {
      body.p_WBcm = plan.bodies[b].p_WBcm;
      body.q_WB = plan.bodies[b].q_WB;
      body.twist = twists[b];
    } else if (plan.closing[b]) {
      body.twist = part * body.twist + (1.0 - part) * twists[b];
      advancePose(body, dt);
      body.twist = twists[b];
    } else if (body.motion == BodyMotion::kFree) {
      finishMotion(plan.motion[b], twists[b], dt, body);
    }
    finishJoint(plan, b, twists, plan.closing[b] ? part : 0.5, dt, body);
  }
  finishAssemblies(plan, period, bodies);
}

namespace {

constexpr double kGivesWay = 2.0;  // what is wedged may move that much faster than what presses it

// How far a body reaches out of a wall at most, m, and of which.
struct WallIntrusion {
  double depth = -std::numeric_limits<double>::infinity();
  std::string wall;
};

WallIntrusion deepestInWalls(const RigidBody& body, const TankWalls& walls) {
  Eigen::AlignedBox3d box;
  for (const Shape& shape : body.shapes) box.extend(bounds(shape, body.pose()));
  WallIntrusion deepest;
  forEachWallDepth(walls, box, [&](const std::string& wall, double depth) {
    if (!(depth <= deepest.depth)) deepest = {depth, wall};  // not a number: as deep as can be
  });
  return deepest;
}

// By the sphere around its centre of mass: nearly always enough to tell, and cheap.
bool mayReachOut(const RigidBody& body, const TankWalls& walls, double allowed) {
  const Vector3d reach = Vector3d::Constant(body.radius() - allowed);
  const Vector3d least = body.p_WBcm - reach, most = body.p_WBcm + reach;
  for (int axis = 0; axis < 3; ++axis) {
    if (walls.periodic[axis]) continue;
    if (!(least[axis] >= walls.inside.min()[axis] && most[axis] <= walls.inside.max()[axis])) return true;
  }
  return false;
}

// How far prescribed bodies that touch a body, by way of others or not, may press it, m.
std::vector<double> pressedBy(const std::vector<Contact>& contacts, const std::vector<RigidBody>& before,
                              const std::vector<RigidBody>& after) {
  std::vector<double> pressed(after.size(), 0.0);
  for (std::size_t b = 0; b < after.size(); ++b) {
    if (after[b].motion == BodyMotion::kPrescribed) pressed[b] = kGivesWay * after[b].distanceFrom(before[b].pose());
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const Contact& c : contacts) {
      if (c.body_b == Contact::kWall) continue;
      for (const auto& [body, other] : {std::pair(c.body_a, c.body_b), std::pair(c.body_b, c.body_a)}) {
        if (after[body].motion != BodyMotion::kFree || pressed[body] >= pressed[other]) continue;
        pressed[body] = pressed[other];
        changed = true;
      }
    }
  }
  return pressed;
}

std::string intrusion(const std::string& what, double depth, double allowed) {
  std::ostringstream text;
  text << what << " by " << depth << " m: expected at most half a cell, " << allowed
       << " m; is what acts on it too strong for the time step, or has it no room?";
  return text.str();
}

}  // namespace

std::string describeIntrusion(const BodyPlan& plan, const std::vector<Contact>& contacts, const TankWalls& walls,
                              const std::vector<Vector6d>& twists, double dt, double allowed,
                              const std::vector<RigidBody>& before, const std::vector<RigidBody>& after) {
  const std::vector<double> pressed = pressedBy(contacts, before, after);
  for (std::size_t b = 0; b < after.size(); ++b) {
    if (after[b].motion != BodyMotion::kFree || !mayReachOut(after[b], walls, allowed)) continue;
    const auto [depth, wall] = deepestInWalls(after[b], walls);
    if (depth <= allowed || depth <= pressed[b] + deepestInWalls(before[b], walls).depth) continue;
    return intrusion("body '" + after[b].name + "' would stick out of the tank's wall " + wall, depth, allowed);
  }
  const auto velocity = [&](int body, const Vector3d& point) -> Vector3d {
    return twists[body].head<3>() + twists[body].tail<3>().cross(point - plan.bodies[body].p_WBcm);
  };
  for (const Contact& c : contacts) {
    if (c.body_b == Contact::kWall) continue;
    const double closes = -dt * (velocity(c.body_a, c.point) - velocity(c.body_b, c.pointOnB())).dot(c.normal);
    const double depth = closes - c.gap;
    if (depth <= allowed || closes <= std::max(pressed[c.body_a], pressed[c.body_b])) continue;
    return intrusion("bodies '" + after[c.body_a].name + "' and '" + after[c.body_b].name + "' would overlap", depth,
                     allowed);
  }
  return "";
}

std::string describeDeparture(const RigidBody& body, const TankWalls& walls, double allowed) {
  if (body.motion != BodyMotion::kPrescribed || !mayReachOut(body, walls, allowed)) return "";
  const auto [depth, wall] = deepestInWalls(body, walls);
  if (depth <= allowed) return "";
  std::ostringstream text;
  text << "body '" << body.name << "' moves out of the tank through its wall " << wall << ", now by " << depth
       << " m, as prescribed: what is outside displaces no liquid, that of a full tank grows by as much";
  return text.str();
}

}  // namespace monolith
