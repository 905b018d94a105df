#include "rigid/integration.h"

#include <cmath>

#include "rigid/rotation.h"

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
  body.p_WBcm += dt * body.twist.head<3>();
  body.q_WB = (exponential(dt * body.twist.tail<3>()) * body.q_WB).normalized();
}

Vector6d prescribedTwist(const RigidBody& body, double time) {
  const PrescribedMotion& motion = body.prescribed;
  const double rate = 2.0 * M_PI * motion.frequency;
  Vector6d twist = motion.twist + motion.amplitude * (rate * std::cos(rate * time + motion.phase));
  const Vector3d angular_velocity = twist.tail<3>();
  twist.head<3>() += angular_velocity.cross(body.q_WB * body.p_BBcm);
  return twist;
}

RigidBody makeRigidBody(const BodyDescription& description, double distance_resolution) {
  RigidBody body;
  body.name = description.name;
  body.motion = description.motion;
  body.prescribed = description.prescribed;
  body.mass = description.mass;
  body.p_BBcm = description.p_BBcm;
  body.inertia_Bcm = description.inertia_Bcm;
  body.shapes = description.shapes;
  body.distance = makeSignedDistance(description.shapes, distance_resolution);
  body.q_WB = Quaterniond(description.X_WB.linear()).normalized();
  body.p_WBcm = description.X_WB * description.p_BBcm;
  switch (description.motion) {
    case BodyMotion::kFree: {
      const Vector3d arm = body.q_WB * body.p_BBcm;
      body.twist << description.velocity + description.angular_velocity.cross(arm), description.angular_velocity;
      break;
    }
    case BodyMotion::kFixed: body.twist.setZero(); break;
    case BodyMotion::kPrescribed: body.twist = prescribedTwist(body, 0.0); break;
  }
  return body;
}

}  // namespace monolith
