#pragma once
// The bodies' columns of the step, row by row: J_p = -Q W_S^u G from differences of neighbouring fractions, so that
// what lies deep inside a body cancels (supplement of the paper that step_problem.h names, section 3), and J_s
// likewise.

#include <algorithm>
#include <array>
#include <vector>

#include "coupling/solid_fractions.h"
#include "fluid/mac_grid.h"
#include "rigid/rigid_body.h"
#include "solve/staggered_operator.h"

namespace monolith {

// Twist -> component `axis` of the velocity of the body's point at x.
Vector6d velocityRow(int axis, const Eigen::Vector3d& x, const Eigen::Vector3d& p_WBcm);

// From x to that of its periodic images which is nearest to the body: to the middle of its box. From its centre of mass
// a body may reach farther than half a period.
Eigen::Vector3d toImageAt(const RigidBody& body, const MacGrid& grid, const Eigen::Vector3d& x);

// What the twist of a body adds to one sample: coefficient . twist.
struct BodyRow {
  std::ptrdiff_t sample = 0;
  int body = 0;
  Vector6d coefficient = Vector6d::Zero();
};

struct BodyRows {
  std::vector<BodyRow> divergence;         // per cell with pressure
  std::vector<BodyRow> enclosed;           // likewise, per cell without: see enclosed_rows.h
  std::array<std::vector<BodyRow>, 3> normal;  // per cell: adds to U_a[c + a] - U_a[c]
  std::array<std::vector<BodyRow>, 3> shear;   // per edge: adds to t
  std::array<std::vector<BodyRow>, 3> drag;    // per sliver face: velocity of the solid there

  // 1 for the bodies, of `bodies`, that liquid touches.
  std::vector<char> touched(std::size_t bodies) const {
    std::vector<char> out(bodies, 0);
    const auto mark = [&](const std::vector<BodyRow>& rows) {
      for (const BodyRow& row : rows) out[row.body] = 1;
    };
    mark(divergence);
    mark(enclosed);
    for (const auto* kind : {&normal, &shear, &drag}) {
      for (const auto& samples : *kind) mark(samples);
    }
    return out;
  }
};

// Appends rows that were found part by part, in order.
void appendRows(const std::vector<BodyRows>& parts, BodyRows& out);

// Calls f(first, last) for the rows of each sample, in order of the samples.
template <class GroupFunction>
void forEachSample(const std::vector<BodyRow>& rows, GroupFunction&& f) {
  const auto before = [](const BodyRow& a, const BodyRow& b) { return a.sample < b.sample; };
  std::vector<BodyRow> sorted;
  const std::vector<BodyRow>* in_order = &rows;
  if (!std::is_sorted(rows.begin(), rows.end(), before)) {
    sorted = rows;
    std::stable_sort(sorted.begin(), sorted.end(), before);
    in_order = &sorted;
  }
  for (std::size_t first = 0; first < in_order->size();) {
    std::size_t last = first;
    while (last < in_order->size() && (*in_order)[last].sample == (*in_order)[first].sample) ++last;
    f(in_order->data() + first, in_order->data() + last);
    first = last;
  }
}

// J_p: the flux that a body's part of the faces carries out of each cell, from differences of neighbouring W_Si.
// Appends to divergence and enclosed.
void buildDivergenceRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                         const StaggeredCoefficients<double>& coefficients, BodyRows& out);

// A ball that turns displaces nothing, and neither does a cylinder that turns about its axis, while the faces that one
// of them cuts tell some flux: as much torque of the pressure, a thousandth of the weight times the radius of a ball 5
// cells across that floats, which spins it on waves. Takes from rows of divergence what they have of such turns: with
// c their centre, P the projection on such turns, and the row (f, t) about the centre of mass p,
//   t <- t - P (t - (c - p) x f).
// Not for liquid that sticks to what turns.
void dropIdleTurns(const std::vector<RigidBody>& bodies, std::vector<BodyRow>& rows);

}  // namespace monolith
