#include "coupling/variable_viscosity.h"

#include <cmath>

#include "coupling/step_solver.h"
#include "solve/staggered_transfer.h"

namespace monolith {
namespace {

// Sums over octants that add to edges on both sides of a slab of cells: even slabs first, then odd ones.
template <class Function>
void forEachCellInTurns(const Lattice& l, Function&& f) {
  for (int parity = 0; parity < 2; ++parity) {
#pragma omp parallel for schedule(static)
    for (int k = parity; k < l.n[2]; k += 2) {
      for (int j = 0; j < l.n[1]; ++j) {
        const auto row = l.index(0, j, k);
        for (auto c = row; c < row + l.n[0]; ++c) f(c);
      }
    }
  }
}

// Adds what was summed beyond the end of periodic axes to where it belongs.
void foldHalo(const Lattice& l, std::vector<double>& field) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!l.periodic[axis]) continue;
    const int b = (axis + 1) % 3;
    const int c = (axis + 2) % 3;
    for (int q = 0; q <= l.n[c]; ++q) {
      for (int p = 0; p <= l.n[b]; ++p) {
        const auto first = l.index(0, 0, 0) + p * l.stride[b] + q * l.stride[c];
        field[first] += field[first + l.n[axis] * l.stride[axis]];
        field[first + l.n[axis] * l.stride[axis]] = 0.0;
      }
    }
  }
}

void scaleRows(const std::vector<BodyRow>& base, const double* log_ratio, std::vector<BodyRow>& out) {
  out = base;
  for (BodyRow& row : out) row.coefficient *= std::exp(0.5 * log_ratio[row.sample]);
}

// Gives cells without a value the mean of their neighbours that have one.
void extendOnce(const Lattice& l, std::vector<double>& value, std::vector<double>& has) {
  extendIntoHalo(l, value);
  extendIntoHalo(l, has);
  const std::vector<double> before = has;
  const std::vector<double> old = value;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        if (before[c] > 0.0) continue;
        double sum = 0.0, count = 0.0;
        for (int a = 0; a < 3; ++a) {
          for (const auto n : {c - l.stride[a], c + l.stride[a]}) {
            if (!(before[n] > 0.0)) continue;
            sum += old[n];
            count += 1.0;
          }
        }
        if (count == 0.0) continue;
        value[c] = sum / count;
        has[c] = 1.0;
      }
    }
  }
}

}  // namespace

void VariableViscosity::start(const StepProblem& problem, double reference) {
  reference_ = reference;
  scales_ = problem.strain;
  normal_ = problem.coefficients.normal;
  drag_ = problem.coefficients.drag;
  shear_ = problem.coefficients.shear;
  shear_rows_ = problem.rows.shear;
  coarse_ = problem.coarse.levels;
  applied_.assign(7 * problem.grid.lattice.size, 0.0);
}

bool VariableViscosity::counts(std::ptrdiff_t cell) const {
  return scales_.normal[0][cell] > 0.0 || scales_.normal[1][cell] > 0.0 || scales_.normal[2][cell] > 0.0;
}

void VariableViscosity::evaluate(const StepProblem& problem, const ViscosityLaw& law, StepVector& x,
                                 ViscosityField& out) const {
  const Lattice& l = problem.grid.lattice;
  out.log_ratio.assign(7 * l.size, 0.0);
  out.weight.assign(7 * l.size, 0.0);
  for (auto& field : x.velocity) fillHalo(l, field);
  StressSamples<double> stress;
  computeStress(problem.coefficients, problem.rows, x, stress);
  Edges edges;
  measureEdges(problem.grid, stress.shear, edges, out);
  evaluateCells(problem, law, stress.normal, edges, out);
  out.mean_log = meanOfCells(l, out.log_ratio);
  evaluateEdges(l, law, edges, out);
  evaluateFilms(problem, law, x, out);
}

void VariableViscosity::measureEdges(const MacGrid& grid, const FaceField<double>& stress, Edges& edges,
                                     ViscosityField& out) const {
  const Lattice& l = grid.lattice;
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  const double per_h = 1.0 / grid.h;
  for (int p = 0; p < 3; ++p) {
    std::vector<double>& edge = edges.rate[p];
    edge.resize(l.size);
    const double* log_ratio = applied_.data() + (1 + p) * size;
    double* weight = out.weight.data() + (1 + p) * size;
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto e = row; e < row + l.faceEnd(0); ++e) {
        const double scale = scales_.shear[p][e];
        if (!(scale > 0.0)) continue;
        const double root = std::exp(0.5 * log_ratio[e]);
        const double rate = per_h * scale * stress[p][e] / root;
        edge[e] = rate * rate;
        weight[e] = std::pow(stress[p][e] * root / scale, 2);
      }
    });
    fillHalo(l, edge);
  }
}

void VariableViscosity::evaluateCells(const StepProblem& problem, const ViscosityLaw& law,
                                      const FaceField<double>& stress, Edges& edges, ViscosityField& out) const {
  const StaggeredCoefficients<double>& c = problem.coefficients;
  const Lattice& l = problem.grid.lattice;
  const double per_h = 1.0 / problem.grid.h;
  const FaceField<double>& edge = edges.rate;
  FaceField<double>&sum = edges.sum, &count = edges.count;
  for (int p = 0; p < 3; ++p) {
    sum[p].assign(l.size, 0.0);
    count[p].assign(l.size, 0.0);
  }
  forEachCellInTurns(l, [&](std::ptrdiff_t cell) {
    if (!counts(cell)) return;
    double normal = 0.0;
    for (int a = 0; a < 3; ++a) {
      if (!(scales_.normal[a][cell] > 0.0)) continue;
      const double rate = per_h * scales_.normal[a][cell] * stress[a][cell] / c.normal[a][cell];
      normal += 2.0 * rate * rate;
      out.weight[cell] += stress[a][cell] * stress[a][cell];
    }
    // The four edges of each pair; one that lies in the air or in a solid is stood in for by the others.
    double squared[3][4];
    std::ptrdiff_t at[3][4];
    for (int p = 0; p < 3; ++p) {
      const auto [a, b] = kShearPairs[p];
      double mean = 0.0;
      int valid = 0;
      for (int corner = 0; corner < 4; ++corner) {
        const auto e = at[p][corner] = cell + (corner & 1 ? l.stride[a] : 0) + (corner & 2 ? l.stride[b] : 0);
        if (!(scales_.shear[p][e] > 0.0)) continue;
        mean += edge[p][e];
        ++valid;
      }
      if (valid > 0) mean /= valid;
      for (int corner = 0; corner < 4; ++corner) {
        const auto e = at[p][corner];
        squared[p][corner] = scales_.shear[p][e] > 0.0 ? edge[p][e] : mean;
      }
    }
    double total = 0.0;
    for (int octant = 0; octant < 8; ++octant) {
      int corner[3];
      double rate = normal;
      for (int p = 0; p < 3; ++p) {
        const auto [a, b] = kShearPairs[p];
        corner[p] = (octant >> a & 1) + 2 * (octant >> b & 1);
        rate += squared[p][corner[p]];
      }
      const double eta = law.viscosity(std::sqrt(rate));
      total += eta;
      for (int p = 0; p < 3; ++p) {
        sum[p][at[p][corner[p]]] += eta;
        count[p][at[p][corner[p]]] += 1.0;
      }
    }
    out.log_ratio[cell] = std::log(0.125 * total / reference_);
  });
}

double VariableViscosity::meanOfCells(const Lattice& l, const std::vector<double>& log_ratio) const {
  double sum = 0.0, cells = 0.0;
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        if (!counts(l.index(i, j, k))) continue;
        sum += log_ratio[l.index(i, j, k)];
        cells += 1.0;
      }
    }
  }
  return cells > 0.0 ? sum / cells : 0.0;
}

void VariableViscosity::evaluateEdges(const Lattice& l, const ViscosityLaw& law, Edges& edges,
                                      ViscosityField& out) const {
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  for (int p = 0; p < 3; ++p) {
    std::vector<double>&sum = edges.sum[p], &count = edges.count[p];
    const std::vector<double>& rate = edges.rate[p];
    foldHalo(l, sum);
    foldHalo(l, count);
    double* log_ratio = out.log_ratio.data() + (1 + p) * size;
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto e = row; e < row + l.faceEnd(0); ++e) {
        if (!(scales_.shear[p][e] > 0.0)) continue;
        const double eta = count[e] > 0.0 ? sum[e] / count[e] : law.viscosity(std::sqrt(rate[e]));
        log_ratio[e] = std::log(eta / reference_);
      }
    });
  }
}

void VariableViscosity::evaluateFilms(const StepProblem& problem, const ViscosityLaw& law, const StepVector& x,
                                      ViscosityField& out) const {
  const StaggeredCoefficients<double>& c = problem.coefficients;
  const Lattice& l = problem.grid.lattice;
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  const double per_h = 1.0 / problem.grid.h;
  for (int a = 0; a < 3; ++a) {
    std::vector<double> slip = x.velocity[a];
    for (const BodyRow& row : problem.rows.drag[a]) slip[row.sample] -= row.coefficient.dot(x.bodies[row.body]);
    double* log_ratio = out.log_ratio.data() + (4 + a) * size;
    double* weight = out.weight.data() + (4 + a) * size;
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto f = row; f < row + l.faceEnd(0); ++f) {
        if (!(scales_.drag[a][f] > 0.0)) continue;
        log_ratio[f] = std::log(law.viscosity(per_h * scales_.drag[a][f] * std::abs(slip[f])) / reference_);
        weight[f] = std::pow(c.drag[a][f] * slip[f], 2);
      }
    });
  }
}

void VariableViscosity::apply(const ViscosityField& field, StepProblem& problem) {
  StaggeredCoefficients<double>& c = problem.coefficients;
  const Lattice& l = problem.grid.lattice;
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  applied_ = field.log_ratio;
  std::vector<double> ratio(applied_.size());
#pragma omp parallel for simd schedule(static)
  for (std::ptrdiff_t i = 0; i < 7 * size; ++i) ratio[i] = std::exp(applied_[i]);
  for (int a = 0; a < 3; ++a) {
    const double* edge = ratio.data() + (1 + a) * size;
    const double* film = ratio.data() + (4 + a) * size;
    c.normal[a].transform(normal_[a], [&](std::ptrdiff_t i, float k) { return static_cast<float>(k * ratio[i]); });
    c.drag[a].transform(drag_[a], [&](std::ptrdiff_t i, float k) { return static_cast<float>(k * film[i]); });
    for (int s = 0; s < 2; ++s) {
      c.shear[a][s].transform(shear_[a][s],
                              [&](std::ptrdiff_t i, float k) { return static_cast<float>(k * std::sqrt(edge[i])); });
    }
    scaleRows(shear_rows_[a], applied_.data() + (1 + a) * size, problem.rows.shear[a]);
  }
  problem.cell_viscosity.resize(l.size);
  for (std::ptrdiff_t i = 0; i < size; ++i) problem.cell_viscosity[i] = static_cast<float>(ratio[i]);
  scaleCoarse(field, problem);
}

void VariableViscosity::scaleCoarse(const ViscosityField& field, StepProblem& problem) const {
  problem.coarse.levels = coarse_;
  problem.coarse.change();
  Lattice l = problem.grid.lattice;
  std::vector<double> value(l.size, 0.0), has(l.size, 0.0);
  for (int k = 0; k < l.n[2]; ++k) {
    for (int j = 0; j < l.n[1]; ++j) {
      for (int i = 0; i < l.n[0]; ++i) {
        const auto c = l.index(i, j, k);
        has[c] = counts(c) ? 1.0 : 0.0;
        value[c] = counts(c) ? field.log_ratio[c] : 0.0;
      }
    }
  }
  for (std::size_t level = 1; level < problem.coarse.levels.size(); ++level) {
    StaggeredCoefficients<float>& c = problem.coarse.levels[level];
    const Lattice coarse = c.lattice;
    std::vector<double> to, to_has;
    restrictCells(l, value, coarse, to);
    restrictCells(l, has, coarse, to_has);
    for (std::size_t i = 0; i < coarse.size; ++i) {
      to[i] = to_has[i] > 0.0 ? to[i] / to_has[i] : 0.0;
      to_has[i] = to_has[i] > 0.0 ? 1.0 : 0.0;
    }
    l = coarse;
    value = to;
    has = to_has;
    extendOnce(l, to, to_has);
    extendIntoHalo(l, to);
    for (int a = 0; a < 3; ++a) {
      const auto first = l.stride[kShearPairs[a][0]];
      const auto second = l.stride[kShearPairs[a][1]];
      c.normal[a].transform(c.normal[a],
                            [&](std::ptrdiff_t i, float k) { return k * static_cast<float>(std::exp(to[i])); });
      c.drag[a].transform(c.drag[a], [&](std::ptrdiff_t i, float k) {
        return k * static_cast<float>(std::exp(0.5 * (to[i] + to[i - l.stride[a]])));
      });
      for (auto& field : c.shear[a]) {
        field.transform(field, [&](std::ptrdiff_t i, float k) {
          const double edge = 0.25 * (to[i] + to[i - first] + to[i - second] + to[i - first - second]);
          return k * static_cast<float>(std::exp(0.5 * edge));
        });
      }
    }
  }
}

double VariableViscosity::change(const StepProblem& problem, const ViscosityField& next, StepVector& x) const {
  const StaggeredCoefficients<double>& c = problem.coefficients;
  const Lattice& l = problem.grid.lattice;
  const auto size = static_cast<std::ptrdiff_t>(l.size);
  const auto grows = [&](int block, std::ptrdiff_t i) {
    return std::expm1(next.log_ratio[block * size + i] - applied_[block * size + i]);
  };
  for (auto& field : x.velocity) fillHalo(l, field);
  StressSamples<double> stress;
  computeStress(c, problem.rows, x, stress);
  for (int a = 0; a < 3; ++a) {
    forEachRow(l, [&](std::ptrdiff_t row, int, int) {
      for (auto i = row; i < row + l.faceEnd(0); ++i) {
        stress.normal[a][i] *= grows(0, i);
        stress.shear[a][i] *= grows(1 + a, i);
      }
    });
    fillHalo(l, stress.normal[a]);
    fillHalo(l, stress.shear[a]);
  }
  StepVector rest, force;
  rest.resize(l, x.bodies.size());
  rest.setZero();
  force = rest;
  applyMomentum(c, rest.velocity, stress, force.velocity);
  addStressToBodies(problem.rows, stress, force.bodies);
  for (int a = 0; a < 3; ++a) {
    std::vector<double> slip = x.velocity[a];
    for (const BodyRow& row : problem.rows.drag[a]) slip[row.sample] -= row.coefficient.dot(x.bodies[row.body]);
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      if (scales_.drag[a][i] > 0.0) force.velocity[a][i] += c.drag[a][i] * grows(4 + a, i) * slip[i];
    }
    for (const BodyRow& row : problem.rows.drag[a]) {
      const auto i = row.sample;
      force.bodies[row.body] -= row.coefficient * (c.drag[a][i] * grows(4 + a, i) * slip[i]);
    }
    clearHalo(l, force.velocity[a]);
  }
  for (std::size_t b = 0; b < force.bodies.size(); ++b) {
    if (problem.free_index[b] < 0) force.bodies[b].setZero();
  }
  return stepNorm(problem, force);
}

}  // namespace monolith
