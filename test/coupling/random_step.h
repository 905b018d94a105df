#pragma once
// One step drawn from a seed, for the properties that hold for every step: three bodies of density ratio 1e-3 to 1e4,
// viscous number 0 to 1e4, a tilted surface or none, walls or none.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "coupling/contact_rows.h"
#include "coupling/step_problem.h"
#include "rigid/contact.h"
#include "scene/solid_body.h"

namespace monolith {

struct RandomStep {
  MacGrid grid;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::vector<double> liquid;
  StepProblem problem;
  FaceField<double> free_velocity;
  std::vector<Vector6d> free_twists;
  StepVector rhs;
  std::vector<Contact> contacts;
  ContactRows rows;
  bool walls = true;
  double number = 0.0;

  static MacGrid makeGrid(unsigned seed) {
    MacGrid g;
    const bool open = seed % 4 == 3;  // periodic along all axes: no walls
    g.lattice = Lattice({8, 7, 9}, {open, open || seed % 8 == 1, open});
    g.h = 0.1;
    return g;
  }

  // first: how the first of the bodies moves. jointed: each of the others hangs on the one before, by a joint of one
  // kind and of the other.
  explicit RandomStep(unsigned seed, Discretisation discretisation = Discretisation::kFitted,
                      BodyMotion first = BodyMotion::kFree, bool jointed = false)
      : problem(makeGrid(seed), discretisation) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto signedUnit = [&] { return 2.0 * unit(random) - 1.0; };
    grid = makeGrid(seed);
    const Lattice& l = grid.lattice;
    walls = !l.periodic[0];
    const Eigen::Vector3d size = grid.size();
    for (int b = 0; b < 3; ++b) {
      BodyDescription body;
      body.name = "body" + std::to_string(b);
      Shape shape;
      shape.kind = static_cast<Shape::Kind>(b);
      shape.box_size = 0.15 * Eigen::Vector3d(1.0 + unit(random), 1.0 + unit(random), 1.0 + unit(random));
      shape.radius = 0.1 + 0.05 * unit(random);
      shape.length = 0.25;
      shape.name = body.name;
      body.shapes = {shape};
      body.mass = 1000.0 * std::pow(10.0, -3.0 + 7.0 * unit(random)) * volume(shape);
      body.inertia_Bcm = body.mass * 0.008 * Eigen::Vector3d(1.0, 1.2, 0.9).asDiagonal();
      body.X_WB.translation() = Eigen::Vector3d((0.3 + 0.4 * unit(random)) * size[0],
                                                (0.3 + 0.4 * unit(random)) * size[1], (0.2 + 0.25 * b) * size[2]);
      body.X_WB.linear() =
          Eigen::Quaterniond(signedUnit(), signedUnit(), signedUnit(), signedUnit()).normalized().toRotationMatrix();
      if (b == 0) body.motion = first;
      bodies.push_back(makeRigidBody(body, 0.05));
      for (int d = 0; d < 6; ++d) bodies.back().twist[d] = (d < 3 ? 1.0 : 5.0) * signedUnit();
      if (body.motion == BodyMotion::kFixed) bodies.back().twist.setZero();
    }
    for (int b = 1; jointed && b < 3; ++b) {
      JointDescription joint;
      joint.parent = b - 1;
      joint.type = (seed + b) % 2 == 0 ? JointType::kRevolute : JointType::kPrismatic;
      joint.axis = Eigen::Vector3d(signedUnit(), signedUnit(), 0.5).normalized();
      joint.X_PJ = bodies[b - 1].pose().inverse() * bodies[b].pose();
      bodies[b].joint = joint;
    }
    SolidSampler(grid).sample(bodies, solids);
    const double fill = seed % 2 ? 100.0 : 4.0 + 4.0 * unit(random);
    liquid.assign(l.size, 0.0);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 + 0.1 * i - fill;
      }
    }
    extendIntoHalo(l, liquid);
    const double dt = 0.01;
    number = seed % 5 == 0 ? 0.0 : std::pow(10.0, -2.0 + 6.0 * unit(random));
    problem.sticking_viscosity = 0.05 * 1000.0 * grid.h * grid.h / dt;  // some stick, some slip
    problem.assemble(solids, bodies, liquid, 1000.0, number * 1000.0 * grid.h * grid.h / dt, dt);
    for (int a = 0; a < 3; ++a) {
      free_velocity[a].assign(l.size, 0.0);
      for (double& u : free_velocity[a]) u = signedUnit();
    }
    for (const RigidBody& body : bodies) free_twists.push_back(body.twist);
    EXPECT_EQ(problem.rightSide(free_velocity, free_twists, Eigen::Vector3d::Zero(), rhs), "");
    TankWalls tank;
    tank.inside = Eigen::AlignedBox3d(Eigen::Vector3d::Zero(), size);
    for (int a = 0; a < 3; ++a) tank.periodic[a] = l.periodic[a];
    contacts = ContactDetector(bodies, tank).detect(bodies, 0.02);
    for (Contact& c : contacts) c.gap = std::max(c.gap, 0.0);
    rows = buildContactRows(problem, contacts, std::vector<ContactLaw>(contacts.size(), {unit(random), 0.0}), {}, 1.0);
  }

  // Twice the kinetic energy of liquid and free bodies over rho h^3, from the unknowns of the faces.
  double energy(const FaceField<double>& unknowns, const std::vector<Vector6d>& twists) const {
    double sum = 0.0;
    for (int a = 0; a < 3; ++a) {
      std::vector<double> mass = problem.coefficients.mass[a];
      clearHalo(grid.lattice, mass);
      for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * unknowns[a][i] * unknowns[a][i];
    }
    for (std::size_t i = 0; i < problem.free.size(); ++i) {
      sum += twists[problem.free[i]].dot(problem.inertia[i] * twists[problem.free[i]]);
    }
    return sum;
  }
  // Momentum of liquid and free bodies over rho h^3; `fitted`, where the unknowns are the velocities.
  Eigen::Vector3d momentum(const FaceField<double>& u, const std::vector<Vector6d>& twists) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) {
      std::vector<double> mass = problem.coefficients.mass[a];
      clearHalo(grid.lattice, mass);
      for (std::size_t i = 0; i < mass.size(); ++i) sum[a] += mass[i] * u[a][i];
    }
    for (std::size_t i = 0; i < problem.free.size(); ++i) {
      sum += (problem.inertia[i] * twists[problem.free[i]]).head<3>();
    }
    return sum;
  }
  StepVector start() const {
    StepVector x;
    x.resize(grid.lattice, bodies.size());
    return x;
  }
};

}  // namespace monolith
