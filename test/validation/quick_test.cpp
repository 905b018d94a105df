// The quick subset of ./tank validate: every goal is met, and errors fall at the order that each case states.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "framework/options.h"
#include "framework/run_record.h"
#include "framework/runner.h"

namespace monolith {

void PrintTo(const Case& c, std::ostream* out) { *out << c.title; }  // for messages of gtest

namespace {

using CaseRun = Run;  // ::testing::Test has a Run of its own

class QuickCase : public ::testing::TestWithParam<Case> {};

TEST_P(QuickCase, MeetsItsGoalsAndOrders) {
  const Case& what = GetParam();
  std::vector<CaseRun> runs;
  for (const Variant& variant : variantsOf(what, Extent::kQuick, {})) {
    runs.push_back(execute(what, variant));
    const CaseRun& run = runs.back();
    EXPECT_TRUE(run.failure.empty()) << run.variant << ": " << run.failure;
    if (!run.judged) continue;
    for (const Measurement& m : run.measurements) {
      if (m.goal == 0.0) continue;
      EXPECT_LE(std::abs(m.error()), m.goal)
          << run.variant << ", " << run.numerics.cells_across << " across: " << m.quantity << " " << m.result
          << ", expected " << m.reference;
    }
  }
  for (const ExpectedOrder& order : what.orders) {
    EXPECT_GE(observedOrder(runs, order), order.least)
        << order.variant << ": " << order.quantity << (order.in_time ? ", order in time" : ", order in space");
  }
}

std::vector<Case> quickCases() {
  std::vector<Case> out;
  for (Case& c : allCases()) {
    if (!variantsOf(c, Extent::kQuick, {}).empty()) out.push_back(std::move(c));
  }
  return out;
}

INSTANTIATE_TEST_SUITE_P(Validation, QuickCase, ::testing::ValuesIn(quickCases()),
                         [](const auto& info) { return info.param.name; });

// --- the framework ---

Case syntheticCase(double order) {
  Case c;
  c.name = "synthetic";
  c.variants = [order](Extent) {
    std::vector<Variant> out;
    Sweep sweep;
    sweep.base.cells_across = 8.0;
    sweep.base.dt = 0.1;
    sweep.cells = {4.0, 8.0, 16.0};
    sweep.steps = {0.05, 0.1};
    addSweep(
        "v", sweep,
        [order](const Numerics& n, Meter&) {
          const double result = 2.0 + std::pow(n.cells_across, -order);
          return std::vector<Measurement>{{"q", result, 2.0, 0.02}};
        },
        out);
    return out;
  };
  return c;
}

std::vector<CaseRun> runsOf(const Case& c, const Overrides& overrides = {}) {
  std::vector<CaseRun> runs;
  for (const Variant& v : variantsOf(c, Extent::kFull, overrides)) runs.push_back(execute(c, v));
  return runs;
}

TEST(Runner, SweepsVaryOneThingAtATime) {
  const std::vector<CaseRun> runs = runsOf(syntheticCase(2.0));
  ASSERT_EQ(runs.size(), 4u);  // three resolutions, and the base's with another step
  EXPECT_TRUE(runs[1].judged);
  EXPECT_FALSE(runs[3].judged);
  EXPECT_DOUBLE_EQ(runs[3].numerics.cells_across, 8.0);
  EXPECT_FALSE(runs[0].good());  // 1/32 off, goal 0.02
  EXPECT_TRUE(runs[1].good());
}

TEST(Runner, FindsTheOrder) {
  for (const double order : {1.0, 2.5}) {
    const std::vector<CaseRun> runs = runsOf(syntheticCase(order));
    EXPECT_NEAR(observedOrder(runs, {"v", "q", false, 0.0}), order, 1e-9);
    EXPECT_NEAR(observedOrder(runs, {"v", "q", true, 0.0}), 0.0, 1e-9);
    EXPECT_TRUE(std::isnan(observedOrder(runs, {"v", "other", false, 0.0})));
  }
}

TEST(Runner, OverridesMergeVariantsAndGoalsCountOnlyWhereNothingChanged) {
  Overrides overrides;
  overrides.cells_across = 4.0;
  const std::vector<CaseRun> runs = runsOf(syntheticCase(2.0), overrides);
  ASSERT_EQ(runs.size(), 2u);   // two steps
  EXPECT_TRUE(runs[0].judged);  // one of the variants had this resolution by itself
  EXPECT_FALSE(runs[1].judged);
}

TEST(RunRecord, HasALineForEachMeasurementAndEscapes) {
  CaseRun run;
  run.case_name = "a \"case\"";
  run.variant = "v";
  run.measurements = {{"q", 1.0, 2.0, 0.1}, {"r", std::nan(""), 0.0, 0.0, 1.0}};
  const std::string json = toJson(run, {"abc", "machine"});
  EXPECT_NE(json.find("\"case\": \"a \\\"case\\\"\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"error\": -0.5"), std::string::npos) << json;
  EXPECT_NE(json.find("\"result\": null"), std::string::npos) << json;
  EXPECT_EQ(std::count(json.begin(), json.end(), '\n'), 2);
}

TEST(Options, WrongOnesAreNamed) {
  EXPECT_EQ(parseValidationOptions({"array", "--quick", "--dt=0.5"}).overrides.dt, 0.5);
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"--dt", "0"}, {"--resolution"}, {"--solver", "best"}, {"--fast"}, {"--tolerance", "1e-5x"}}) {
    try {
      parseValidationOptions(wrong);
      ADD_FAILURE() << wrong[0] << " was accepted";
    } catch (const WrongCommand& error) {
      EXPECT_NE(std::string(error.what()).find(wrong[0]), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace monolith
