#include "rigid/articulation.h"

#include <cmath>
#include <utility>

#include "scene/joint_motion.h"

namespace monolith {

using Eigen::Vector3d;

namespace {

// World axes.
Vector3d axisOf(const RigidBody& body) { return body.q_WB * body.joint->axis; }

// Of body b, where its joint and its parent put it: not that of an image.
Eigen::Isometry3d posed(const std::vector<RigidBody>& bodies, const RigidBody& body) {
  return bodies[body.joint->parent].pose() * jointPose(*body.joint, body.joint_position);
}

}  // namespace

std::vector<int> rootsOf(const std::vector<RigidBody>& bodies) {
  std::vector<int> roots(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    roots[b] = bodies[b].joint ? roots[bodies[b].joint->parent] : static_cast<int>(b);
  }
  return roots;
}

bool mayTouch(const std::vector<RigidBody>& bodies, const std::vector<int>& roots, std::size_t a, std::size_t b) {
  if (roots[a] != roots[b]) return true;
  const auto hangs = [&](std::size_t child, std::size_t parent) {
    return bodies[child].joint && bodies[child].joint->parent == static_cast<int>(parent);
  };
  return bodies[a].self_collision && bodies[b].self_collision && !hangs(a, b) && !hangs(b, a);
}

Vector6d jointTwist(const RigidBody& body) {
  const Vector3d axis = axisOf(body);
  Vector6d s = Vector6d::Zero();
  switch (body.joint->type) {
    case JointType::kRevolute:
      s.head<3>() = axis.cross(body.q_WB * body.p_BBcm);
      s.tail<3>() = axis;
      break;
    case JointType::kPrismatic:
      s.head<3>() = axis;
      break;
  }
  return s;
}

Matrix6d carryMatrix(const std::vector<RigidBody>& bodies, std::size_t b) {
  const RigidBody& body = bodies[b];
  const Vector3d arm = posed(bodies, body) * body.p_BBcm - bodies[body.joint->parent].p_WBcm;
  Matrix6d X = Matrix6d::Identity();
  for (int q = 0; q < 3; ++q) X.block<3, 1>(0, 3 + q) = Vector3d::Unit(q).cross(arm);
  return X;
}

Vector6d jointRow(const RigidBody& body) {
  Vector6d row = Vector6d::Zero();
  switch (body.joint->type) {
    case JointType::kRevolute:
      row.tail<3>() = axisOf(body);
      break;
    case JointType::kPrismatic:
      row.head<3>() = axisOf(body);
      break;
  }
  return row;
}

double jointVelocity(const std::vector<RigidBody>& bodies, std::size_t b, const std::vector<Vector6d>& twists) {
  if (!bodies[b].joint) return 0.0;
  return jointRow(bodies[b]).dot(twists[b] - carryMatrix(bodies, b) * twists[bodies[b].joint->parent]);
}

void placeOnJoints(const Vector3d& period, std::vector<RigidBody>& bodies) {
  for (RigidBody& body : bodies) {
    if (!body.joint) continue;
    const Eigen::Isometry3d X_WB = posed(bodies, body);
    Vector3d centre = X_WB * body.p_BBcm;
    for (int a = 0; a < 3; ++a) {
      if (period[a] > 0.0) centre[a] += period[a] * std::round((body.p_WBcm[a] - centre[a]) / period[a]);
    }
    body.q_WB = Eigen::Quaterniond(X_WB.linear()).normalized();
    body.p_WBcm = centre;
  }
}

void moveWithJoints(std::vector<RigidBody>& bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    RigidBody& body = bodies[b];
    if (!body.joint) continue;
    body.twist = carryMatrix(bodies, b) * bodies[body.joint->parent].twist + body.joint_velocity * jointTwist(body);
  }
}

double stopRadius(const RigidBody& body) { return body.joint->type == JointType::kRevolute ? body.radius() : 1.0; }

std::vector<JointStop> jointStops(const std::vector<RigidBody>& bodies) {
  std::vector<JointStop> stops;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidBody& body = bodies[b];
    if (!body.hasFreeJoint()) continue;
    for (const auto& [sign, gap] : {std::pair(1.0, body.joint_position - body.joint->lower),
                                    std::pair(-1.0, body.joint->upper - body.joint_position)}) {
      if (std::isfinite(gap)) stops.push_back({static_cast<int>(b), sign, gap, stopRadius(body)});
    }
  }
  return stops;
}

std::vector<double> jointInertias(const std::vector<RigidBody>& bodies) {
  std::vector<double> out(bodies.size(), 0.0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].joint) continue;
    std::vector<Vector6d> twists(bodies.size(), Vector6d::Zero());  // while the joint alone moves
    for (std::size_t i = b; i < bodies.size(); ++i) {
      const RigidBody& body = bodies[i];
      if (i == b) {
        twists[i] = jointTwist(body);
      } else if (body.joint && body.joint->parent >= static_cast<int>(b)) {
        twists[i] = carryMatrix(bodies, i) * twists[body.joint->parent];
      } else {
        continue;
      }
      const Vector3d spin = twists[i].tail<3>();
      out[b] += body.mass * twists[i].head<3>().squaredNorm() + spin.dot(body.worldInertia() * spin);
    }
  }
  return out;
}

std::vector<double> fastestPoints(const std::vector<RigidBody>& bodies, const std::vector<double>& speeds) {
  std::vector<double> turning(bodies.size(), 0.0), moving(bodies.size(), 0.0), out(bodies.size(), 0.0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const RigidBody& body = bodies[b];
    if (!body.joint) continue;
    const auto parent = static_cast<std::size_t>(body.joint->parent);
    // Of the body's frame, which the parent carries along; then about that.
    const double arm = (jointPose(*body.joint, body.joint_position).translation() - bodies[parent].p_BBcm).norm();
    const bool turns = body.joint->type == JointType::kRevolute;
    const double origin = moving[parent] + turning[parent] * arm + (turns ? 0.0 : speeds[b]);
    turning[b] = turning[parent] + (turns ? speeds[b] : 0.0);
    moving[b] = origin + turning[b] * body.p_BBcm.norm();  // of its centre of mass
    out[b] = moving[b] + turning[b] * body.radius();
  }
  return out;
}

void addJointEffort(const std::vector<RigidBody>& bodies, std::size_t b, double effort, std::vector<Wrench>& wrenches) {
  const Vector6d row = jointRow(bodies[b]);
  // On its parent what does the same work where the two are one.
  const Vector6d reaction = carryMatrix(bodies, b).transpose() * row;
  wrenches[b].force += effort * row.head<3>();
  wrenches[b].torque += effort * row.tail<3>();
  Wrench& parent = wrenches[bodies[b].joint->parent];
  parent.force -= effort * reaction.head<3>();
  parent.torque -= effort * reaction.tail<3>();
}

std::vector<double> effortsThrough(const std::vector<RigidBody>& bodies, const std::vector<Wrench>& wrenches) {
  std::vector<Vector6d> through(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) through[b] << wrenches[b].force, wrenches[b].torque;
  std::vector<double> out(bodies.size(), 0.0);
  for (std::size_t b = bodies.size(); b-- > 0;) {
    if (!bodies[b].joint) continue;
    out[b] = jointTwist(bodies[b]).dot(through[b]);
    through[bodies[b].joint->parent] += carryMatrix(bodies, b).transpose() * through[b];
  }
  return out;
}

}  // namespace monolith
