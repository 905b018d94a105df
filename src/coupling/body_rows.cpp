#include "coupling/body_rows.h"

#include <utility>

namespace monolith {

Vector6d velocityRow(int axis, const Eigen::Vector3d& x, const Eigen::Vector3d& p_WBcm) {
  Vector6d row;
  row.head<3>() = Eigen::Vector3d::Unit(axis);
  row.tail<3>() = (x - p_WBcm).cross(Eigen::Vector3d::Unit(axis));
  return row;
}

Eigen::Vector3d toImageAt(const RigidBody& body, const MacGrid& grid, const Eigen::Vector3d& x) {
  if (!grid.lattice.anyPeriodic()) return Eigen::Vector3d::Zero();
  return grid.toNearestImage(x, body.pose() * body.distance->bounds().center());
}

void appendRows(const std::vector<BodyRows>& parts, BodyRows& out) {
  constexpr int kLists = 11;
  const auto list = [](auto& rows, int i) -> auto& {
    return i == 0   ? rows.divergence
           : i == 1 ? rows.enclosed
           : i < 5  ? rows.normal[i - 2]
           : i < 8  ? rows.shear[i - 5]
                    : rows.drag[i - 8];
  };
#pragma omp parallel for schedule(dynamic)
  for (int i = 0; i < kLists; ++i) {
    std::vector<BodyRow>& to = list(out, i);
    std::size_t size = to.size();
    for (const BodyRows& part : parts) size += list(part, i).size();
    to.reserve(size);
    for (const BodyRows& part : parts) to.insert(to.end(), list(part, i).begin(), list(part, i).end());
  }
}

namespace {

// The rows of a body in one plane of its box.
void appendPlane(const MacGrid& grid, const BodyFractions& f, int body, int k, const Eigen::Vector3d& p_WBcm,
                 const StaggeredCoefficients<double>& coefficients, BodyRows& out) {
  const Lattice& l = grid.lattice;
  for (int j = 0; f.within(1, j + 1) >= 0 && j < f.count[1]; ++j) {
    for (int i = 0; f.within(0, i + 1) >= 0 && i < f.count[0]; ++i) {
      const std::array<int, 3> at = {f.low[0] + i, f.low[1] + j, f.low[2] + k};
      const auto c = l.indexInTank(at);
      if (c < 0) continue;
      Vector6d row = Vector6d::Zero();
      for (int a = 0; a < 3; ++a) {
        int next[3] = {i, j, k};
        next[a] = f.within(a, next[a] + 1);
        const double low = f.face[a][f.local(i, j, k)];
        const double high = f.face[a][f.local(next[0], next[1], next[2])];
        // The lever arm of both faces is the same about the axis that counts, so equal fractions cancel exactly.
        if (low == high) continue;
        row += (high - low) * velocityRow(a, grid.faceCenter(a, at[0], at[1], at[2]), p_WBcm);
      }
      if (row.cwiseAbs().maxCoeff() == 0.0) continue;
      (coefficients.has_pressure[c] ? out.divergence : out.enclosed).push_back({c, body, row});
    }
  }
}

}  // namespace

void buildDivergenceRows(const MacGrid& grid, const SolidFractions& solids, const std::vector<RigidBody>& bodies,
                         const StaggeredCoefficients<double>& coefficients, BodyRows& out) {
  std::vector<std::pair<int, int>> planes;  // body, k
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const BodyFractions& f = solids.bodies[b];
    for (int k = 0; f.within(2, k + 1) >= 0 && k < f.count[2]; ++k) planes.emplace_back(static_cast<int>(b), k);
  }
  std::vector<BodyRows> parts(planes.size());
#pragma omp parallel for schedule(dynamic)
  for (std::size_t p = 0; p < planes.size(); ++p) {
    const auto [b, k] = planes[p];
    appendPlane(grid, solids.bodies[b], b, k, bodies[b].p_WBcm, coefficients, parts[p]);
  }
  appendRows(parts, out);
}

namespace {

// Of a body: the projection on the turns that displace nothing, and the point in W that they leave in place.
struct IdleTurns {
  Eigen::Matrix3d projection = Eigen::Matrix3d::Zero();
  Eigen::Vector3d from_centre_of_mass = Eigen::Vector3d::Zero();
};

IdleTurns idleTurns(const RigidBody& body) {
  IdleTurns out;
  if (body.shapes.size() != 1) return out;
  const Shape& shape = body.shapes[0];
  const Eigen::Isometry3d X_WG = body.pose() * shape.X_BG;
  out.from_centre_of_mass = X_WG.translation() - body.p_WBcm;
  if (shape.kind == Shape::Kind::kSphere) {
    out.projection.setIdentity();
  } else if (shape.kind == Shape::Kind::kCylinder) {
    const Eigen::Vector3d axis = X_WG.linear().col(2);
    out.projection = axis * axis.transpose();
  }
  return out;
}

}  // namespace

void dropIdleTurns(const std::vector<RigidBody>& bodies, std::vector<BodyRow>& rows) {
  std::vector<IdleTurns> idle;
  for (const RigidBody& body : bodies) idle.push_back(idleTurns(body));
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const IdleTurns& turns = idle[rows[i].body];
    Vector6d& row = rows[i].coefficient;
    const Eigen::Vector3d about_centre = row.tail<3>() - turns.from_centre_of_mass.cross(row.head<3>());
    row.tail<3>() -= turns.projection * about_centre;
  }
}

}  // namespace monolith
