#pragma once
// Nearest points of line segments. A segment may shrink to a point.

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace monolith {

using PointPair = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

// Of p0 p1 and q0 q1; of parallel segments the middle of where they overlap.
PointPair nearestPoints(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& q0,
                        const Eigen::Vector3d& q1);

// Two segments that run alongside each other, the sine of their angle below `sine`: the ends of the stretch that
// they share, on p and on q. False if they don't (or if one is a point).
bool parallelOverlap(const std::vector<Eigen::Vector3d>& p, const std::vector<Eigen::Vector3d>& q, double sine,
                     std::vector<Eigen::Vector3d>& on_p, std::vector<Eigen::Vector3d>& on_q);

}  // namespace monolith
