#include "simulation/continued_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "coupling/body_rows.h"
#include "fluid/advection.h"
#include "solve/marked_entries.h"
#include "solve/whole_fields.h"

namespace monolith {
namespace {

constexpr int kDeep = 3;    // faces of liquid in a row: a sheet tells no slope
constexpr int kLayers = 3;  // the cubic that reads velocities next to the surface looks two further
// Where no pressure holds the liquid back, in the tip of a jet, what goes on as steep as it is would feed on itself
// from step to step. Less so where the slope is that of other components: it may be as many times steeper, which a wave
// of 12 cells length and a quarter of a cell height needs.
constexpr double kSteeperTurn = 6.0;
// Cells: of thinner walls the cubic reads from both sides faces in which means would mix what moves on the two.
constexpr double kMixingWall = 3.0;

// Where the vorticity about the edge between a face in air and a known one tells the velocity in the air. An edge's
// faces along b are `at_edge` and the one before it along the face's own axis.
struct Turn {
  int b = 0;
  int step = 0;  // along b, to the known face
  std::ptrdiff_t near = 0, at_edge = 0;
  bool deep = false;  // the edge beyond is known, too
  std::ptrdiff_t far = 0, at_next_edge = 0;
};

struct Turns {
  std::array<Turn, 4> of;
  int count = 0;
};

Turns findTurns(const Lattice& l, const FaceMask& known, int a, std::ptrdiff_t f, const std::array<int, 3>& at) {
  Turns turns;
  // What lies in a wall or beyond it tells nothing of the liquid.
  const auto isInside = [&](int b, int place) { return l.periodic[b] || (place >= 0 && place < l.n[b]); };
  const auto isKnown = [&](int b, std::ptrdiff_t edge) {
    return known[b][edge] != 0 && known[b][edge - l.stride[a]] != 0;
  };
  for (int b = 0; b < 3; ++b) {
    if (b == a) continue;
    for (const int step : {-1, 1}) {
      const auto along = step * l.stride[b];
      Turn turn{b, step, f + along, step < 0 ? f : f + along};
      if (!isInside(b, at[b] + step) || !known[a][turn.near] || !isKnown(b, turn.at_edge)) continue;
      turn.far = turn.near + along;
      turn.at_next_edge = turn.at_edge + along;
      turn.deep = isInside(b, at[b] + 2 * step) && known[a][turn.far] != 0 && isKnown(b, turn.at_next_edge);
      turns.of[turns.count++] = turn;
    }
  }
  return turns;
}

double meanOverTurns(const Lattice& l, const FaceField<double>& u, int a, const Turns& turns, double steepest) {
  const double most = kSteeperTurn * steepest;
  const auto difference = [&](int b, std::ptrdiff_t edge) { return u[b][edge] - u[b][edge - l.stride[a]]; };
  double sum = 0.0;
  for (int n = 0; n < turns.count; ++n) {
    const Turn& t = turns.of[n];
    const double vorticity =
        t.deep ? -t.step * (u[a][t.near] - u[a][t.far]) - difference(t.b, t.at_next_edge) : 0.0;
    sum += u[a][t.near] - t.step * std::clamp(difference(t.b, t.at_edge) + vorticity, -most, most);
  }
  return sum / turns.count;
}

// The two nearest faces of each row of kDeep known ones that begins next to a face.
struct Rows {
  std::array<std::array<std::ptrdiff_t, 2>, 6> of;
  int count = 0;
};

Rows findRows(const Lattice& l, const std::vector<std::uint8_t>& known, int a, std::ptrdiff_t f,
              const std::array<int, 3>& at) {
  Rows rows;
  for (int b = 0; b < 3; ++b) {
    for (const int step : {-1, 1}) {
      int found = 0;
      for (; found < kDeep; ++found) {
        const int place = at[b] + (found + 1) * step;
        const bool inside = place >= 0 && place < (b == a ? l.faceEnd(b) : l.n[b]);
        const auto next = f + (found + 1) * step * l.stride[b] - (inside ? 0 : step * l.n[b] * l.stride[b]);
        if (!(inside || l.periodic[b]) || !known[next]) break;
        if (found < 2) rows.of[rows.count][found] = next;
      }
      if (found == kDeep) ++rows.count;
    }
  }
  return rows;
}

double meanOverRows(const std::vector<double>& u, const Rows& rows, double steepest) {
  double sum = 0.0;
  for (int n = 0; n < rows.count; ++n) {
    const auto [near, far] = rows.of[n];
    sum += u[near] + std::clamp(u[near] - u[far], -steepest, steepest);
  }
  return sum / rows.count;
}

// f(face, {i, j, k}): for the faces of axis a in plane k that are not known but may be told by a turn or a row: most
// others next to known ones, as along the walls in the air, are not. 0 or 1 each, halos filled.
template <class Function>
void forEachTold(const Lattice& l, const FaceMask& known, int a, int k, Function&& f) {
  const int b = (a + 1) % 3, c = (a + 2) % 3;
  const auto sa = l.stride[a], sb = l.stride[b], sc = l.stride[c], sy = l.stride[1], sz = l.stride[2];
  const auto begin = l.index(0, 0, k);
  const auto count = l.index(l.faceEnd(0) - 1, l.faceEnd(1) - 1, k) + 1 - begin;
  const std::uint8_t *u = known[a].data() + begin, *v = known[b].data() + begin, *w = known[c].data() + begin;
  const auto highest = k + 2 < l.n[2] + Lattice::kHighHalo ? 2 * sz : sz;
  thread_local RowMarks marks;
  std::uint8_t* told = marks.start(count);
#pragma omp simd
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::uint8_t rows = (u[i - 1] & u[i - 2]) | (u[i + 1] & u[i + 2]) | (u[i - sy] & u[i - 2 * sy]) |
                              (u[i + sy] & u[i + 2 * sy]) | (u[i - sz] & u[i - 2 * sz]) | (u[i + sz] & u[i + highest]);
    const std::uint8_t turns = (u[i - sb] & v[i] & v[i - sa]) | (u[i + sb] & v[i + sb] & v[i + sb - sa]) |
                               (u[i - sc] & w[i] & w[i - sa]) | (u[i + sc] & w[i + sc] & w[i + sc - sa]);
    told[i] = static_cast<std::uint8_t>((rows | turns) & (u[i] ^ 1));
  }
  marks.forEach([&](std::ptrdiff_t i) {
    const std::array<int, 3> place = {static_cast<int>(i % sy), static_cast<int>(i / sy), k};
    if (place[0] < l.faceEnd(0)) f(begin + i, place);
  });
}

// Faces in air next to known ones: by the vorticity where the faces around an edge tell it, else by the slope of the
// velocity itself, as that along a surface's normal. Held constant instead, the surface's velocity would be that of up
// to half a cell below it.
void continueIntoAir(const Lattice& l, const SolidFractions& solids, const std::vector<LiquidField>& fields,
                     FaceMask& before, FaceMask& known) {
  for (int a = 0; a < 3; ++a) {
    for (const LiquidField& field : fields) fillHalo(l, (*field.values)[a]);
    fillHalo(l, known[a]);
    copyField(known[a], before[a]);
  }
  const int planes = l.faceEnd(2);
#pragma omp parallel for schedule(static, kPlanesInTurn)
  for (int plane = 0; plane < 3 * planes; ++plane) {
    const int a = plane / planes;
    forEachTold(l, before, a, plane % planes, [&](std::ptrdiff_t f, const std::array<int, 3>& at) {
      if (!(solids.distance[a][f] > 0.0F && solids.fluid[a][f] > 0.0)) return;
      const Turns turns = findTurns(l, before, a, f, at);
      const Rows rows = turns.count > 0 ? Rows() : findRows(l, before[a], a, f, at);
      if (turns.count + rows.count == 0) return;
      for (const LiquidField& field : fields) {
        FaceField<double>& u = *field.values;
        u[a][f] =
            turns.count > 0 ? meanOverTurns(l, u, a, turns, field.steepest) : meanOverRows(u[a], rows, field.steepest);
      }
      known[a][f] = 1;
    });
  }
}

}  // namespace

void completeMotion(const SolidFractions& solids, const MacGrid& grid, const std::vector<RigidBody>& bodies, int layers,
                    bool sticks, bool no_slip, const std::vector<LiquidField>& fields, FaceMask& known,
                    FaceMask& work) {
  const Lattice& l = grid.lattice;
  const int width = l.faceEnd(0);
  for (int a = 0; a < 3; ++a) {
    forEachRow(l, [&](std::ptrdiff_t row, int j, int k) {
      std::uint8_t* has = known[a].data() + row;
      if (std::memchr(has, 0, width) == nullptr) return;
      for (const LiquidField& field : fields) {
        double* values = (*field.values)[a].data() + row;
#pragma omp simd
        for (int i = 0; i < width; ++i) values[i] = has[i] != 0 ? values[i] : 0.0;
      }
      thread_local RowMarks marks;
      std::uint8_t* in_solid = marks.start(width);
      const float* distance = solids.distance[a].data() + row;
#pragma omp simd
      for (int i = 0; i < width; ++i) in_solid[i] = (has[i] == 0) & (distance[i] <= 0.0F);
      marks.forEach([&](std::ptrdiff_t i) {
        const auto f = row + i;
        const int owner = solids.owner[a][f];
        const bool wall_face = owner < 0;
        if (wall_face) {
          has[i] = 1;
        } else if (sticks || bodies[owner].thinnest < kMixingWall * grid.h) {
          const Eigen::Vector3d x = grid.faceCenter(a, static_cast<int>(i), j, k);
          const RigidBody& body = bodies[owner];
          const Vector6d point = velocityRow(a, x + toImageAt(body, grid, x), body.p_WBcm);
          for (const LiquidField& field : fields) (*field.values)[a][f] = point.dot((*field.of_bodies)[owner]);
          has[i] = 1;
        }
      });
    });
  }
  for (int layer = 0; layer < kLayers; ++layer) continueIntoAir(l, solids, fields, work, known);
  std::vector<FaceField<double>*> values;
  for (const LiquidField& field : fields) values.push_back(field.values);
  extrapolateVelocity(l, layers, no_slip, known, values);
}

}  // namespace monolith
