#pragma once
// Viscosity eta (Pa s) of a generalised Newtonian liquid as a function of the shear rate gamma = sqrt(2 D:D) (1/s),
// D the symmetric velocity gradient; the viscous stress is 2 eta D, its size in simple shear eta gamma.
//
//   power law            eta = K gamma^(n-1)                                        Ostwald 1925, de Waele 1923
//   Carreau-Yasuda       eta = eta_inf + (eta_0 - eta_inf) (1 + (lambda gamma)^a)^((n-1)/a)
//                        Carreau 1972, Trans. Soc. Rheol. 16, 99; Yasuda et al. 1981, Rheol. Acta 20, 163
//   Herschel-Bulkley     eta = K gamma^(n-1) + tau_0 (1 - exp(-m gamma))/gamma      Herschel & Bulkley 1926;
//                        regularised by Papanastasiou 1987, J. Rheol. 31, 385; n = 1 is Bingham's
//
// K gamma^(n-1) is unbounded (n < 1, at rest; n > 1, at high rates) or vanishes: every law is held between a least
// and a largest viscosity. For all of them eta gamma grows with gamma, so that a step has one solution.

namespace monolith {

class ViscosityLaw {
 public:
  static ViscosityLaw newtonian(double viscosity);
  // K in Pa s^n; limits in Pa s, 0 < least <= most.
  static ViscosityLaw powerLaw(double consistency, double index, double least, double most);
  // eta_0 and eta_inf in Pa s, lambda in s.
  static ViscosityLaw carreauYasuda(double zero_shear, double infinite_shear, double time_constant, double index,
                                    double transition);
  // tau_0 in Pa, m (`regularisation`) in s: unyielded liquid creeps as if it had the viscosity m tau_0.
  static ViscosityLaw herschelBulkley(double yield_stress, double consistency, double index, double regularisation,
                                      double least, double most);

  double viscosity(double rate) const;
  bool constant() const { return kind_ == Kind::kNewtonian; }
  double least() const { return least_; }
  double most() const { return most_; }
  // The most that the stress grows with the rate: d ln(eta gamma)/d ln gamma is at most this.
  double steepest() const { return index_ > 1.0 ? index_ : 1.0; }

 private:
  enum class Kind { kNewtonian, kPower, kCarreau };
  ViscosityLaw() = default;

  Kind kind_ = Kind::kNewtonian;
  double consistency_ = 0.0;    // K; eta_0 - eta_inf
  double plateau_ = 0.0;        // eta_inf
  double index_ = 1.0;          // n
  double time_constant_ = 0.0;  // lambda; m
  double transition_ = 2.0;     // a
  double yield_stress_ = 0.0;
  double least_ = 0.0;
  double most_ = 0.0;
};

}  // namespace monolith
