#include "fluid/rheology.h"

#include <algorithm>
#include <cmath>

namespace monolith {
namespace {

// A liquid that thins without end still has a viscosity: this part of the one at rest.
constexpr double kLeastPart = 1e-9;

}  // namespace

ViscosityLaw ViscosityLaw::newtonian(double viscosity) {
  ViscosityLaw law;
  law.least_ = law.most_ = viscosity;
  return law;
}

ViscosityLaw ViscosityLaw::powerLaw(double consistency, double index, double least, double most) {
  return herschelBulkley(0.0, consistency, index, 0.0, least, most);
}

ViscosityLaw ViscosityLaw::carreauYasuda(double zero_shear, double infinite_shear, double time_constant, double index,
                                         double transition) {
  ViscosityLaw law;
  law.kind_ = Kind::kCarreau;
  law.consistency_ = zero_shear - infinite_shear;
  law.plateau_ = infinite_shear;
  law.index_ = index;
  law.time_constant_ = time_constant;
  law.transition_ = transition;
  law.most_ = std::max(zero_shear, infinite_shear);
  law.least_ = std::max(std::min(zero_shear, infinite_shear), kLeastPart * law.most_);
  return law;
}

ViscosityLaw ViscosityLaw::herschelBulkley(double yield_stress, double consistency, double index, double regularisation,
                                           double least, double most) {
  ViscosityLaw law;
  law.kind_ = Kind::kPower;
  law.yield_stress_ = yield_stress;
  law.consistency_ = consistency;
  law.index_ = index;
  law.time_constant_ = regularisation;
  law.least_ = least;
  law.most_ = most;
  return law;
}

double ViscosityLaw::viscosity(double rate) const {
  double eta = least_;
  if (kind_ == Kind::kPower) {
    eta = index_ == 1.0 ? consistency_ : consistency_ * std::pow(rate, index_ - 1.0);
    if (yield_stress_ > 0.0) {
      // (1 - exp(-m gamma))/gamma tends to m.
      const double x = time_constant_ * rate;
      eta += yield_stress_ * (x > 1e-12 ? -std::expm1(-x) / rate : time_constant_);
    }
  } else if (kind_ == Kind::kCarreau) {
    eta = plateau_ + consistency_ * std::pow(1.0 + std::pow(time_constant_ * rate, transition_),
                                             (index_ - 1.0) / transition_);
  }
  return std::clamp(eta, least_, most_);
}

}  // namespace monolith
