// Time, iterations and memory of a step against size, threads, viscosity, bodies and contacts.

#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <tuple>

#include "options.h"
#include "report.h"

namespace monolith::bench {
namespace {

Row measure(const Case& wanted, const Options& options, double stream) {
  Row row;
  row.wanted = wanted;
  row.accuracy = inChild<Accuracy>([&] { return measureAccuracy(wanted, options.error, options.tolerance); });
  if (!row.accuracy.good) return row;
  row.steps = inChild<StepFigures>([&] { return measureSteps(wanted, row.accuracy.tolerance, options.repetitions); });
  if (!row.steps.good) return row;
  row.bandwidth = row.steps.streamed / (1e-3 * row.steps.solve_ms);
  row.bandwidth_share = row.bandwidth / stream;
  if (wanted.contacts > 0) {
    Case apart = wanted;
    apart.apart = true;
    const auto steps =
        inChild<StepFigures>([&] { return measureSteps(apart, row.accuracy.tolerance, options.repetitions); });
    if (steps.good && steps.contacts == 0) row.contact_factor = row.steps.ms_per_step / steps.ms_per_step;
  }
  if (!options.compare) return row;
  Case other = wanted;
  other.solver = options.against;
  const auto against = inChild<Accuracy>([&] { return measureAccuracy(other, options.error, 0.0); });
  row.against = toString(options.against);
  if (!against.good) {
    std::fprintf(stderr, "bench: %s at %d^3: %s\n", row.against.c_str(), wanted.size, against.message);
    return row;
  }
  row.against_ms = against.solve_ms;
  row.against_error = against.error;
  row.against_tolerance = against.tolerance;
  row.speedup = against.solve_ms / row.accuracy.solve_ms;
  return row;
}

std::vector<Case> combinations(const Options& options) {
  std::vector<Case> cases;
  for (const SolverName solver : options.solvers) {
    for (const double number : options.viscous_numbers) {
      for (const int contacts : options.contacts) {
        for (const int bodies : options.bodies) {
          for (const int size : options.sizes) {
            for (const int threads : options.threads) {
              cases.push_back({size, threads, number, bodies, contacts, options.fill, solver});
            }
          }
        }
      }
    }
  }
  return cases;
}

int run(const Options& options) {
  std::ofstream file;
  if (!options.json.empty() && options.json != "-") {
    file.open(options.json);
    if (!file) throw std::invalid_argument("--json '" + options.json + "': expected a file that can be written");
  }
  const bool json_to_output = options.json == "-";
  std::FILE* table = json_to_output ? stderr : stdout;
  const Origin origin = findOrigin();
  std::map<int, double> stream;
  for (const int threads : options.threads) {
    stream[threads] = inChild<double>([&] { return streamBandwidth(threads); });
    std::fprintf(table, "%s, commit %s: %.1f GB/s with %d thread%s\n", origin.machine.c_str(), origin.commit.c_str(),
                 1e-9 * stream[threads], threads, threads == 1 ? "" : "s");
  }
  printHead(table);
  using Key = std::tuple<int, double, int, int, int>;
  std::map<Key, double> first_time, first_iterations;
  bool good = true;
  for (const Case& wanted : combinations(options)) {
    Row row = measure(wanted, options, stream[wanted.threads]);
    const int solver = static_cast<int>(wanted.solver);
    if (row.steps.good) {
      const auto time = first_time.insert(
          {{solver, wanted.viscous_number, wanted.contacts, wanted.bodies, wanted.size}, row.steps.ms_per_step});
      const auto iterations = first_iterations.insert(
          {{solver, wanted.viscous_number, wanted.contacts, wanted.bodies, wanted.threads}, row.steps.iterations});
      row.thread_speedup = time.first->second / row.steps.ms_per_step;
      row.iteration_growth = iterations.first->second > 0.0 ? row.steps.iterations / iterations.first->second : 1.0;
    }
    good = good && row.steps.good;
    printRow(row, table);
    std::fflush(table);
    const std::string line = toJson(row, origin) + "\n";
    if (json_to_output) std::cout << line << std::flush;
    if (file.is_open()) file << line << std::flush;
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace monolith::bench

int main(int argc, char** argv) {
  try {
    const monolith::bench::Options options = monolith::bench::parse(argc, argv);
    if (options.help) {
      std::cout << monolith::bench::usage();
      return 0;
    }
    return monolith::bench::run(options);
  } catch (const std::invalid_argument& error) {
    std::cerr << "bench: " << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "bench: " << error.what() << "\n";
    return 1;
  }
}
