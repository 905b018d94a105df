// Standing waves of small height: between walls, held against the linear problem (standing_mode.h); and on deep
// periodic liquid of any viscosity (Prosperetti 1981, Phys. Fluids 24, 1217).

#include <cmath>
#include <complex>

#include "framework/meter.h"
#include "framework/scene_parts.h"
#include "physics/standing_mode.h"

namespace monolith {
namespace {

constexpr double kGravity = 9.81;
constexpr double kLength = 1.0;  // m, of the tank
const char* const kDamping = "damping, 1/s";
const char* const kLargestError = "largest error of the height within 0.8 s, of the start's";

// Liquid `depth` deep with the surface depth + height cos(k x), as a box for each column of cells; thin and periodic
// along y.
Scene waveScene(double depth, double waves, double height, double viscosity, TimeStepping scheme,
                const Numerics& numerics) {
  const int cells = static_cast<int>(std::lround(numerics.cells_across));
  const double h = kLength / cells;
  const double k = 2.0 * M_PI * waves / kLength;
  Scene scene;
  scene.source = "wave";
  scene.tank.cell_width = h;
  scene.tank.origin.setZero();
  scene.tank.size = {kLength, 4.0 * h, h * std::ceil((depth + 4.0 * height) / h + 3.0)};
  scene.tank.periodic[1] = true;
  scene.tank.periodic[0] = waves == 1.0;
  scene.liquid.dynamic_viscosity = viscosity * scene.liquid.density;
  for (int i = 0; i < cells; ++i) {
    const double low = i * h, high = low + h;
    const double top = depth + height * (std::sin(k * high) - std::sin(k * low)) / (k * h);
    scene.liquid.boxes.emplace_back(Eigen::Vector3d(low, 0.0, 0.0), Eigen::Vector3d(high, 4.0 * h, top));
  }
  apply(numerics, scene);
  scene.solver.time_stepping = scheme;
  return scene;
}

// Least squares of mean + a cos(k x).
double amplitude(const Simulation& simulation, double k) {
  double n = 0.0, f = 0.0, ff = 0.0, z = 0.0, fz = 0.0;
  for (const SurfacePoint& p : simulation.surfacePoints()) {
    const double shape = std::cos(k * p.position[0]);
    n += 1.0;
    f += shape;
    ff += shape * shape;
    z += p.position[2];
    fz += shape * p.position[2];
  }
  return (fz * n - f * z) / (ff * n - f * f);
}

// Frequency from the passages through zero, damping from the extrema of a parabola through three samples.
std::vector<Measurement> slosh(double viscosity, TimeStepping scheme, const Numerics& numerics, Meter& meter) {
  constexpr double kDepth = 0.5, kPeriods = 4.0;
  const double k = M_PI / kLength;
  const StandingTank tank{kLength, kDepth, kGravity, viscosity};
  const std::complex<double> rate =
      viscosity > 0.0 ? standingRate(tank) : std::complex<double>(0.0, inviscidFrequency(tank));
  meter.restart();
  Simulation simulation(waveScene(kDepth, 0.5, 0.005, viscosity, scheme, numerics));
  double before = amplitude(simulation, k), last = before, first_zero = 0.0, last_zero = 0.0;
  int zeros = 0;
  std::vector<std::pair<double, double>> extrema;  // s, log of the height
  meter.advance(simulation, kPeriods * 2.0 * M_PI / inviscidFrequency(tank), [&](const StepReport& r) {
    const double now = amplitude(simulation, k), dt = meter.dt();
    if (now * last < 0.0) {
      last_zero = r.time - dt * now / (now - last);
      if (zeros++ == 0) first_zero = last_zero;
    }
    if (r.step > 1 && (last - before) * (now - last) < 0.0) {
      const double slope = 0.5 * (now - before), bend = now - 2.0 * last + before;
      extrema.emplace_back(r.time - dt - dt * slope / bend, std::log(std::abs(last - 0.5 * slope * slope / bend)));
    }
    before = last;
    last = now;
  });
  double t = 0.0, y = 0.0, tt = 0.0, ty = 0.0;
  const auto n = static_cast<double>(extrema.size());
  for (const auto& [time, height] : extrema) {
    t += time;
    y += height;
    tt += time * time;
    ty += time * height;
  }
  std::vector<Measurement> out = {
      {"frequency, rad/s", M_PI * (zeros - 1) / (last_zero - first_zero), rate.imag(), 0.01}};
  if (viscosity == 0.0) return out;
  // The layers on the walls, sqrt(2 nu/omega) thick, must not be thinner than half a cell.
  const bool resolved = std::sqrt(2.0 * viscosity / rate.imag()) > 0.5 * kLength / numerics.cells_across;
  out.push_back({kDamping, -(n * ty - t * y) / (n * tt - t * t), -rate.real(), resolved ? 0.1 : 0.0});
  return out;
}

// w(z) = e^(z^2) erfc(z) by its continued fraction where |z| is large, by erf's series elsewhere; Re z > -2.
std::complex<double> scaledErfc(std::complex<double> z) {
  if (z.real() < 0.0) return 2.0 * std::exp(z * z) - scaledErfc(-z);
  if (std::abs(z) > 4.0) {
    std::complex<double> fraction = z;
    for (int i = 60; i > 0; --i) fraction = z + 0.5 * i / fraction;
    return 1.0 / (std::sqrt(M_PI) * fraction);
  }
  std::complex<double> term = z, sum = z;
  for (int i = 1; i < 120; ++i) {
    term *= -z * z / static_cast<double>(i);
    sum += term / (2.0 * i + 1.0);
  }
  return std::exp(z * z) * (1.0 - 2.0 / std::sqrt(M_PI) * sum);
}

// a(t)/a(0). The sum's terms e^((z^2 - q) t) erfc(z sqrt t) = e^(-q t) w(z sqrt t).
double prosperetti(double q, double omega, double t) {
  std::vector<std::complex<double>> roots = {{1.0, 0.0}, {0.4, 0.9}, {-0.65, 0.72}, {-0.9, -0.3}};
  for (auto& z : roots) z *= std::sqrt(omega);
  for (int it = 0; it < 500; ++it) {  // Durand & Kerner
    for (std::size_t i = 0; i < 4; ++i) {
      const auto z = roots[i];
      std::complex<double> value = z * z * z * z + 2.0 * q * z * z + 4.0 * std::pow(q, 1.5) * z + q * q + omega * omega;
      for (std::size_t j = 0; j < 4; ++j) {
        if (j != i) value /= z - roots[j];
      }
      roots[i] -= value;
    }
  }
  std::complex<double> sum = 4.0 * q * q / (8.0 * q * q + omega * omega) * std::erfc(std::sqrt(q * t));
  for (std::size_t i = 0; i < 4; ++i) {
    const auto z = roots[i];
    std::complex<double> product = 1.0;
    for (std::size_t j = 0; j < 4; ++j) {
      if (j != i) product *= roots[j] - z;
    }
    sum += z / product * omega * omega / (z * z - q) * std::exp(-q * t) * scaledErfc(z * std::sqrt(t));
  }
  return sum.real();
}

std::vector<Measurement> deepWave(double viscosity, TimeStepping scheme, const Numerics& numerics, Meter& meter) {
  const double k = 2.0 * M_PI / kLength;
  Simulation simulation(waveScene(1.0, 1.0, 0.005, viscosity, scheme, numerics));
  const double start = amplitude(simulation, k);
  double worst = 0.0;
  meter.advance(simulation, 0.8, [&](const StepReport& r) {
    const double exact = prosperetti(viscosity * k * k, std::sqrt(kGravity * k), r.time);
    worst = std::max(worst, std::abs(amplitude(simulation, k) / start - exact));
  });
  return {{kLargestError, worst, 0.0, scheme == TimeStepping::kBdf2 ? 0.02 : 0.0, 1.0}};
}

// Without viscosity, for which it should keep its height. `level`: of the surface at rest above the centres of a layer
// of cells; height: of the wave; both in cells.
std::vector<Measurement> shortWave(double level, double height, const Numerics& numerics, Meter& meter) {
  constexpr double kPeriods = 20.0, kLast = 5.0, kLayer = 0.7;
  const double h = kLength / numerics.cells_across, k = 2.0 * M_PI / kLength;
  const double depth = h * (std::floor(kLayer / h) + 0.5 + level), period = 2.0 * M_PI / std::sqrt(kGravity * k);
  Simulation simulation(waveScene(depth, 1.0, height * h, 0.0, TimeStepping::kBdf2, numerics));
  const double start = amplitude(simulation, k);
  double largest = 0.0;
  meter.advance(simulation, kPeriods * period, [&](const StepReport& r) {
    if (r.time > (kPeriods - kLast) * period) largest = std::max(largest, std::abs(amplitude(simulation, k)));
  });
  return {{"height after 20 periods, of the start's", largest / start, 1.0}};
}

using Wave = std::vector<Measurement> (*)(double, TimeStepping, const Numerics&, Meter&);

// A run of the quick subset that misses its goal, and by how much it may.
struct Missed {
  double cells_across, error;
};

std::vector<Variant> variants(Wave wave, const std::vector<double>& viscosities, double quick_cells,
                              const std::vector<Missed>& missed, const char* quantity, Extent extent) {
  const bool full = extent == Extent::kFull;
  std::vector<Variant> out;
  for (const double viscosity : viscosities) {
    for (const TimeStepping scheme : {TimeStepping::kBdf2, TimeStepping::kBackwardEuler}) {
      if (!full && (viscosity != 0.001 || scheme != TimeStepping::kBdf2)) continue;
      Sweep sweep;
      sweep.base.cells_across = full ? 32.0 : quick_cells;
      sweep.base.dt = 0.02;
      if (full) {
        sweep.cells = {16, 32, 64};
        if (wave == slosh && viscosity > 0.0) sweep.cells.push_back(128);
        sweep.steps = {0.04, 0.01, 0.005};
      }
      char name[64];
      std::snprintf(name, sizeof name, "viscosity %g m^2/s, %s", viscosity,
                    scheme == TimeStepping::kBdf2 ? "bdf2" : "backward Euler");
      const RunFunction run = [wave, viscosity, scheme](const Numerics& numerics, Meter& meter) {
        return wave(viscosity, scheme, numerics, meter);
      };
      addSweep(name, sweep, run, out);
      if (full) continue;
      for (const Missed& m : missed) {
        sweep.cells = {m.cells_across};
        addSweep(name, sweep, atMost(m.error, quantity, run), out);
      }
    }
  }
  return out;
}

}  // namespace

Case sloshing() {
  Case c;
  c.name = "sloshing";
  c.title = "frequency and damping of the first mode of a tank, depth half its length";
  c.reference = "eigenvalue of the linear problem, no slip at walls";
  c.across = "length of the tank";
  c.variants = [](Extent extent) {
    return variants(slosh, {0.0, 0.0001, 0.001}, 64.0, {{32.0, 0.21}}, kDamping, extent);
  };
  return c;
}

Case viscousWave() {
  Case c;
  c.name = "wave";
  c.title = "a standing wave on deep viscous liquid";
  c.reference = "Prosperetti 1981, exact for small heights";
  c.across = "wavelength";
  c.variants = [](Extent extent) {
    return variants(deepWave, {0.001, 0.01}, 64.0, {{16.0, 0.051}, {32.0, 0.0125}}, kLargestError, extent);
  };
  return c;
}

Case shortWaves() {
  Case c;
  c.name = "ripples";
  c.title =
      "standing waves of a dozen cells and more without viscosity, the surface at several places in its layer of cells";
  c.reference = "they keep their height";
  c.across = "wavelength";
  c.variants = [](Extent extent) {
    std::vector<Variant> out;
    if (extent != Extent::kFull) return out;
    for (const double height : {0.2, 0.5, 1.0}) {
      for (const double level : {-0.4, -0.1, 0.1, 0.3}) {
        Sweep sweep;
        sweep.base.cells_across = 12.0;
        sweep.base.dt = 1.0 / 30.0;
        sweep.cells = {12, 24};
        sweep.steps = {1.0 / 120.0};
        sweep.fractions = true;
        char name[64];
        std::snprintf(name, sizeof name, "height %g cells, level %g cells", height, level);
        addSweep(
            name, sweep, [=](const Numerics& n, Meter& meter) { return shortWave(level, height, n, meter); }, out);
      }
    }
    return out;
  };
  return c;
}

}  // namespace monolith
