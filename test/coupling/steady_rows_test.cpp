// What is kept of rows where nothing has changed is what would be built anew, to the bit, whatever has happened before.

#include "solve/steady_rows.h"

#include <gtest/gtest.h>

#include <random>

#include "coupling/permeability.h"
#include "coupling/row_kinds.h"
#include "coupling/step_problem.h"
#include "scene/solid_body.h"
#include "solve/pressure_multigrid.h"
#include "solve/stokes_stencil.h"

namespace monolith {
namespace {

constexpr double kDensity = 1000.0, kTimeStep = 0.01;

// One assembly of a sequence.
struct Moment {
  Eigen::Vector3d position;  // of the sphere, m
  double fill;               // cells, or more than there are: no surface
  double slope;              // of the surface
  double number;             // viscous
  bool rates = false;
  bool skips = false;  // what is in single precision misses it
};

// All that is built for a step, by one object after the other or by the same one.
struct Built {
  explicit Built(const MacGrid& grid, double sticking_viscosity) : problem(grid) {
    problem.sticking_viscosity = sticking_viscosity;
  }

  void make(const Moment& at, bool keep) {
    const MacGrid& grid = problem.grid;
    const Lattice& l = grid.lattice;
    bodies = {makeRigidBody(sphereBody("sphere", 0.11, 1500.0, at.position), 0.5 * grid.h)};
    SolidSampler(grid).sample(bodies, solids);
    std::vector<double> liquid(l.size, 0.0);
    for (int k = 0; k < l.n[2]; ++k) {
      for (int j = 0; j < l.n[1]; ++j) {
        for (int i = 0; i < l.n[0]; ++i) liquid[l.index(i, j, k)] = k + 0.5 + at.slope * i - at.fill;
      }
    }
    extendIntoHalo(l, liquid);
    problem.assemble(solids, bodies, liquid, kDensity, at.number * kDensity * grid.h * grid.h / kTimeStep, kTimeStep,
                     at.rates);
    const SteadyRows* steady = keep ? &problem.steady : nullptr;
    const StaggeredCoefficients<double>& c = problem.coefficients;
    buildFaceBlocks(c, faces, &transfer, &impulse, steady);
    buildCellBlocks(c, cells, steady);
    skipped = at.skips;
    if (!skipped) {
      faces.convertTo(single);
      cells.convertTo(single_cells);
    }
    pressure.set(l, c.has_pressure, c.fluid(), impulse, steady);
    holds = c.viscous && at.number > 1.0;
    if (!holds) {
      held.set(l, c.has_pressure, c.fluid(), impulse, steady);
      return;
    }
    velocity.set(l, single, transfer, problem.coarse.levels, problem.coarse.levels.size(), problem.coarse.generation(),
                 2);
    permeability.set(problem, at.number, velocity, impulse);
    if (!permeability.lasted()) held.distrust();
    held.set(l, c.has_pressure, c.fluid(), permeability.impulse(), steady, &permeability.sharp());
  }

  StepProblem problem;
  std::vector<RigidBody> bodies;
  SolidFractions solids;
  FaceBlocks<double> faces;
  CellBlocks<double> cells;
  FaceBlocks<float> single;
  CellBlocks<float> single_cells;
  FaceRows<float> transfer, impulse;
  PressureMultigrid pressure;
  VelocityMultigrid velocity;
  bool skipped = false;  // this moment
  bool holds = false;    // at this moment viscosity does hold the liquid back
  Permeability permeability;
  PressureMultigrid held;  // with permeability where it holds
};

// Momentum and divergence of random unknowns.
template <class Real>
std::vector<std::vector<Real>> applied(const StepProblem& problem, const FaceBlocks<Real>& faces,
                                       const CellBlocks<Real>& cells, const FaceField<double>& U) {
  const Lattice& l = problem.grid.lattice;
  FaceField<Real> u;
  for (int a = 0; a < 3; ++a) u[a].assign(U[a].begin(), U[a].end());
  const std::vector<Real> p = u[1];
  std::vector<std::vector<Real>> out(4, std::vector<Real>(l.size, Real(0)));
  const Faces<const Real> from{u[0].data(), u[1].data(), u[2].data()};
  applyMomentum(l, faces, problem.coefficients.viscous, from, p.data(),
                Faces<Real>{out[0].data(), out[1].data(), out[2].data()});
  applyDivergence(l, cells, from, Real(0), static_cast<const Real*>(nullptr), out[3].data());
  return out;
}

FaceField<double> randomFaces(const Lattice& l, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  FaceField<double> out;
  for (auto& field : out) {
    field.resize(l.size);
    for (double& value : field) value = unit(random);
    fillHalo(l, field);
  }
  return out;
}

void expectTheSame(Built& kept, Built& fresh, const std::string& what) {
  const auto &c = kept.problem.coefficients, &d = fresh.problem.coefficients;
  const Lattice& l = c.lattice;
  EXPECT_EQ(c.has_pressure, d.has_pressure) << what;
  for (int a = 0; a < 3; ++a) {
    EXPECT_EQ(c.mass[a], d.mass[a]) << what;
    for (std::size_t f = 0; f < l.size; ++f) ASSERT_EQ(c.open(a)[f], d.open(a)[f]) << what << ", " << f;
    EXPECT_EQ(c.drag[a], d.drag[a]) << what;
    EXPECT_EQ(c.normal[a], d.normal[a]) << what;
    for (int s = 0; s < 2; ++s) EXPECT_EQ(c.shear[a][s], d.shear[a][s]) << what;
    EXPECT_EQ(kept.transfer[a], fresh.transfer[a]) << what;
    EXPECT_EQ(kept.impulse[a], fresh.impulse[a]) << what;
  }
  FaceField<double> U = randomFaces(l, 7);
  EXPECT_EQ(applied(kept.problem, kept.faces, kept.cells, U), applied(fresh.problem, fresh.faces, fresh.cells, U))
      << what;
  if (!kept.skipped) {
    EXPECT_EQ(applied(kept.problem, kept.single, kept.single_cells, U),
              applied(fresh.problem, fresh.single, fresh.single_cells, U))
        << what;
  }
  std::vector<float> g(l.size, 0.0f);
  for (std::size_t i = 0; i < l.size; ++i) g[i] = d.has_pressure[i] ? static_cast<float>(U[2][i]) : 0.0f;
  clearHalo(l, g);
  const float* x = kept.pressure.cycle(g.data());
  const float* y = fresh.pressure.cycle(g.data());
  EXPECT_EQ(std::vector<float>(x, x + l.size), std::vector<float>(y, y + l.size)) << what;
  // The coarse levels may be older than this moment, but what has been made of them is what would be made of them anew.
  PressureMultigrid anew;
  if (kept.holds) {
    EXPECT_EQ(kept.permeability.sharp(), fresh.permeability.sharp()) << what;
    anew.set(l, d.has_pressure, d.fluid(), kept.permeability.impulse(), nullptr, &kept.permeability.sharp());
  } else {
    anew.set(l, d.has_pressure, d.fluid(), fresh.impulse);
  }
  x = kept.held.cycle(g.data());
  y = anew.cycle(g.data());
  EXPECT_EQ(std::vector<float>(x, x + l.size), std::vector<float>(y, y + l.size)) << what;
}

int steadyRows(const StepProblem& problem) {
  const Lattice& l = problem.grid.lattice;
  int count = 0;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) count += problem.steady.steady(j, k);
  }
  return count;
}

TEST(SteadyRows, KeepWhatWouldBeBuiltAnew) {
  for (const bool open : {false, true}) {
    MacGrid grid;
    grid.lattice = Lattice({20, 22, 24}, {open, open, false});
    grid.h = 0.05;
    const double full = 100.0;
    const std::vector<Moment> moments = {
        {{0.5, 0.5, 0.3}, full, 0.0, 1.0},   {{0.5, 0.51, 0.3}, full, 0.0, 1.0},
        {{0.5, 0.51, 0.3}, full, 0.0, 1.0},  {{0.5, 0.2, 0.9}, full, 0.0, 1.0, false, true},
        {{0.5, 0.2, 0.9}, full, 0.0, 1.0},   {{0.5, 0.2, 0.9}, full, 0.0, 0.6},
        {{0.5, 0.2, 0.9}, 12.3, 0.0, 0.6},   {{0.5, 0.21, 0.85}, 12.3, 0.1, 0.6},
        {{0.5, 0.21, 0.85}, 12.1, 0.0, 0.6}, {{0.5, 0.22, 0.8}, 12.1, 0.0, 0.6, true},
        {{0.5, 0.23, 0.8}, 12.1, 0.0, 0.6},  {{0.5, 0.95, 0.8}, 9.4, 0.0, 0.6},
        {{0.5, 0.95, 0.8}, 9.4, 0.0, 0.0},   {{0.5, 0.9, 0.75}, 9.5, 0.02, 0.0},
        {{0.5, 0.9, 0.75}, 9.5, 0.02, 1e-3}, {{0.5, 0.88, 0.7}, 9.6, 0.02, 1e-3},
        {{0.5, 0.88, 0.7}, full, 0.0, 50.0}, {{0.5, 0.6, 0.2}, full, 0.0, 50.0},
        {{0.5, 0.6, 0.2}, 12.0, 0.0, 0.6},   {{0.5, 0.6, 0.2}, 12.0, 0.0, 20.0}};
    // So that liquid sticks at some of the viscous numbers only.
    const double sticking = 0.01 * kDensity * grid.h * grid.h / kTimeStep;
    Built kept(grid, sticking);
    int steady = 0;
    for (std::size_t i = 0; i < moments.size(); ++i) {
      kept.make(moments[i], true);
      steady += steadyRows(kept.problem);
      Built fresh(grid, sticking);
      fresh.make(moments[i], false);
      expectTheSame(kept, fresh, (open ? "open, " : "walls, ") + std::to_string(i));
      if (i == 12) kept.problem.forget();
    }
    // Enough of them for the comparison to tell anything.
    EXPECT_GT(steady, 1000);
  }
}

// A field that has followed every build holds something in the blocks there are, and nowhere else.
TEST(StencilBlocks, ClearsWhatItHasLost) {
  MacGrid grid;
  grid.lattice = Lattice({20, 12, 14}, {false, false, false});
  grid.h = 0.05;
  Built built(grid, 0.0);
  FaceField<float> field;
  long build = -1;
  int lost = 0;
  const std::vector<Moment> moments = {{{0.3, 0.3, 0.3}, 9.3, 0.0, 1.0},    {{0.3, 0.3, 0.3}, 7.3, 0.1, 1.0},
                                       {{0.7, 0.3, 0.3}, 7.3, -0.1, 1.0},   {{0.7, 0.3, 0.3}, 100.0, 0.0, 1.0},
                                       {{0.7, 0.3, 0.25}, 100.0, 0.0, 1.0}, {{0.7, 0.3, 0.25}, 3.4, 0.0, 0.0},
                                       {{0.2, 0.3, 0.25}, 5.4, 0.0, 0.0}};
  for (std::size_t i = 0; i < moments.size(); ++i) {
    built.make(moments[i], true);
    if (i == 3) continue;  // one that the field misses
    for (int a = 0; a < 3; ++a) built.faces.clear(a, build, field[a]);
    build = built.faces.build();
    lost += static_cast<int>(built.faces.lost().size());
    FaceField<float> only;
    for (auto& f : only) f.assign(grid.lattice.size, 0.0f);
    built.faces.forEach([&](int a, std::ptrdiff_t place, const double*) {
      for (int lane = 0; lane < kLanes; ++lane) field[a][place + lane] = only[a][place + lane] = 1.0f;
    });
    for (int a = 0; a < 3; ++a) EXPECT_EQ(field[a], only[a]) << i;
  }
  EXPECT_GT(lost, 100);
}

TEST(SteadyRows, NothingHoldsThatWasBuiltBeforeTheLastGeneration) {
  const Lattice l({8, 8, 8}, {false, false, false});
  const std::vector<std::uint8_t> kinds(64, RowKinds::kLiquid);
  SteadyRows rows;
  rows.update(l, kinds, {1.0});
  const long first = rows.generation();
  EXPECT_FALSE(rows.steady(4, 4));
  rows.update(l, kinds, {1.0});
  EXPECT_TRUE(rows.steady(4, 4));
  EXPECT_TRUE(rows.isSuccessor(first));
  std::vector<std::uint8_t> changed = kinds;
  changed[0] = RowKinds::kMixed;
  rows.update(l, changed, {1.0});
  EXPECT_FALSE(rows.isSuccessor(first));
  EXPECT_FALSE(rows.steady(4, 4));
  EXPECT_TRUE(rows.steady(5, 4));
  rows.update(l, kinds, {2.0});
  EXPECT_FALSE(rows.steady(7, 7));
  const long last = rows.generation();
  rows.forget();
  EXPECT_FALSE(rows.isSuccessor(last));
  rows.update(l, kinds, {2.0});
  EXPECT_FALSE(rows.steady(7, 7));
}

}  // namespace
}  // namespace monolith
