#include "solve/lcp.h"

namespace monolith {

LcpReport solveLcp(const Eigen::Ref<const Eigen::MatrixXd>& M, const Eigen::VectorXd& q, Eigen::VectorXd& x) {
  const int n = static_cast<int>(q.size());
  LcpReport report;
  report.active.assign(n, 0);
  x = Eigen::VectorXd::Zero(n);
  if (n == 0) {
    report.solved = true;
    return report;
  }
  const double scale = std::max(q.cwiseAbs().maxCoeff(), 1e-300);
  const double tolerance = 1e-12;
  constexpr int kPatience = 10;
  int least = n + 1;
  int patience = kPatience;
  const int limit = 50 * n + 100;
  while (report.pivots < limit) {
    std::vector<int> set;
    for (int i = 0; i < n; ++i) {
      if (report.active[i]) set.push_back(i);
    }
    x.setZero();
    if (!set.empty()) {
      const Eigen::VectorXd part = M(set, set).ldlt().solve(-q(set));
      for (std::size_t i = 0; i < set.size(); ++i) x[set[i]] = part[static_cast<int>(i)];
    }
    const Eigen::VectorXd w = M * x + q;
    const double x_scale = std::max(x.cwiseAbs().maxCoeff(), 1e-300);
    std::vector<int> wrong;
    for (int i = 0; i < n; ++i) {
      if (report.active[i] ? x[i] < -tolerance * x_scale : w[i] < -tolerance * scale) wrong.push_back(i);
    }
    if (wrong.empty()) {
      x = x.cwiseMax(0.0);
      report.solved = true;
      return report;
    }
    ++report.pivots;
    if (static_cast<int>(wrong.size()) < least) {
      least = static_cast<int>(wrong.size());
      patience = kPatience;
    } else if (patience > 0) {
      --patience;
    } else {
      wrong = {wrong.back()};
    }
    for (int i : wrong) report.active[i] ^= 1;
  }
  return report;
}

}  // namespace monolith
