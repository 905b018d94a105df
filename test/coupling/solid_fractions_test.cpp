#include <gtest/gtest.h>

#include "coupling_scene.h"
#include "geometry/mesh_samples.h"

namespace monolith {
namespace {

// Sum over the bodies of their fraction of a face, periodic images included.
double bodyFraction(const CouplingScene& scene, int axis, const std::array<int, 3>& cell) {
  const Lattice& l = scene.grid.lattice;
  double sum = 0.0;
  for (const BodyFractions& f : scene.solids.bodies) {
    for (int k = 0; k < f.count[2]; ++k) {
      for (int j = 0; j < f.count[1]; ++j) {
        for (int i = 0; i < f.count[0]; ++i) {
          const int at[3] = {f.low[0] + i, f.low[1] + j, f.low[2] + k};
          bool same = true;
          for (int a = 0; a < 3; ++a) {
            const int wrapped = l.periodic[a] ? ((at[a] % l.n[a]) + l.n[a]) % l.n[a] : at[a];
            same = same && wrapped == cell[a];
          }
          if (same) sum += f.face[axis][f.local(i, j, k)];
        }
      }
    }
  }
  return sum;
}

TEST(SolidFractions, EveryFaceSumsToOneAlsoWhereBodiesOverlap) {
  for (const double number : {0.0, 1.0}) {  // without and with sticking liquid
    for (unsigned seed = 0; seed < 6; ++seed) {
      const CouplingScene scene(seed, number);
      const Lattice& l = scene.grid.lattice;
      int cut = 0;
      for (int a = 0; a < 3; ++a) {
        for (int k = 0; k < l.faceEnd(2) - (a == 2 || l.periodic[2] ? 0 : 1); ++k) {
          for (int j = 0; j < l.faceEnd(1) - (a == 1 || l.periodic[1] ? 0 : 1); ++j) {
            for (int i = 0; i < l.faceEnd(0) - (a == 0 || l.periodic[0] ? 0 : 1); ++i) {
              const std::array<int, 3> cell = {i, j, k};
              const bool wall = !l.periodic[a] && (cell[a] == 0 || cell[a] == l.n[a]);
              const double bodies = bodyFraction(scene, a, cell);
              const double fluid = scene.solids.fluid[a][l.index(i, j, k)];
              cut += bodies > 0.0 && fluid > 0.0;
              if (wall) {
                EXPECT_EQ(fluid, 0.0);
                EXPECT_EQ(bodies, 0.0);
              } else if (number == 0.0) {
                EXPECT_NEAR(fluid + bodies, 1.0, 1e-12);
              } else {
                // What sticks to a wall belongs to the wall.
                EXPECT_LE(fluid + bodies, 1.0 + 1e-12);
              }
              EXPECT_GE(fluid, 0.0);
            }
          }
        }
      }
      EXPECT_GT(cut, 50);
    }
  }
}

Shape shapeOf(Shape::Kind kind, const Eigen::Vector3d& position, double turn) {
  Shape shape;
  shape.kind = kind;
  shape.X_BG.translation() = position;
  shape.X_BG.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()));
  shape.radius = 0.25;
  shape.length = 0.4;
  shape.box_size = {0.5, 0.35, 0.4};
  return shape;
}

// What is displaced is displaced at the right place: neither force nor torque on a body of the liquid's density at
// rest.
TEST(SolidFractions, HaveTheBodysVolumeAndItsCentreWhereverItLies) {
  MacGrid grid;
  grid.lattice = Lattice({24, 24, 24}, {false, true, false});
  grid.h = 0.1;
  Shape mesh = shapeOf(Shape::Kind::kMesh, {0.02, 0.0, 0.01}, 0.3);
  mesh.mesh = std::make_shared<TriangleMesh>(cuboid({0.5, 0.4, 0.3}, {0.05, 0.02, -0.1}));
  const std::vector<std::vector<Shape>> bodies_of = {
      {shapeOf(Shape::Kind::kSphere, {0.0, 0.0, 0.0}, 0.0)},
      {shapeOf(Shape::Kind::kBox, {0.1, 0.0, 0.0}, 0.7)},
      {shapeOf(Shape::Kind::kBox, {0.0, 0.0, 0.0}, 0.0)},
      {shapeOf(Shape::Kind::kCylinder, {0.0, -0.1, 0.0}, 0.4)},
      {mesh},
      {shapeOf(Shape::Kind::kSphere, {-0.4, 0.0, 0.1}, 0.0), shapeOf(Shape::Kind::kBox, {0.4, 0.0, 0.0}, 1.2)}};
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(0.0, 0.1);
  for (std::size_t kind = 0; kind < bodies_of.size(); ++kind) {
    for (int trial = 0; trial < 3; ++trial) {
      BodyDescription body;
      body.shapes = bodies_of[kind];
      body.X_WB.translation() = Eigen::Vector3d(1.2 + unit(random), 1.2 + unit(random), 1.2 + unit(random));
      // The third lies along the grid, where few faces are cut.
      if (kind != 2) body.X_WB.rotate(Eigen::AngleAxisd(20.0 * unit(random), Eigen::Vector3d::UnitX()));
      const std::vector<RigidBody> bodies = {makeRigidBody(body, 0.02)};
      SolidFractions solids;
      SolidSampler(grid).sample(bodies, solids);
      const BodyFractions& f = solids.bodies[0];
      const Displacement whole = displacement(body.shapes).value();
      const Eigen::Vector3d centre = body.X_WB * whole.centre;
      for (int a = 0; a < 3; ++a) {
        double sum = 0.0;
        Eigen::Vector3d moment = Eigen::Vector3d::Zero();
        for (int k = 0; k < f.count[2]; ++k) {
          for (int j = 0; j < f.count[1]; ++j) {
            for (int i = 0; i < f.count[0]; ++i) {
              const double part = f.face[a][f.local(i, j, k)];
              EXPECT_TRUE(part >= 0.0 && part <= 1.0) << part;
              sum += part;
              moment += part * (grid.faceCenter(a, f.low[0] + i, f.low[1] + j, f.low[2] + k) - centre);
            }
          }
        }
        // Faces with next to no liquid left are closed.
        EXPECT_NEAR(sum * grid.cellVolume() / whole.volume, 1.0, 2e-4) << kind << " " << a;
        EXPECT_LT((moment / sum).norm(), 2e-4 * grid.h) << kind << " " << a;
      }
    }
  }
}

// What two parts have in common takes no liquid in: a bar cut in two is the bar, face by face.
TEST(SolidFractions, OfABarCutInTwoAreThoseOfTheBar) {
  MacGrid grid;
  grid.lattice = Lattice({24, 16, 16}, {false, false, false});
  grid.h = 0.1;
  Shape whole;
  whole.kind = Shape::Kind::kBox;
  whole.box_size = {1.2, 0.6, 0.5};
  for (const double turn : {0.0, 0.5}) {
    BodyDescription body;
    body.X_WB =
        Eigen::Translation3d(1.21, 0.83, 0.79) * Eigen::AngleAxisd(turn, Eigen::Vector3d(1.0, 2.0, 3.0).normalized());
    std::vector<SolidFractions> solids;
    for (const int parts : {1, 2}) {
      body.shapes.clear();
      for (int part = 0; part < parts; ++part) {
        Shape shape = whole;
        shape.box_size[0] /= parts;
        shape.X_BG.translation()[0] = (part + 0.5) * shape.box_size[0] - 0.5 * whole.box_size[0];
        body.shapes.push_back(shape);
      }
      std::vector<RigidBody> bodies = {makeRigidBody(body, 0.5 * grid.h)};
      bodies[0].displacement.reset();  // as sampled, not fitted to it
      SolidSampler(grid).sample(bodies, solids.emplace_back());
      for (int a = 0; a < 3; ++a) {
        double sum = 0.0;
        for (const double part : solids.back().bodies[0].face[a]) sum += part;
        EXPECT_NEAR(sum * grid.cellVolume() / volume(whole), 1.0, 5e-3) << parts;
      }
    }
    for (int a = 0; a < 3; ++a) {
      for (std::size_t f = 0; f < grid.lattice.size; ++f) {
        ASSERT_NEAR(solids[1].fluid[a][f], solids[0].fluid[a][f], 1e-9);
        ASSERT_NEAR(std::max(solids[1].distance[a][f], -1.5f), std::max(solids[0].distance[a][f], -1.5f), 1e-5f);
      }
    }
  }
}

// A sampler that has seen bodies before gives what a new one does, but for motions that do not count.
TEST(SolidFractions, BodiesAreSampledAgainOnceTheyHaveMoved) {
  MacGrid grid;
  grid.lattice = Lattice({16, 16, 16}, {false, false, false});
  grid.h = 0.1;
  BodyDescription body;
  Shape shape;
  shape.kind = Shape::Kind::kBox;
  shape.box_size = {0.5, 0.3, 0.4};
  body.shapes = {shape};
  body.X_WB =
      Eigen::Translation3d(0.81, 0.76, 0.83) * Eigen::AngleAxisd(0.4, Eigen::Vector3d(1.0, 2.0, 3.0).normalized());
  std::vector<RigidBody> bodies = {makeRigidBody(body, 0.05)};
  SolidSampler sampler(grid);
  const auto error = [&] {
    SolidFractions again, fresh;
    sampler.sample(bodies, again);
    SolidSampler(grid).sample(bodies, fresh);
    double worst = 0.0;
    for (int a = 0; a < 3; ++a) {
      for (std::size_t f = 0; f < grid.lattice.size; ++f) {
        worst = std::max({worst, std::abs(again.fluid[a][f] - fresh.fluid[a][f]),
                          static_cast<double>(std::abs(again.distance[a][f] - fresh.distance[a][f]))});
      }
    }
    return worst;
  };
  EXPECT_EQ(error(), 0.0);
  // It creeps: what does not count in one step must not add up.
  for (int step = 0; step < 40; ++step) {
    bodies[0].p_WBcm += Eigen::Vector3d::Constant(2e-7 * grid.h);
    EXPECT_LT(error(), 5e-6);
  }
  for (const double turn : {1e-4, 0.1}) {
    bodies[0].q_WB = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()) * bodies[0].q_WB;
    EXPECT_EQ(error(), 0.0) << turn;
  }
}

}  // namespace
}  // namespace monolith
