#include "rigid/integration.h"

#include "rigid/rotation.h"
#include "scene/oscillation.h"

namespace monolith {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector6d freeTwist(const RigidBody& body, const Vector3d& gravity, const Wrench& wrench, double dt) {
  if (body.motion != BodyMotion::kFree) return body.twist;
  Vector6d twist = body.twist;
  twist.head<3>() += dt * (gravity + wrench.force / body.mass);
  // advancePose turns the body about its own angular velocity, which does not change that velocity's
  // components in the body frame: from step to step they form the trajectory of the midpoint rule.
  const Quaterniond q_BW = body.q_WB.conjugate();
  const Vector3d omega_B = gyroscopicStep(body.inertia_Bcm, q_BW * body.twist.tail<3>(), q_BW * wrench.torque, dt);
  twist.tail<3>() = body.q_WB * omega_B;
  return twist;
}

void advancePose(RigidBody& body, double dt) {
  if (body.motion == BodyMotion::kPrescribed && body.prescribed.in_place) return;
  const Vector3d angular_velocity = body.twist.tail<3>();
  // What is prescribed is the motion of the frame's origin: on a circle around that the centre of mass would leave it.
  const bool by_origin = body.motion == BodyMotion::kPrescribed;
  const Vector3d arm = by_origin ? Vector3d(body.q_WB * body.p_BBcm) : Vector3d::Zero();
  const Vector3d velocity = body.twist.head<3>() - angular_velocity.cross(arm);
  body.q_WB = (exponential(dt * angular_velocity) * body.q_WB).normalized();
  body.p_WBcm += dt * velocity;
  if (by_origin) body.p_WBcm += body.q_WB * body.p_BBcm - arm;
}

FreeMotion freeMotion(const RigidBody& body, const Vector3d& gravity, const Wrench& held, const Vector3d& expected,
                      double dt) {
  FreeMotion out;
  out.twist.head<3>() = body.twist.head<3>() + dt * (gravity + held.force / body.mass);
  // The torques as the body sees them half-way.
  const Vector3d omega = body.twist.tail<3>();
  const Quaterniond q_WM = exponential(0.5 * dt * omega) * body.q_WB;
  const Vector3d before_B = body.q_WB.conjugate() * omega;
  const Vector3d after_B = gyroscopicStep(body.inertia_Bcm, before_B, q_WM.conjugate() * (held.torque + expected), dt);
  out.q_WB = (body.q_WB * exponential(0.5 * dt * (before_B + after_B))).normalized();
  out.angular_velocity = out.q_WB * after_B;
  // Angular momentum, so with the inertia of the end.
  const Vector3d added_B = body.inertia_Bcm.ldlt().solve(out.q_WB.conjugate() * expected);
  out.twist.tail<3>() = out.angular_velocity - dt * (out.q_WB * added_B);
  return out;
}

void finishMotion(const FreeMotion& motion, const Vector6d& twist, double dt, RigidBody& body) {
  body.p_WBcm += 0.5 * dt * (body.twist.head<3>() + twist.head<3>());
  const Vector3d turn = 0.5 * dt * (twist.tail<3>() - motion.angular_velocity);
  body.q_WB = (exponential(turn) * motion.q_WB).normalized();
  body.twist = twist;
}

namespace {

// Of a twist of the frame's origin that of the centre of mass.
Vector6d atCentre(const RigidBody& body, Vector6d twist) {
  const Vector3d angular_velocity = twist.tail<3>();
  twist.head<3>() += angular_velocity.cross(body.q_WB * body.p_BBcm);
  return twist;
}

}  // namespace

Vector6d prescribedTwist(const RigidBody& body, double time) {
  const PrescribedMotion& motion = body.prescribed;
  return atCentre(body, motion.twist + motion.amplitude * oscillation(motion.frequency, motion.phase, time));
}

Vector6d meanPrescribedTwist(const RigidBody& body, double time, double dt) {
  const PrescribedMotion& motion = body.prescribed;
  const double mean = meanOscillation(motion.frequency, motion.phase, time, dt);
  return atCentre(body, motion.twist + motion.amplitude * mean);
}

double kineticEnergy(const RigidBody& body) {
  const Eigen::Vector3d spin = body.twist.tail<3>();
  return 0.5 * body.mass * body.twist.head<3>().squaredNorm() + 0.5 * spin.dot(body.worldInertia() * spin);
}

RigidBody makeRigidBody(const BodyDescription& description, double distance_resolution) {
  RigidBody body;
  body.name = description.name;
  body.motion = description.motion;
  body.prescribed = description.prescribed;
  body.joint = description.joint;
  body.self_collision = description.self_collision;
  body.mass = description.mass;
  body.p_BBcm = description.p_BBcm;
  body.inertia_Bcm = description.inertia_Bcm;
  body.shapes = description.shapes;
  body.distance = makeSignedDistance(description.shapes, distance_resolution);
  body.displacement = displacement(description.shapes);
  if (body.joint) {
    body.joint_position = body.joint->position;
    body.joint_velocity = body.joint->velocity;
  }
  body.q_WB = Quaterniond(description.X_WB.linear()).normalized();
  body.p_WBcm = description.X_WB * description.p_BBcm;
  switch (description.motion) {
    case BodyMotion::kFree: {
      const Vector3d arm = body.q_WB * body.p_BBcm;
      body.twist.head<3>() = description.velocity;
      body.twist.head<3>() += description.angular_velocity.cross(arm);
      body.twist.tail<3>() = description.angular_velocity;
      break;
    }
    case BodyMotion::kFixed: body.twist.setZero(); break;
    case BodyMotion::kPrescribed: body.twist = prescribedTwist(body, 0.0); break;
  }
  return body;
}

}  // namespace monolith
