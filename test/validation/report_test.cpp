// The report of runs, good or not; without its plots, which need packages that the tests do without.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "framework/run_record.h"
#include "temporary_folder.h"

namespace monolith {
namespace {

using CaseRun = Run;  // ::testing::Test has a Run of its own

std::string reportOf(const std::vector<CaseRun>& runs) {
  const TemporaryFolder folder;
  std::string lines;
  for (const CaseRun& run : runs) lines += toJson(run, {"abc", "machine"});
  const std::string command = "/usr/bin/python3 '" +
                              folder.write("make.py",
                                           "import sys\n"
                                           "sys.dont_write_bytecode = True\n"
                                           "sys.path.insert(0, '" MONOLITH_SOURCE_DIR
                                           "/validation')\n"
                                           "import report\n"
                                           "report.plotCase = lambda *arguments: None\n"
                                           "report.main()\n") +
                              "' '" + folder.write("runs.jsonl", lines) + "' '" + folder.path() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ostringstream text;
  text << std::ifstream(folder.path() + "/REPORT.md").rdbuf();
  return text.str();
}

CaseRun runAt(double cells_across) {
  CaseRun run;
  run.case_name = "case";
  run.variant = "variant";
  run.numerics.cells_across = cells_across;
  run.cpu_s = 2.0;
  run.simulated_s = 1.0;
  return run;
}

TEST(Report, TellsGoodMissedAndFailedRuns) {
  CaseRun good = runAt(8.0), missed = runAt(4.0), failed = runAt(16.0), undefined = runAt(32.0);
  good.measurements = {{"drag", 1.01, 1.0, 0.02}};
  missed.measurements = {{"drag", 1.04, 1.0, 0.02}};
  failed.failure = "step 3 failed,\nnot converged";
  undefined.measurements = {{"drag", std::nan(""), 1.0, 0.02}};
  const std::string some = reportOf({good, missed});
  EXPECT_NE(some.find("1 of 2 missed"), std::string::npos) << some;
  EXPECT_NE(some.find("| variant | drag | 8 |"), std::string::npos) << some;
  const std::string all = reportOf({good, missed, failed, undefined});
  EXPECT_NE(all.find("failed: 2"), std::string::npos) << all;
  EXPECT_NE(all.find("| variant | failed: step 3 failed, not converged | 16 |"), std::string::npos) << all;
  EXPECT_NE(all.find("| variant | failed: drag is no number | 32 |"), std::string::npos) << all;
}

// The advice of a report, a line for each.
std::string adviceOf(const std::vector<CaseRun>& runs) {
  const std::string report = reportOf(runs);
  const std::string head = "|---|---|---|---|---|---|---|\n";
  const auto section = report.find("## Advice");
  return section == std::string::npos ? report : report.substr(report.find(head, section) + head.size());
}

TEST(Report, AdvisesByTheLargestErrorOfEveryQuantityThatHasAGoal) {
  // The coarse run has no goal for its damping, which is far off; a second variant has none at all.
  CaseRun coarse = runAt(8.0), fine = runAt(16.0), other_coarse = runAt(8.0), other_fine = runAt(16.0);
  coarse.measurements = {{"frequency", 1.005, 1.0, 0.01}, {"damping", 1.3, 1.0, 0.0}, {"aside", 2.0, 1.0, 0.0}};
  fine.measurements = {{"frequency", 1.004, 1.0, 0.01}, {"damping", 1.015, 1.0, 0.1}, {"aside", 2.0, 1.0, 0.0}};
  EXPECT_EQ(adviceOf({coarse, fine}), "| case | 2 % | 16 | 0 | 1e-05 | 2 | CPU s per simulated s |\n");
  other_coarse.variant = other_fine.variant = "other";
  other_coarse.measurements = {{"damping", 1.01, 1.0, 0.0}};
  other_fine.measurements = {{"damping", 1.07, 1.0, 0.0}};
  EXPECT_EQ(adviceOf({coarse, fine, other_coarse, other_fine}),
            "| case | 10 % | 16 | 0 | 1e-05 | 2 | CPU s per simulated s |\n");
  // Numerics with which a variant fails are not advised.
  other_fine.measurements.clear();
  other_fine.failure = "not converged";
  EXPECT_EQ(adviceOf({coarse, fine, other_coarse, other_fine}), "");
}

TEST(Report, WhatIsOnlySeenOrNotIsNoAccuracy) {
  CaseRun run = runAt(8.0);
  run.measurements = {observed("it floats", true)};
  EXPECT_EQ(adviceOf({run}), "");
  run.measurements.push_back({"draught", 1.04, 1.0, 0.1});
  EXPECT_EQ(adviceOf({run}), "| case | 5 % | 8 | 0 | 1e-05 | 2 | CPU s per simulated s |\n");
}

}  // namespace
}  // namespace monolith
