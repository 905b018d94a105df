#include <cstdio>
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
      {"hard", runHard},
  };
  const std::string first = argc < 2 ? "--help" : argv[1];
  if (first == "--help" || first == "-h") {
    std::printf("usage: cases [CASE ...]\ncases:");
    for (const auto& entry : cases) std::printf(" %s", entry.first.c_str());
    std::printf("\n");
    return 0;
  }
  bool met = true;
  for (int i = 1; i < argc; ++i) {
    const auto found = cases.find(argv[i]);
    if (found == cases.end()) {
      std::fprintf(stderr, "unknown case '%s'; without a name they are listed\n", argv[i]);
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
