// The count of test results: what passes, fails, is missing or empty, as ./tank test counts it.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "temporary_folder.h"

namespace {

namespace fs = std::filesystem;

const std::string kPassed = "<testcase classname='A' name='good' status='run'/>";
const std::string kFailed =
    "<testcase classname='A' name='bad' status='run'><failure message='1 is not 2'/></testcase>";
const std::string kSkipped = "<testcase classname='A' name='off'><skipped message='no display'/></testcase>";

class SummaryTest : public ::testing::Test {
 protected:
  SummaryTest() {
    fs::create_directory(folder_ / "results");
    writeLog("");
  }

  fs::path result(const std::string& name) const { return folder_ / "results" / name; }

  void writeResult(const std::string& name, const std::string& cases) const {
    std::ofstream(result(name)) << "<testsuites><testsuite name='A'>" << cases << "</testsuite></testsuites>";
  }

  void writeLog(const std::string& text) const { std::ofstream(folder_ / "log") << text; }

  // Output and exit code of the script, told to expect the given result files.
  void run(const std::vector<std::string>& expected) {
    std::string command = "/usr/bin/python3 '" MONOLITH_SOURCE_DIR "/test/summary.py' '" + (folder_ / "log").string() +
                          "' '" + (folder_ / "results").string() + "'";
    for (const std::string& name : expected) command += " '" + result(name).string() + "'";
    FILE* pipe = popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    char buffer[4096];
    output_.clear();
    while (const auto count = fread(buffer, 1, sizeof buffer, pipe)) output_.append(buffer, count);
    exit_code_ = WEXITSTATUS(pclose(pipe));
  }

  std::string lastLine() const {
    const std::string text = output_.substr(0, output_.find_last_not_of('\n') + 1);
    return text.substr(text.rfind('\n') + 1);
  }

  bool shows(const std::string& text) const { return output_.find(text) != std::string::npos; }

  const monolith::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::string output_;
  int exit_code_ = -1;
};

TEST_F(SummaryTest, AllPassed) {
  writeResult("gtest-a.xml", kPassed + kPassed + kSkipped);
  writeResult("gtest-b.xml", kPassed);
  run({"gtest-a.xml", "gtest-b.xml"});
  EXPECT_EQ(output_, "3 passed, 0 failed, 1 skipped\n");
  EXPECT_EQ(exit_code_, 0);
}

TEST_F(SummaryTest, FailureIsShownAndCounted) {
  writeResult("gtest-a.xml", kPassed + kFailed);
  run({"gtest-a.xml"});
  EXPECT_EQ(lastLine(), "1 passed, 1 failed");
  EXPECT_TRUE(shows("gtest-a: A.bad")) << output_;
  EXPECT_TRUE(shows("1 is not 2")) << output_;
  EXPECT_EQ(exit_code_, 1);
}

TEST_F(SummaryTest, CrashIsAFailureWithTheProgramsLastWords) {
  writeResult("gtest-a.xml", kPassed);
  writeResult("MISSING-gtest-b.xml", kFailed);
  writeLog(
      "-- run_tests.py: execute commands\nnot this\n-- run_tests.py: verify result \"/x/gtest-a.xml\"\n"
      "-- run_tests.py: execute commands\nSegmentation fault\n-- run_tests.py: verify result \"/x/gtest-b.xml\"\n");
  run({"gtest-a.xml", "gtest-b.xml"});
  EXPECT_EQ(lastLine(), "1 passed, 1 failed");
  EXPECT_TRUE(shows("Segmentation fault")) << output_;
  EXPECT_FALSE(shows("not this")) << output_;
  EXPECT_EQ(exit_code_, 1);
}

TEST_F(SummaryTest, NothingRunIsNoSuccess) {
  run({});
  EXPECT_EQ(lastLine(), "0 passed, 0 failed");
  EXPECT_EQ(exit_code_, 1);
  writeResult("gtest-a.xml", kSkipped);
  run({"gtest-a.xml"});
  EXPECT_EQ(lastLine(), "0 passed, 0 failed, 1 skipped");
  EXPECT_EQ(exit_code_, 1);
}

TEST_F(SummaryTest, EmptyOrBrokenResultIsAFailure) {
  writeResult("gtest-a.xml", kPassed);
  writeResult("gtest-b.xml", "");
  writeResult("gtest-c.xml", "<testcase");
  run({"gtest-a.xml", "gtest-b.xml", "gtest-c.xml"});
  EXPECT_EQ(lastLine(), "1 passed, 2 failed");
  EXPECT_EQ(exit_code_, 1);
}

TEST_F(SummaryTest, FailureOfRostestItselfIsShownByTheLog) {
  writeResult("gtest-a.xml", kPassed);
  writeResult("rostest-b.xml", kFailed);
  writeLog("-- run_tests.py: execute commands\nImportError\n-- run_tests.py: verify result \"/x/rostest-b.xml\"\n");
  run({"gtest-a.xml", "rostest-b.xml"});
  EXPECT_EQ(lastLine(), "1 passed, 1 failed");
  EXPECT_TRUE(shows("ImportError")) << output_;
}

TEST_F(SummaryTest, RostestsOwnFileIsNotCountedTwice) {
  writeResult("rostest-a.xml", kPassed);
  writeResult("rosunit-a.xml", kPassed + kPassed);
  run({"rostest-a.xml"});
  EXPECT_EQ(lastLine(), "2 passed, 0 failed");
  EXPECT_EQ(exit_code_, 0);
}

}  // namespace
