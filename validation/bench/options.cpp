#include "options.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

#include "framework/runner.h"

namespace monolith::bench {
namespace {

[[noreturn]] void reject(const std::string& option, const std::string& value, const std::string& expected) {
  throw std::invalid_argument(option + " '" + value + "': expected " + expected);
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

double number(const std::string& option, const std::string& text, double least, double most,
              const std::string& expected) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool good = !text.empty() && *end == '\0' && std::isfinite(value) && value >= least && value <= most;
  if (!good) reject(option, text, expected);
  return value;
}

int integer(const std::string& option, const std::string& text, int least, int most, const std::string& expected) {
  const double value = number(option, text, least, most, expected);
  if (value != std::floor(value)) reject(option, text, expected);
  return static_cast<int>(value);
}

std::vector<int> integers(const std::string& option, const std::string& text, int least, int most) {
  std::vector<int> out;
  const std::string expected =
      "whole numbers from " + std::to_string(least) + " to " + std::to_string(most) + ", separated by commas";
  for (const std::string& part : split(text)) out.push_back(integer(option, part, least, most, expected));
  return out;
}

SolverName solver(const std::string& option, const std::string& text) {
  for (const SolverName name : {SolverName::kFast, SolverName::kDirect, SolverName::kReference}) {
    if (text == toString(name)) return name;
  }
  reject(option, text, "fast, direct or reference");
}

}  // namespace

const char* usage() {
  return R"(usage: bench [--sizes N,...] [--threads T,...] [--viscous-number X,...] [--bodies B,...] [--contacts C,...]
             [--solver NAME,...] [--against NAME] [--fill PART] [--error E] [--tolerance R]
             [--repetitions K] [--json FILE]

Times whole steps of a cubic tank for every combination of the lists and prints a table.

  --sizes            cells along each edge of the tank            (default 16,32,48,64)
  --threads          threads                                      (default 1,2, as far as there are cores)
  --viscous-number   nu dt/h^2                                    (default 1,100)
  --bodies           free spheres in the liquid; one alone is a quarter of the tank wide        (default 1)
  --contacts         contact points, of further boxes and spheres that rest on the floor and each other (default 0);
                     with them the same bodies a cell apart are timed, too
  --solver           fast, direct, reference                      (default fast)
  --against          also the ratio of the times of one solve, from rest, to that of this solver at equal true error
  --fill             part of the tank's height that is liquid; 1: full and closed               (default 1)
  --error            of the bodies' accelerations, against a solve to 1e-10; each solver is given the loosest
                     tolerance that reaches it                    (default 1e-4)
  --tolerance        that tolerance, rather than looked for
  --repetitions      steps that are timed; the median counts      (default 5)
  --json             one line of JSON for each combination, to FILE; - is standard output
)";
}

Options parse(int argc, char** argv) {
  Options options;
  const int cores = omp_get_num_procs();
  options.threads.erase(
      std::remove_if(options.threads.begin(), options.threads.end(), [&](int t) { return t > cores; }),
      options.threads.end());
  for (int i = 1; i < argc; ++i) {
    std::string name = argv[i];
    if (name == "-h" || name == "--help") {
      options.help = true;
      return options;
    }
    std::string value;
    const auto equals = name.find('=');
    bool given = equals != std::string::npos;
    if (given) {
      value = name.substr(equals + 1);
      name.resize(equals);
    }
    static const std::vector<std::string> kNames = {"--sizes",    "--threads",   "--viscous-number", "--bodies",
                                                    "--contacts", "--solver",    "--against",        "--fill",
                                                    "--error",    "--tolerance", "--repetitions",    "--json"};
    if (std::find(kNames.begin(), kNames.end(), name) == kNames.end()) {
      throw std::invalid_argument("unknown option '" + name + "': expected one of those that --help lists");
    }
    if (!given) {
      if (++i >= argc) throw std::invalid_argument(name + ": expected a value after it");
      value = argv[i];
    }
    if (name == "--sizes") options.sizes = integers(name, value, 8, 512);
    if (name == "--threads") options.threads = integers(name, value, 1, 1024);
    if (name == "--bodies") options.bodies = integers(name, value, 0, 1000);
    if (name == "--contacts") options.contacts = integers(name, value, 0, 1000);
    if (name == "--repetitions") options.repetitions = integer(name, value, 1, 100000, "a whole number from 1 on");
    if (name == "--fill") options.fill = number(name, value, 0.1, 1.0, "a number from 0.1 to 1");
    if (name == "--error") options.error = number(name, value, 1e-8, 0.5, "a number from 1e-8 to 0.5");
    if (name == "--tolerance") options.tolerance = number(name, value, 1e-12, 0.5, "a number from 1e-12 to 0.5");
    if (name == "--viscous-number") {
      options.viscous_numbers.clear();
      for (const std::string& part : split(value)) {
        options.viscous_numbers.push_back(number(name, part, 0.0, 1e9, "numbers from 0 to 1e9, separated by commas"));
      }
    }
    if (name == "--solver") {
      options.solvers.clear();
      for (const std::string& part : split(value)) options.solvers.push_back(solver(name, part));
    }
    if (name == "--against") {
      options.compare = true;
      options.against = solver(name, value);
    }
    if (name == "--json") {
      if (value.empty()) reject(name, value, "the name of a file, or -");
      options.json = value;
    }
  }
  return options;
}

}  // namespace monolith::bench
