#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include "cases.h"

int main(int argc, char** argv) {
  using namespace monolith;
  const std::map<std::string, std::function<bool()>> cases = {
      {"solvers", runSolvers},
      {"blocks", runBlocks},
      {"pace", runPace},
  };
  if (argc < 2) {
    std::printf("usage: monolith_cases CASE...\ncases:");
    for (const auto& entry : cases) std::printf(" %s", entry.first.c_str());
    std::printf("\n");
    return 2;
  }
  bool met = true;
  for (int i = 1; i < argc; ++i) {
    const auto found = cases.find(argv[i]);
    if (found == cases.end()) {
      std::fprintf(stderr, "unknown case '%s'; call without arguments for a list\n", argv[i]);
      return 2;
    }
    try {
      met = found->second() && met;
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", argv[i], error.what());
      return 1;
    }
  }
  return met ? 0 : 1;
}
