#pragma once
// The command line of the validation.

#include <stdexcept>
#include <string>
#include <vector>

#include "framework/runner.h"

namespace monolith {

// A command line that makes no sense; what() says what was expected.
class WrongCommand : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ValidationOptions {
  std::vector<std::string> cases;  // empty: all
  bool list = false;
  bool help = false;
  Extent extent = Extent::kFull;
  std::string json;  // file; empty: none
  Overrides overrides;
};

extern const char* const kValidationUsage;

// Throws WrongCommand.
ValidationOptions parseValidationOptions(const std::vector<std::string>& arguments);

}  // namespace monolith
