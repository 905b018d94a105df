#pragma once
// Scenes of bodies that joints connect.

#include "scene/solid_body.h"
#include "simulation/simulation.h"

namespace monolith {

// Empty, 2 m wide, in steps of dt.
inline Scene emptyRoom(double dt) {
  Scene scene;
  scene.source = "test";
  scene.tank.size = Eigen::Vector3d::Constant(2.0);
  scene.tank.cell_width = 0.1;
  scene.time_step = dt;
  scene.solver.tolerance = 1e-9;
  scene.solver.cfl = 1000.0;  // of nothing that is in it
  return scene;
}

// A bar that hangs down from the origin of its frame.
inline BodyDescription hangingBar(const std::string& name, double length, double width, double density) {
  BodyDescription bar = boxBody(name, {width, width, length}, density, Eigen::Vector3d::Zero());
  bar.shapes[0].X_BG.translation() = Eigen::Vector3d(0.0, 0.0, -0.5 * length);
  bar.p_BBcm = Eigen::Vector3d(0.0, 0.0, -0.5 * length);
  return bar;
}

inline JointDescription hinge(const Eigen::Vector3d& axis, const Eigen::Vector3d& at, double position) {
  JointDescription joint;
  joint.name = "hinge";
  joint.axis = axis;
  joint.X_PJ.translation() = at;
  joint.position = position;
  return joint;
}

// Moment of inertia of such a bar about its upper end, across it.
inline double barInertia(const BodyDescription& bar) {
  return bar.inertia_Bcm(1, 1) + bar.mass * bar.p_BBcm.squaredNorm();
}

inline void stepOn(Simulation& simulation) {
  const StepReport report = simulation.step();
  if (report.status != SolveStatus::kConverged) throw std::runtime_error(report.message);
}

}  // namespace monolith
