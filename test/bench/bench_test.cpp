// The benchmark program itself: on a small tank, as its users call it.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#ifndef MONOLITH_BENCH
#error "MONOLITH_BENCH is not defined"
#endif

namespace {

struct Result {
  int code = -1;
  std::string output;  // both streams
};

Result run(const std::string& arguments) {
  Result result;
  std::FILE* program = popen((std::string(MONOLITH_BENCH) + " " + arguments + " 2>&1").c_str(), "r");
  if (program == nullptr) return result;
  char text[1000];
  while (std::fgets(text, sizeof(text), program) != nullptr) result.output += text;
  result.code = WEXITSTATUS(pclose(program));
  return result;
}

TEST(Bench, WritesALineOfJsonWithEveryKey) {
  const std::string file = testing::TempDir() + "bench.json";
  const Result result =
      run("--sizes 8,12 --threads 1 --viscous-number 1 --contacts 1 --repetitions 1 --against direct --json " + file);
  ASSERT_EQ(result.code, 0) << result.output;
  std::ifstream lines(file);
  std::string line;
  int count = 0;
  while (std::getline(lines, line)) {
    ++count;
    for (const std::string key :
         {"size",        "threads",    "viscous_number", "bodies",         "contacts",        "solver",
          "ms_per_step", "iterations", "liquid_solves",  "bytes_per_cell", "stage_ms",        "advection",
          "contact",     "geometry",   "solve",          "surface",        "bandwidth_share", "speedup",
          "cpu_ms",      "commit",     "machine",        "true_error",     "iteration_growth",
          "contact_factor", "flops_per_cell", "streamed_bytes_per_cell"}) {
      EXPECT_NE(line.find("\"" + key + "\": "), std::string::npos) << key << " in " << line;
    }
    EXPECT_NE(line.find("\"good\": true"), std::string::npos) << line;
    EXPECT_NE(line.find("\"contacts\": 1,"), std::string::npos) << line;
    EXPECT_NE(line.find("\"bodies\": 2,"), std::string::npos) << line;
    EXPECT_EQ(line.find("\"speedup\": null"), std::string::npos) << line;
    EXPECT_EQ(line.find("\"contact_factor\": null"), std::string::npos) << line;
  }
  EXPECT_EQ(count, 2);
  std::remove(file.c_str());
}

double valueOf(const std::string& key, const std::string& line) {
  const auto at = line.find("\"" + key + "\": ");
  return at == std::string::npos ? NAN : std::atof(line.c_str() + at + key.size() + 4);
}

// What a step costs, counted, not timed: a change that makes it a tenth more expensive has to say so here. The figures
// are those of the commit that last changed them, for spheres in a full tank.
TEST(Bench, AStepTakesNoMoreWorkThanItDid) {
  const struct {
    const char* scene;
    double flops, bytes, iterations, memory;  // flops and streamed bytes a step and cell
  } budgets[] = {{"--viscous-number 1", 5900.0, 5900.0, 5.6, 1020.0},
                 {"--viscous-number 100", 12200.0, 11300.0, 8.6, 1200.0},
                 {"--viscous-number 100 --bodies 26 --tolerance 1e-5", 25300.0, 25300.0, 18.6, 2060.0}};
  constexpr double kMore = 1.1;
  const std::string file = testing::TempDir() + "work.json";
  for (const auto& budget : budgets) {
    const Result result = run("--sizes 32 --threads 1 " + std::string(budget.scene) + " --json " + file);
    ASSERT_EQ(result.code, 0) << result.output;
    std::ifstream lines(file);
    std::string line;
    ASSERT_TRUE(std::getline(lines, line));
    EXPECT_LT(valueOf("flops_per_cell", line), kMore * budget.flops) << line;
    EXPECT_LT(valueOf("streamed_bytes_per_cell", line), kMore * budget.bytes) << line;
    EXPECT_LT(valueOf("iterations", line), kMore * budget.iterations) << line;
    EXPECT_LT(valueOf("bytes_per_cell", line), kMore * budget.memory) << line;
  }
  std::remove(file.c_str());
}

TEST(Bench, SaysWhichOptionIsWrongAndWhatItExpects) {
  const struct {
    const char* arguments;
    const char* says;
  } wrong[] = {
      {"--sizes 16,4", "--sizes '4': expected whole numbers from 8"},
      {"--threads two", "--threads 'two': expected whole numbers from 1"},
      {"--viscous-number -1", "--viscous-number '-1': expected numbers from 0"},
      {"--against slow", "--against 'slow': expected fast, direct or reference"},
      {"--json", "--json: expected a value"},
      {"--quick 1", "unknown option '--quick'"},
  };
  for (const auto& [arguments, says] : wrong) {
    const Result result = run(arguments);
    EXPECT_EQ(result.code, 2) << arguments;
    EXPECT_NE(result.output.find(says), std::string::npos) << result.output;
  }
  EXPECT_EQ(run("--help").code, 0);
}

}  // namespace
