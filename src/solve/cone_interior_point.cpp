#include "solve/cone_interior_point.h"

#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "solve/contact_system.h"
#include "solve/coulomb_newton.h"

namespace monolith {
namespace {

constexpr int kMaximumSteps = 60;
constexpr double kToBoundary = 0.99;  // part of the way there that a step goes at most
constexpr double kShort = 0.1;        // a step that gets nowhere
// Residual, relative to w0, from which |w_t| is differentiated; where that has led nowhere never, and then from the
// start.
constexpr double kNear[] = {0.1, 0.0, 1e300};
constexpr double kLeastStep = 1e-10;
// Residuals of the law, relative to w0, at which Newton's method is tried.
constexpr double kWorthPolishing = 1e-3, kPolishAgain = 0.3;

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// The Jordan algebra of L: x o y = (x . y, x_0 y_1..2 + y_0 x_1..2), with the determinant x_0^2 - |x_1..2|^2.
double determinant(const Vector3d& x) {
  const double length = x.tail<2>().norm();
  return (x[0] - length) * (x[0] + length);
}

Vector3d product(const Vector3d& x, const Vector3d& y) {
  Vector3d out;
  out[0] = x.dot(y);
  out.tail<2>() = x[0] * y.tail<2>() + y[0] * x.tail<2>();
  return out;
}

// y with x o y = b.
Vector3d quotient(const Vector3d& b, const Vector3d& x) {
  Vector3d y;
  y[0] = (x[0] * b[0] - x.tail<2>().dot(b.tail<2>())) / determinant(x);
  y.tail<2>() = (b.tail<2>() - y[0] * x.tail<2>()) / x[0];
  return y;
}

// Largest t for which x + t d is in L: its determinant's smallest positive root, or where x_0 ends.
double reach(const Vector3d& x, const Vector3d& d) {
  double t = d[0] < 0.0 ? -x[0] / d[0] : std::numeric_limits<double>::infinity();
  const double a = d[0] * d[0] - d.tail<2>().squaredNorm();
  const double b = x[0] * d[0] - x.tail<2>().dot(d.tail<2>());
  const double c = std::max(determinant(x), 0.0);
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return t;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  for (const double root : {a != 0.0 ? q / a : 0.0, q != 0.0 ? c / q : 0.0}) {
    if (root > 0.0) t = std::min(t, root);
  }
  return t;
}

// W with W z = W^-1 x, symmetric.
struct Scaling {
  Matrix3d W, inverse;

  Scaling(const Vector3d& x, const Vector3d& z) {
    constexpr double kTiny = 1e-300;
    const double of_x = std::sqrt(std::max(determinant(x), kTiny)), of_z = std::sqrt(std::max(determinant(z), kTiny));
    const Vector3d a = x / of_x, b = z / of_z;
    const double g = std::sqrt(2.0 * (1.0 + a.dot(b)));
    const double v0 = (a[0] + b[0]) / g;
    const Vector2d v = (a.tail<2>() - b.tail<2>()) / g;
    W(0, 0) = v0;
    W.block<1, 2>(0, 1) = v.transpose();
    W.block<2, 1>(1, 0) = v;
    W.block<2, 2>(1, 1) = Eigen::Matrix2d::Identity() + v * v.transpose() / (1.0 + v0);
    inverse = W;
    inverse.block<1, 2>(0, 1) *= -1.0;
    inverse.block<2, 1>(1, 0) *= -1.0;
    const double size = std::sqrt(of_x / of_z);
    W *= size;
    inverse /= size;
  }
};

// A x + q + s(z) = z with s = (|z_1..2|, 0, 0) at each contact: 3 entries a contact, in the cones' own units.
class InteriorPoint {
 public:
  InteriorPoint(const FrictionProblem& problem, double near)
      : problem_(problem),
        m_(problem.count()),
        near_(near),
        speed_(std::max(problem.w0.cwiseAbs().maxCoeff(), 1e-300)) {
    const Eigen::Index n = 3 * m_;
    place_.resize(n);
    unit_.resize(n);
    // Without friction x is lambda alone: the other two stay zero.
    for (Eigen::Index c = 0; c < m_; ++c) {
      const double mu = problem.mu[c];
      for (int d = 0; d < 3; ++d) place_[3 * c + d] = problem.entry(c, d);
      unit_[3 * c] = mu > 0.0 ? 1.0 / mu : 1.0;
      unit_.segment<2>(3 * c + 1).setConstant(mu > 0.0 ? 1.0 : 0.0);
    }
    A_ = unit_.asDiagonal() * problem.D(place_, place_) * unit_.asDiagonal();
    all_.resize(m_);
    std::iota(all_.begin(), all_.end(), 0);
    nonzero_ = (unit_.array() > 0.0).select(unit_, 1.0);
    q_ = unit_.cwiseProduct(problem.w0(place_));
    x_ = z_ = VectorXd::Zero(n);
    for (Eigen::Index c = 0; c < m_; ++c) {
      x_[3 * c] = speed_ * static_cast<double>(n) / A_.trace();
      z_[3 * c] = speed_;
    }
  }

  VectorXd impulses() const {
    VectorXd r(3 * m_);
    r(place_) = unit_.cwiseProduct(x_);
    return r;
  }

  // False if it leads no further.
  bool step();

 private:
  // Direction for which products o of scaled x and z become b, to first order.
  struct Direction {
    VectorXd x, z;
  };

  Vector3d x(Eigen::Index c) const { return x_.segment<3>(3 * c); }
  Vector3d z(Eigen::Index c) const { return z_.segment<3>(3 * c); }
  Vector2d slip(Eigen::Index c) const { return z_.segment<2>(3 * c + 1); }
  // Derivative of s.
  Matrix3d slipDerivative(Eigen::Index c) const {
    Matrix3d out = Matrix3d::Zero();
    const double length = slip(c).norm();
    if (length > 0.0) out.block<1, 2>(0, 1) = slip(c).transpose() / length;
    return out;
  }
  double longest(const Direction& d) const {
    double t = 1.0 / kToBoundary;
    for (Eigen::Index c = 0; c < m_; ++c) {
      t = std::min({t, reach(x(c), d.x.segment<3>(3 * c)), reach(z(c), d.z.segment<3>(3 * c))});
    }
    return t;
  }

  // (A + N) x = b with N of 3 x 3 blocks, by the impulses: D r + unit^-1 N unit^-1 r = unit^-1 b. Entries without a
  // unit have no part in A.
  ContactSystem system(const std::vector<Matrix3d>& N) const;
  VectorXd perUnit(const VectorXd& x) const { return x.cwiseQuotient(nonzero_); }

  const FrictionProblem& problem_;
  Eigen::Index m_;
  double near_, speed_;
  std::vector<Eigen::Index> place_;  // in r
  std::vector<Eigen::Index> all_;    // contacts
  VectorXd unit_, nonzero_;          // r = unit x; 1 where that is 0
  Eigen::MatrixXd A_;
  VectorXd q_, x_, z_;
  double last_ = 1.0;     // length of the last step
  bool coupled_ = false;  // whether |w_t| was differentiated in it
};

ContactSystem InteriorPoint::system(const std::vector<Matrix3d>& N) const {
  std::vector<Matrix3d> turn, own;
  for (Eigen::Index c = 0; c < m_; ++c) {
    const Vector3d inverse = nonzero_.segment<3>(3 * c).cwiseInverse();
    turn.emplace_back(unit_.segment<3>(3 * c).cwiseProduct(inverse).asDiagonal());
    own.emplace_back(inverse.asDiagonal() * N[c] * inverse.asDiagonal());
  }
  return {problem_, all_, std::move(turn), std::move(own)};
}

bool InteriorPoint::step() {
  VectorXd residual = A_ * x_ + q_ - z_;
  for (Eigen::Index c = 0; c < m_; ++c) residual[3 * c] += slip(c).norm();
  const double gap = x_.dot(z_) / static_cast<double>(m_);
  coupled_ = residual.cwiseAbs().maxCoeff() < near_ * speed_ && !(coupled_ && last_ < kShort);

  std::vector<Scaling> scaling;
  VectorXd scaled(3 * m_);
  std::vector<Matrix3d> own;
  for (Eigen::Index c = 0; c < m_; ++c) {
    scaling.emplace_back(x(c), z(c));
    scaled.segment<3>(3 * c) = scaling[c].W * z(c);
    const Matrix3d square = scaling[c].inverse * scaling[c].inverse;
    own.push_back(coupled_ ? Matrix3d(square - slipDerivative(c) * square) : square);
  }
  const ContactSystem steps = system(own);

  const auto direction = [&](const VectorXd& b) {
    VectorXd h(3 * m_), right = -residual;
    for (Eigen::Index c = 0; c < m_; ++c) {
      const Vector3d part = scaling[c].inverse * quotient(b.segment<3>(3 * c), scaled.segment<3>(3 * c));
      h.segment<3>(3 * c) = part;
      right.segment<3>(3 * c) += coupled_ ? Vector3d(part - slipDerivative(c) * part) : part;
    }
    Direction d;
    d.x = perUnit(steps.solve(perUnit(right)));
    d.z = h;
    for (Eigen::Index c = 0; c < m_; ++c) {
      d.z.segment<3>(3 * c) -= scaling[c].inverse * (scaling[c].inverse * d.x.segment<3>(3 * c));
    }
    return d;
  };

  VectorXd b(3 * m_);
  for (Eigen::Index c = 0; c < m_; ++c) {
    b.segment<3>(3 * c) = -product(scaled.segment<3>(3 * c), scaled.segment<3>(3 * c));
  }
  const Direction predicted = direction(b);
  const double centring = std::pow(1.0 - std::min(1.0, longest(predicted)), 3);
  for (Eigen::Index c = 0; c < m_; ++c) {
    b.segment<3>(3 * c) -=
        product(scaling[c].inverse * predicted.x.segment<3>(3 * c), scaling[c].W * predicted.z.segment<3>(3 * c));
    b[3 * c] += centring * gap;
  }
  const Direction corrected = direction(b);
  if (!corrected.x.allFinite() || !corrected.z.allFinite()) return false;
  last_ = std::min(1.0, kToBoundary * longest(corrected));
  x_ += last_ * corrected.x;
  z_ += last_ * corrected.z;
  return last_ > kLeastStep;
}

}  // namespace

int findInteriorPoint(const FrictionProblem& problem, ClosestToLaw& closest) {
  const double polishable = kWorthPolishing * problem.w0.cwiseAbs().maxCoeff();
  int steps = 0;
  for (const double near : kNear) {
    InteriorPoint point(problem, near);
    double worth = polishable;
    for (int step = 0; step < kMaximumSteps && point.step(); ++step) {
      ++steps;
      const VectorXd r = point.impulses();
      double residual;
      if (closest.offer(r, &residual)) return steps;
      if (residual > worth) continue;
      worth = kPolishAgain * residual;
      steps += polishByNewton(problem, r, closest);
      if (closest.arrived()) return steps;
    }
    if (closest.residual() <= polishable) break;
  }
  return steps;
}

}  // namespace monolith
