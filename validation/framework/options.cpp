#include "framework/options.h"

#include <cmath>
#include <cstdlib>

namespace monolith {

const char* const kValidationUsage =
    "usage: validate [CASE ...] [--list] [--quick] [--json FILE] [--resolution N] [--dt S] [--tolerance T]\n"
    "                [--solver fast|direct|reference] [--discretisation fitted|fractions]\n";

namespace {

double positive(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value <= 0.0) {
    throw WrongCommand(option + " '" + text + "': expected a number > 0");
  }
  return value;
}

SolverName solverName(const std::string& text) {
  for (const SolverName name : {SolverName::kFast, SolverName::kDirect, SolverName::kReference}) {
    if (text == toString(name)) return name;
  }
  throw WrongCommand("--solver '" + text + "': expected fast, direct or reference");
}

Discretisation discretisationName(const std::string& text) {
  for (const Discretisation name : {Discretisation::kFitted, Discretisation::kFractions}) {
    if (text == toString(name)) return name;
  }
  throw WrongCommand("--discretisation '" + text + "': expected fitted or fractions");
}

}  // namespace

ValidationOptions parseValidationOptions(const std::vector<std::string>& arguments) {
  ValidationOptions out;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    std::string option = arguments[i];
    if (option.rfind("-", 0) != 0) {
      out.cases.push_back(option);
      continue;
    }
    if (option == "--list") {
      out.list = true;
    } else if (option == "--quick") {
      out.extent = Extent::kQuick;
    } else if (option == "--help" || option == "-h") {
      out.help = true;
    } else {
      std::string value;
      const std::size_t equals = option.find('=');
      if (equals != std::string::npos) {
        value = option.substr(equals + 1);
        option.resize(equals);
      }
      const bool known = option == "--json" || option == "--resolution" || option == "--dt" ||
                         option == "--tolerance" || option == "--solver" || option == "--discretisation";
      if (!known) throw WrongCommand("unknown option " + option);
      if (equals == std::string::npos) {
        if (i + 1 == arguments.size()) throw WrongCommand(option + " needs a value");
        value = arguments[++i];
      }
      if (option == "--json") out.json = value;
      if (option == "--resolution") out.overrides.cells_across = positive(option, value);
      if (option == "--dt") out.overrides.dt = positive(option, value);
      if (option == "--tolerance") out.overrides.tolerance = positive(option, value);
      if (option == "--solver") out.overrides.solver = solverName(value);
      if (option == "--discretisation") out.overrides.discretisation = discretisationName(value);
    }
  }
  return out;
}

}  // namespace monolith
