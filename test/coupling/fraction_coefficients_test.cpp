// The discretisation `fractions`: its fractions sum to one, its rows are those of an explicitly formed Q, its operator
// is symmetric and positive semi-definite, and a step with it keeps the balance of momentum.

#include "coupling/fraction_coefficients.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "coupling/direct_solver.h"
#include "coupling/fast_solver.h"
#include "coupling_scene.h"
#include "rigid/integration.h"

namespace monolith {
namespace {

using Cell = std::array<int, 3>;

BodyDescription describe(const Shape& shape, const Eigen::Vector3d& position, const Eigen::Quaterniond& attitude) {
  BodyDescription body;
  body.name = shape.name;
  body.shapes = {shape};
  body.mass = 700.0 * volume(shape);
  body.inertia_Bcm = 0.01 * body.mass * Eigen::Matrix3d::Identity();
  body.X_WB.translation() = position;
  body.X_WB.linear() = attitude.normalized().toRotationMatrix();
  return body;
}

Shape shapeOf(Shape::Kind kind, const Eigen::Vector3d& box_size, double radius, double length) {
  Shape shape;
  shape.kind = kind;
  shape.box_size = box_size;
  shape.radius = radius;
  shape.length = length;
  shape.name = "body";
  return shape;
}

// A turned box that a sphere touches, a turned cylinder that overlaps the sphere, and a box through a wall or, where
// the tank is periodic, through its end; liquid with a tilted surface, or full.
struct FractionScene {
  MacGrid grid;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  std::vector<double> liquid;
  StepProblem problem;

  FractionScene(const std::array<bool, 3>& periodic, double viscosity, double fill, unsigned seed = 1)
      : problem(makeGrid(periodic), Discretisation::kFractions) {
    grid = makeGrid(periodic);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto turn = [&] { return Eigen::Quaterniond(unit(random) + 0.2, unit(random), -unit(random), unit(random)); };
    const Eigen::Vector3d o = grid.origin;
    const Eigen::Vector3d shift = 0.1 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    const auto add = [&](const Shape& shape, const Eigen::Vector3d& at, const Eigen::Quaterniond& attitude) {
      bodies.push_back(makeRigidBody(describe(shape, o + at, attitude), 0.05));
    };
    add(shapeOf(Shape::Kind::kBox, {0.5, 0.4, 0.3}, 0, 0), Eigen::Vector3d(0.55, 0.5, 0.5) + shift, turn());
    // Its surface is where the box's corner-to-centre line leaves the box.
    const Eigen::Vector3d corner = bodies[0].pose() * Eigen::Vector3d(0.25, 0.2, 0.15);
    const Eigen::Vector3d outwards = (corner - bodies[0].p_WBcm).normalized();
    add(shapeOf(Shape::Kind::kSphere, {1, 1, 1}, 0.17, 0), corner + 0.17 * outwards - o, turn());
    add(shapeOf(Shape::Kind::kCylinder, {1, 1, 1}, 0.12, 0.35),
        bodies[1].p_WBcm - o + Eigen::Vector3d(0.15, -0.12, 0.14), turn());
    add(shapeOf(Shape::Kind::kBox, {0.3, 0.25, 0.35}, 0, 0), {1.15, 0.35, 0.4}, turn());
    SolidSampler(grid).sample(bodies, solids);
    const Lattice& l = grid.lattice;
    liquid.assign(l.size, 0.0);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) {
          liquid[l.index(i, j, k)] = k + 0.5 + (periodic[0] ? 0.0 : 0.13 * i) - fill;
        }
      }
    }
    extendIntoHalo(l, liquid);
    problem.assemble(solids, bodies, liquid, 1000.0, viscosity, 0.01);
  }
  static MacGrid makeGrid(const std::array<bool, 3>& periodic) {
    MacGrid g;
    g.lattice = Lattice({12, 10, 12}, periodic);
    g.h = 0.1;
    g.origin = Eigen::Vector3d(-0.3, 0.2, 0.1);
    return g;
  }
};

constexpr double kFull = 100.0;
const std::array<bool, 3> kWalls = {false, false, false};
const std::array<bool, 3> kPeriodic = {true, true, true};

// Index of a face of `axis` (or, for axis -1, a cell), periodic images included; -1 outside the tank.
std::ptrdiff_t faceIndex(const Lattice& l, Cell at, int axis) {
  for (int a = 0; a < 3; ++a) {
    if (l.periodic[a]) at[a] = ((at[a] % l.n[a]) + l.n[a]) % l.n[a];
    if (at[a] < 0 || at[a] >= (a == axis ? l.faceEnd(a) : l.n[a])) return -1;
  }
  return l.index(at[0], at[1], at[2]);
}

template <class Function>
void forEachInBox(const BodyFractions& box, Function&& f) {
  for (int k = 0; k < box.count[2]; ++k) {
    for (int j = 0; j < box.count[1]; ++j) {
      for (int i = 0; i < box.count[0]; ++i)
        f(box.local(i, j, k), Cell{box.low[0] + i, box.low[1] + j, box.low[2] + k});
    }
  }
}

// -- sums of fractions

TEST(Fractions, OfEveryFaceSumToOne) {
  for (const auto& periodic : {kWalls, kPeriodic}) {
    const FractionScene scene(periodic, 1.0, kFull);
    const Lattice& l = scene.grid.lattice;
    for (int a = 0; a < 3; ++a) {
      std::vector<double> sum = scene.solids.fluid[a];
      clearHalo(l, sum);
      for (const BodyFractions& box : scene.solids.bodies) {
        forEachInBox(box, [&](std::size_t local, const Cell& at) {
          const auto f = faceIndex(l, at, a);
          if (f >= 0) sum[f] += box.face[a][local];
        });
      }
      int cut = 0;
      for (int k = 0; k < l.n[2]; ++k) {
        for (int j = 0; j < l.n[1]; ++j) {
          for (int i = 0; i < l.n[0]; ++i) {
            const Cell at = {i, j, k};
            const auto f = l.index(i, j, k);
            const double open = scene.solids.fluid[a][f];
            const double wall = !l.periodic[a] && at[a] == 0 ? 1.0 : 0.0;
            EXPECT_NEAR(sum[f] + wall, 1.0, 4e-16 * 8);
            // Nothing between closed and the least part that has an unknown.
            EXPECT_TRUE(open == 0.0 || open >= 1e-3) << open;
            EXPECT_EQ(scene.problem.coefficients.mass[a][f] > 0.0, open > 0.0);
            cut += open > 0.0 && open < 1.0;
          }
        }
      }
      EXPECT_GT(cut, 60);
    }
  }
}

TEST(Fractions, OfEveryStressSampleSumToOne) {
  for (const auto& periodic : {kWalls, kPeriodic}) {
    const FractionScene scene(periodic, 1.0, kFull);
    const Lattice& l = scene.grid.lattice;
    StressFractions fluid;
    std::vector<StressFractions> parts;
    sampleStressFractions(scene.grid, scene.bodies, scene.solids, fluid, parts);
    for (int p = -1; p < 3; ++p) {
      std::vector<double> sum = p < 0 ? fluid.cell : fluid.edge[p];
      std::vector<int> bodies_at(l.size, 0);
      clearHalo(l, sum);
      for (std::size_t b = 0; b < parts.size(); ++b) {
        forEachInBox(scene.solids.bodies[b], [&](std::size_t local, Cell at) {
          const double part = p < 0 ? parts[b].cell[local] : parts[b].edge[p][local];
          if (part == 0.0) return;
          for (int a = 0; a < 3; ++a) {
            if (l.periodic[a]) at[a] = ((at[a] % l.n[a]) + l.n[a]) % l.n[a];
          }
          const auto c = l.index(at[0], at[1], at[2]);
          sum[c] += part;
          ++bodies_at[c];
        });
      }
      int shared = 0;
      for (int k = 0; k < l.faceEnd(2); ++k) {
        for (int j = 0; j < l.faceEnd(1); ++j) {
          for (int i = 0; i < l.faceEnd(0); ++i) {
            const auto c = l.index(i, j, k);
            double wall = 0.0;
            if (p < 0) {
              wall = i < l.n[0] && j < l.n[1] && k < l.n[2] ? 0.0 : 1.0;
            } else {
              wall = 1.0 - edgeInTank(l, p, {i, j, k});
            }
            EXPECT_NEAR(sum[c] + wall, 1.0, 4e-16 * 8) << "pair " << p << " at " << i << " " << j << " " << k;
            shared += bodies_at[c] > 1;
          }
        }
      }
      EXPECT_GT(shared, 5) << "no two bodies share a sample: the scene is too easy";
    }
  }
}

TEST(Fractions, WallTakesAHalfOrThreeQuartersOfItsEdges) {
  const Lattice l({6, 6, 6}, {false, false, true});
  EXPECT_EQ(edgeInTank(l, 0, {3, 3, 3}), 1.0);
  EXPECT_EQ(edgeInTank(l, 0, {0, 3, 3}), 0.5);
  EXPECT_EQ(edgeInTank(l, 0, {6, 0, 3}), 0.25);
  EXPECT_EQ(edgeInTank(l, 1, {0, 3, 0}), 0.5);  // periodic along z
  EXPECT_EQ(edgeInTank(l, 0, {7, 3, 3}), 0.0);
}

// The volume of a body is in its stress samples too: cells, and the edges along each axis.
TEST(Fractions, StressSamplesHoldTheVolume) {
  MacGrid grid;
  grid.lattice = Lattice({16, 16, 16}, kWalls);
  grid.h = 0.1;
  const Shape ball = shapeOf(Shape::Kind::kSphere, {1, 1, 1}, 0.41, 0);
  const std::vector<RigidBody> bodies = {
      makeRigidBody(describe(ball, {0.83, 0.79, 0.81}, Eigen::Quaterniond::Identity()), 0.05)};
  SolidFractions solids;
  SolidSampler(grid).sample(bodies, solids);
  StressFractions fluid;
  std::vector<StressFractions> parts;
  sampleStressFractions(grid, bodies, solids, fluid, parts);
  for (int p = -1; p < 3; ++p) {
    double sum = 0.0;
    for (const double part : p < 0 ? parts[0].cell : parts[0].edge[p]) sum += part;
    EXPECT_NEAR(sum * grid.cellVolume() / volume(ball), 1.0, 3e-3) << "pair " << p;
  }
}

TEST(LiquidFractions, OfAFlatSurfaceAreExactAtAnyHeight) {
  const Lattice l({5, 4, 7}, {false, true, false});
  for (const double fill : {0.2, 0.5, 2.5, 2.75, 3.0, 3.3, 6.8}) {
    std::vector<double> d(l.size);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) d[l.index(i, j, k)] = k + 0.5 - fill;
      }
    }
    extendIntoHalo(l, d);
    LiquidFractions f;
    sampleLiquidFractions(l, d, true, f);
    for (int k = 0; k < l.n[2]; ++k) {
      const auto part = [&](double low, double high) { return std::clamp((fill - low) / (high - low), 0.0, 1.0); };
      const auto c = l.index(2, 1, k);
      const double around_face = k == 0 ? part(0.0, 0.5) : part(k - 0.5, k + 0.5);
      EXPECT_NEAR(f.cell[c], part(k, k + 1), 1e-6);
      EXPECT_NEAR(f.face[0][c], part(k, k + 1), 1e-6);
      EXPECT_NEAR(f.face[2][c], around_face, 1e-6);
      EXPECT_NEAR(f.edge[0][c], part(k, k + 1), 1e-6);
      EXPECT_NEAR(f.edge[1][c], around_face, 1e-6);
    }
  }
}

// -- J_p and J_s against an explicit Q

using Row = std::map<std::pair<std::ptrdiff_t, int>, Vector6d>;  // sample, body

// Adds what body b's Q^T W_S at one of its faces contributes to a sample.
void addFace(const FractionScene& scene, int b, int axis, const Cell& at, double fraction, std::ptrdiff_t sample,
             double factor, Row& out) {
  if (sample < 0 || fraction == 0.0 || factor == 0.0) return;
  const Eigen::Vector3d x = scene.grid.faceCenter(axis, at[0], at[1], at[2]) - scene.bodies[b].p_WBcm;
  Vector6d q;  // column of Q: force and torque of a unit force at the face
  q << Eigen::Vector3d::Unit(axis), x.cross(Eigen::Vector3d::Unit(axis));
  const auto found = out.try_emplace({sample, b}, Vector6d::Zero()).first;
  found->second += factor * fraction * q;
}

struct ExplicitRows {
  Row divergence;
  std::array<Row, 3> normal, shear;
};

// G and D transposed, face by face: every face in which a body has a part acts on its two cells and four edges.
ExplicitRows explicitRows(const FractionScene& scene) {
  const Lattice& l = scene.grid.lattice;
  const auto& c = scene.problem.coefficients;
  ExplicitRows out;
  for (int b = 0; b < static_cast<int>(scene.bodies.size()); ++b) {
    const BodyFractions& box = scene.solids.bodies[b];
    for (int a = 0; a < 3; ++a) {
      forEachInBox(box, [&](std::size_t local, const Cell& at) {
        const double fraction = box.face[a][local];
        Cell below = at;
        --below[a];
        for (const auto& [cell, sign] : {std::pair(at, -1.0), std::pair(below, 1.0)}) {
          const auto s = faceIndex(l, cell, -1);
          if (s < 0) continue;
          if (c.has_pressure[s]) addFace(scene, b, a, at, fraction, s, sign, out.divergence);
          if (c.normal[a][s] > 0.0) addFace(scene, b, a, at, fraction, s, sign, out.normal[a]);
        }
        for (int p = 0; p < 3; ++p) {
          for (int place = 0; place < 2; ++place) {
            if (kShearPairs[p][place] != a) continue;
            const int across = kShearPairs[p][1 - place];
            Cell above = at;
            ++above[across];
            for (const auto& [edge, sign] : {std::pair(at, 1.0), std::pair(above, -1.0)}) {
              Cell wrapped = edge;
              for (int d = 0; d < 3; ++d) {
                if (l.periodic[d]) wrapped[d] = ((edge[d] % l.n[d]) + l.n[d]) % l.n[d];
              }
              const auto s = l.index(wrapped[0], wrapped[1], wrapped[2]);
              addFace(scene, b, a, at, fraction, s, sign * c.shear[p][place][s], out.shear[p]);
            }
          }
        }
      });
    }
  }
  return out;
}

Row gathered(const std::vector<BodyRow>& rows) {
  Row out;
  for (const BodyRow& row : rows)
    out.try_emplace({row.sample, row.body}, Vector6d::Zero()).first->second += row.coefficient;
  return out;
}

// Entry by entry, whichever of both holds it.
void expectSame(const Row& direct, const Row& full, double scale, const char* what) {
  for (const auto& [key, value] : full) {
    const auto found = direct.find(key);
    const Vector6d other = found == direct.end() ? Vector6d(Vector6d::Zero()) : found->second;
    EXPECT_LT((value - other).cwiseAbs().maxCoeff(), 1e-12 * scale) << what << " sample " << key.first;
  }
  for (const auto& entry : direct) EXPECT_TRUE(full.count(entry.first)) << what << " sample " << entry.first.first;
}

TEST(FractionRows, AreThoseOfAnExplicitQ) {
  for (const auto& periodic : {kWalls, kPeriodic, std::array<bool, 3>{true, false, false}}) {
    for (const double fill : {kFull, 7.3}) {
      for (unsigned seed = 1; seed < 5; ++seed) {
        const FractionScene scene(periodic, 3.0, fill, seed);
        const ExplicitRows full = explicitRows(scene);
        // No liquid is missing from the contacts here, so all rows of J_p are in its cells.
        BodyRows rows;
        buildFractionRows(scene.grid, scene.solids, scene.bodies, scene.problem.coefficients, rows);
        expectSame(gathered(rows.divergence), full.divergence, 1.0, "J_p");
        double largest = 0.0;
        for (const auto& field : scene.problem.coefficients.shear) {
          for (std::size_t e = 0; e < scene.grid.lattice.size; ++e) largest = std::max<double>(largest, field[0][e]);
        }
        for (int q = 0; q < 3; ++q) {
          expectSame(gathered(rows.normal[q]), full.normal[q], 1.0, "J_s, normal");
          expectSame(gathered(rows.shear[q]), full.shear[q], std::max(1.0, largest), "J_s, shear");
          EXPECT_GT(rows.normal[q].size(), 50u);
          EXPECT_GT(rows.shear[q].size(), 50u);
        }
      }
    }
  }
}

// Q and J without cancellation would store an entry for every cell in the body; with it only its surface counts.
TEST(FractionRows, OfAWideBodyAreThoseOfItsSurface) {
  MacGrid grid;
  grid.lattice = Lattice({28, 28, 28}, kPeriodic);
  grid.h = 0.05;
  const Shape shape = shapeOf(Shape::Kind::kBox, {1.0, 0.95, 0.9}, 0, 0);
  const std::vector<RigidBody> bodies = {
      makeRigidBody(describe(shape, {0.7, 0.71, 0.69}, Eigen::Quaterniond(1.0, 0.1, 0.2, 0.05)), 0.05)};
  SolidFractions solids;
  SolidSampler(grid).sample(bodies, solids);
  // Pressure and stress everywhere, as the paper's Q W G and Q W D^T have them.
  StaggeredCoefficients<double> everywhere;
  everywhere.resize(grid.lattice, true);
  std::fill(everywhere.has_pressure.begin(), everywhere.has_pressure.end(), 1);
  for (int a = 0; a < 3; ++a) {
    const std::vector<float> one(grid.lattice.size, 1.0F);
    everywhere.normal[a].pack(grid.lattice, one);
    for (auto& field : everywhere.shear[a]) field.pack(grid.lattice, one);
  }
  BodyRows rows;
  buildFractionRows(grid, solids, bodies, everywhere, rows);
  std::size_t stored = rows.divergence.size(), pressure = stored, touched = 0, touched_by_pressure = 0;
  for (int q = 0; q < 3; ++q) stored += rows.normal[q].size() + rows.shear[q].size();
  const BodyFractions& box = solids.bodies[0];
  std::vector<char> cells(grid.lattice.size, 0);
  std::array<std::vector<char>, 3> normal, shear;
  for (auto* fields : {&normal, &shear}) {
    for (auto& field : *fields) field.assign(grid.lattice.size, 0);
  }
  const Lattice& l = grid.lattice;
  for (int a = 0; a < 3; ++a) {
    forEachInBox(box, [&](std::size_t local, const Cell& at) {
      if (box.face[a][local] == 0.0) return;
      const auto f = l.index(at[0], at[1], at[2]);
      for (const auto c : {f, f - l.stride[a]}) cells[c] = normal[a][c] = 1;
      for (int p = 0; p < 3; ++p) {
        for (int place = 0; place < 2; ++place) {
          if (kShearPairs[p][place] != a) continue;
          shear[p][f] = shear[p][f + l.stride[kShearPairs[p][1 - place]]] = 1;
        }
      }
    });
  }
  for (const char c : cells) touched_by_pressure += c;
  touched = touched_by_pressure;
  for (int q = 0; q < 3; ++q) {
    for (const char c : normal[q]) touched += c;
    for (const char c : shear[q]) touched += c;
  }
  std::printf("box 20 cells wide: J_p has %zu rows of the %zu that Q W_S G touches, J_p and J_s together %zu of %zu\n",
              pressure, touched_by_pressure, stored, touched);
  EXPECT_LT(pressure, 6u * touched_by_pressure / 10u);
  EXPECT_LT(stored, touched / 2);
  EXPECT_GT(pressure, 6u * 19u * 19u);  // at least one layer on the surface
}

// -- the operator

double product(const FractionScene& scene, StepVector x, const StepVector& y) {
  const Lattice& l = scene.grid.lattice;
  clearHalo(l, x.pressure);
  double sum = 0.0;
  for (int a = 0; a < 3; ++a) {
    clearHalo(l, x.velocity[a]);
    for (std::size_t c = 0; c < l.size; ++c) sum += x.velocity[a][c] * y.velocity[a][c];
  }
  for (std::size_t c = 0; c < l.size; ++c) sum += x.pressure[c] * y.pressure[c];
  for (std::size_t b = 0; b < x.bodies.size(); ++b) sum += x.bodies[b].dot(y.bodies[b]);
  return sum;
}

TEST(FractionOperator, IsSymmetricAndPositiveSemiDefinite) {
  for (const auto& periodic : {kWalls, kPeriodic}) {
    for (const double viscosity : {0.0, 1.0, 1e4}) {
      for (const double fill : {kFull, 7.3}) {
        const FractionScene scene(periodic, viscosity, fill);
        StepOperator op;
        op.set(&scene.problem.coefficients, &scene.problem.rows);
        for (unsigned seed = 0; seed < 3; ++seed) {
          StepVector x = randomVector(scene.problem.coefficients, scene.bodies.size(), 10 + seed, true),
                     y = randomVector(scene.problem.coefficients, scene.bodies.size(), 50 + seed, true), Ax, Ay;
          op.apply(x, Ax);
          op.apply(y, Ay);
          const double scale = std::sqrt(std::abs(product(scene, Ax, Ax) * product(scene, y, y)));
          EXPECT_NEAR(product(scene, y, Ax), product(scene, x, Ay), 1e-12 * scale);
          StepVector u = randomVector(scene.problem.coefficients, scene.bodies.size(), 90 + seed, false), Au;
          op.apply(u, Au);
          const double total = product(scene, u, Au);
          double inertia = 0.0;
          const auto& mass = scene.problem.coefficients.mass;
          for (int a = 0; a < 3; ++a) {
            clearHalo(scene.grid.lattice, u.velocity[a]);
            for (std::size_t f = 0; f < mass[a].size(); ++f)
              inertia += mass[a][f] * u.velocity[a][f] * u.velocity[a][f];
          }
          EXPECT_GT(inertia, 0.0);
          if (viscosity > 0.0) {
            EXPECT_GT(total, inertia);
          } else {
            EXPECT_NEAR(total, inertia, 1e-12 * inertia);
          }
        }
      }
    }
  }
}

TEST(FractionOperator, PairsAreAdjoint) {
  const FractionScene scene(kWalls, 1.0, 7.3);
  StepOperator op;
  op.set(&scene.problem.coefficients, &scene.problem.rows);
  // (v, J^T of liquid) = (J v, liquid), each side from a different part of the operator.
  StepVector liquid = randomVector(scene.problem.coefficients, scene.bodies.size(), 3, true),
             solids = randomVector(scene.problem.coefficients, scene.bodies.size(), 4, false), A_liquid, A_solids;
  for (auto& twist : liquid.bodies) twist.setZero();
  for (auto& field : solids.velocity) std::fill(field.begin(), field.end(), 0.0);
  op.apply(liquid, A_liquid);
  op.apply(solids, A_solids);
  double on_bodies = 0.0, size = 0.0;
  for (std::size_t b = 0; b < solids.bodies.size(); ++b) {
    on_bodies += solids.bodies[b].dot(A_liquid.bodies[b]);
    size += solids.bodies[b].norm() * A_liquid.bodies[b].norm();
  }
  StepVector on_liquid = A_solids;
  for (auto& twist : on_liquid.bodies) twist.setZero();
  EXPECT_NEAR(on_bodies, product(scene, liquid, on_liquid), 1e-12 * size);
  EXPECT_GT(size, 1.0);
}

TEST(FractionOperator, TranslationOfAllCostsNothing) {
  const FractionScene scene(kPeriodic, 5.0, kFull);
  const auto& c = scene.problem.coefficients;
  const Eigen::Vector3d velocity(0.3, -0.7, 0.45);
  StepVector x, Ax;
  x.resize(scene.grid.lattice, scene.bodies.size());
  x.setZero();
  for (int a = 0; a < 3; ++a) std::fill(x.velocity[a].begin(), x.velocity[a].end(), velocity[a]);
  scene.problem.toUnknowns(x.velocity);
  for (auto& twist : x.bodies) twist.head<3>() = velocity;
  StepOperator op;
  op.set(&scene.problem.coefficients, &scene.problem.rows);
  op.apply(x, Ax);
  const FaceField<double> liquid = scene.problem.liquidMass();
  const Lattice& l = scene.grid.lattice;
  int faces = 0;
  for (int a = 0; a < 3; ++a) {
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) {
          const auto f = l.index(i, j, k);
          if (!(c.mass[a][f] > 0.0)) continue;
          // What is left is inertia, that of the liquid in the face.
          const double share = scene.problem.flux_share[a][f];
          EXPECT_NEAR(Ax.velocity[a][f] * share, liquid[a][f] * velocity[a], 1e-11);
          EXPECT_NEAR(liquid[a][f], share, 1e-12);
          ++faces;
        }
      }
    }
  }
  for (const double d : Ax.pressure) EXPECT_NEAR(d, 0.0, 1e-12);
  for (const Vector6d& force : Ax.bodies) EXPECT_LT(force.norm(), 1e-10);
  EXPECT_GT(faces, 1000);
}

// -- a step

TEST(FractionStep, SolversAgreeAndMomentumBalances) {
  for (const double viscosity : {0.0, 2.0}) {
    FractionScene scene(kPeriodic, viscosity, kFull);
    StepProblem& p = scene.problem;
    const Lattice& l = scene.grid.lattice;
    std::mt19937 random(7);
    std::normal_distribution<double> gauss;
    FaceField<double> free_velocity;
    for (int a = 0; a < 3; ++a) {
      free_velocity[a].assign(l.size, 0.0);
      for (int k = 0; k < l.n[2]; ++k) {
        for (int j = 0; j < l.n[1]; ++j) {
          for (int i = 0; i < l.n[0]; ++i) free_velocity[a][l.index(i, j, k)] = gauss(random);
        }
      }
    }
    std::vector<Vector6d> twists(scene.bodies.size());
    for (auto& twist : twists) twist = Vector6d::NullaryExpr([&] { return gauss(random); });
    StepVector rhs;
    ASSERT_EQ(p.rightSide(free_velocity, twists, Eigen::Vector3d::Zero(), rhs), "");
    CoupledOptions options;
    options.tolerance = 1e-10;
    StepVector x, y;
    for (auto* v : {&x, &y}) v->resize(l, scene.bodies.size());
    DirectSolver direct;
    direct.prepare(p);
    const CoupledReport exact = direct.solve(rhs, options, x);
    ASSERT_EQ(exact.status, SolveStatus::kConverged) << exact.message;
    FastSolver fast;
    fast.prepare(p);
    const CoupledReport report = fast.solve(rhs, options, y);
    ASSERT_EQ(report.status, SolveStatus::kConverged) << report.message;
    double difference = 0.0, size = 0.0;
    for (int a = 0; a < 3; ++a) {
      for (std::size_t f = 0; f < l.size; ++f) {
        difference = std::max(difference, std::abs(x.velocity[a][f] - y.velocity[a][f]));
        size = std::max(size, std::abs(x.velocity[a][f]));
      }
    }
    EXPECT_LT(difference, 1e-6 * size);

    // Nothing but liquid and bodies here, so their momentum is what it was, and kinetic energy does not grow.
    const FaceField<double> liquid = p.liquidMass();
    FaceField<double> velocity = x.velocity;
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;
    double energy_before = 0.0, energy_after = 0.0;
    for (int a = 0; a < 3; ++a) {
      for (int k = 0; k < l.n[2]; ++k) {
        for (int j = 0; j < l.n[1]; ++j) {
          for (int i = 0; i < l.n[0]; ++i) {
            const auto f = l.index(i, j, k);
            if (!(liquid[a][f] > 0.0)) continue;
            const double u = x.velocity[a][f] / p.flux_share[a][f];
            before[a] += liquid[a][f] * free_velocity[a][f];
            after[a] += liquid[a][f] * u;
            energy_before += 0.5 * liquid[a][f] * free_velocity[a][f] * free_velocity[a][f];
            energy_after += 0.5 * liquid[a][f] * u * u;
          }
        }
      }
    }
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const Matrix6d& M = p.inertia[p.free_index[b]];
      before += (M * twists[b]).head<3>();
      after += (M * x.bodies[b]).head<3>();
      energy_before += 0.5 * twists[b].dot(M * twists[b]);
      energy_after += 0.5 * x.bodies[b].dot(M * x.bodies[b]);
    }
    EXPECT_LT((after - before).norm(), 1e-7 * std::sqrt(2.0 * energy_before));
    EXPECT_LT(energy_after, energy_before);
    EXPECT_GT(energy_after, 0.0);
  }
}

}  // namespace
}  // namespace monolith
