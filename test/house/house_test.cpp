// Holds the sources to the rules of the house, and the rules to small examples that break them.

#include <gtest/gtest.h>

#include "source_rules.h"

#ifndef MONOLITH_SOURCE_DIR
#error "MONOLITH_SOURCE_DIR is not defined"
#endif

namespace monolith {
namespace {

std::string joined(const Violations& violations) {
  std::string text;
  for (const std::string& violation : violations) text += violation + "\n";
  return text;
}

Files sources() {
  static const Files files = readFiles(MONOLITH_SOURCE_DIR, {"src"});
  return files;
}

// ---- the rules themselves

TEST(Rules, ImportUpwardsIsFound) {
  const Files files = {{"src/solve/a.h", "#pragma once\n#include \"coupling/b.h\"\n"}, {"src/coupling/b.h", ""}};
  EXPECT_EQ(findForbiddenImports(files),
            Violations{"src/solve/a.h:2: solve may not import from coupling: coupling/b.h"});
}

TEST(Rules, ImportDownwardsOrWithinIsAllowed) {
  const Files files = {{"src/coupling/a.cpp", "#include \"coupling/a.h\"\n#include \"solve/b.h\"\n#include <vector>\n"},
                       {"src/coupling/a.h", ""},
                       {"src/solve/b.h", ""}};
  EXPECT_EQ(joined(findForbiddenImports(files)), "");
}

TEST(Rules, FluidDoesNotKnowScenes) {
  const Files files = {{"src/fluid/a.h", "#include <scene/b.h>\n"}, {"src/scene/b.h", ""}};
  EXPECT_EQ(findForbiddenImports(files).size(), 1u);
}

TEST(Rules, RosOutsideTheNodeIsFound) {
  for (const std::string import : {"<ros/ros.h>", "<tf2_ros/buffer.h>", "<sensor_msgs/PointCloud2.h>",
                                   "<std_srvs/Empty.h>", "\"monolith_tank/Statistics.h\"", "<XmlRpcValue.h>"}) {
    EXPECT_EQ(findForbiddenImports({{"src/scene/a.h", "  # include " + import}}).size(), 1u) << import;
    EXPECT_EQ(findForbiddenImports({{"src/node/a.h", "#include " + import}}).size(), 0u) << import;
  }
}

TEST(Rules, MissingImportAndUnknownRoomAreFound) {
  EXPECT_EQ(findForbiddenImports({{"src/solve/a.h", "#include \"solve/gone.h\"\n"}}).size(), 1u);
  EXPECT_EQ(findForbiddenImports({{"src/attic/a.h", ""}}).size(), 1u);
  EXPECT_EQ(findForbiddenImports({{"src/a.h", ""}}).size(), 1u);
}

TEST(Rules, ImportThatHidesItsRoomIsFound) {
  for (const std::string import : {"\"b.h\"", "\"../coupling/b.h\"", "<../coupling/b.h>", "\"src/coupling/b.h\""}) {
    EXPECT_EQ(findForbiddenImports({{"src/solve/a.h", "#include " + import}, {"src/solve/b.h", ""}}).size(), 1u)
        << import;
  }
}

TEST(Rules, CycleIsFoundOnce) {
  const Files files = {{"src/solve/a.h", "#include \"solve/b.h\"\n"},
                       {"src/solve/b.h", "#include \"solve/c.h\"\n"},
                       {"src/solve/c.h", "#include \"solve/a.h\"\n"}};
  EXPECT_EQ(findImportCycles(files), Violations{"src/solve/a.h: imports itself by way of src/solve/b.h src/solve/c.h"});
}

TEST(Rules, DiamondIsNoCycle) {
  const Files files = {{"src/solve/a.h", "#include \"solve/b.h\"\n#include \"solve/c.h\"\n"},
                       {"src/solve/b.h", "#include \"solve/d.h\"\n"},
                       {"src/solve/c.h", "#include \"solve/d.h\"\n"},
                       {"src/solve/d.h", ""}};
  EXPECT_EQ(joined(findImportCycles(files)), "");
}

TEST(Rules, UnguardedHeaderIsFound) {
  EXPECT_EQ(findUnguardedHeaders({{"src/solve/a.h", "int x;\n#pragma once\n"}}).size(), 1u);
  EXPECT_EQ(findUnguardedHeaders({{"src/solve/a.h", ""}}).size(), 1u);
  EXPECT_EQ(findUnguardedHeaders({{"src/solve/a.h", "#pragma once\nint x;\n"}, {"src/solve/a.cpp", ""}}).size(), 0u);
}

TEST(Rules, LongFileIsFound) {
  std::string text;
  for (int i = 0; i < kMaximumLines; ++i) text += "\n";
  EXPECT_EQ(findLongFiles({{"src/solve/a.h", text}}).size(), 0u);
  EXPECT_EQ(findLongFiles({{"src/solve/a.h", text + "x"}}).size(), 1u);
}

TEST(Rules, WideLineIsFound) {
  const std::string line(kMaximumColumns, 'x');
  EXPECT_EQ(findWideLines({{"src/solve/a.h", line + "\n" + line + "x\n"}}),
            Violations{"src/solve/a.h:2: 121 columns, expected at most 120"});
  EXPECT_EQ(joined(findWideLines({{"README.md", line + "x"}})), "");
}

TEST(Rules, ForbiddenWordIsFound) {
  for (const std::string& word : {std::string("TO") + "DO", std::string("FIX") + "ME", std::string("XX") + "X",
                                  std::string("DES") + "IGN"}) {
    EXPECT_EQ(findForbiddenWords({{"a.h", "int x;\n// " + word + ": more"}}).size(), 1u) << word;
  }
  for (const std::string folder : {"home", "root", "work", "Users"}) {
    const std::string path = "/" + folder + "/somebody";
    EXPECT_EQ(findForbiddenWords({{"a.yaml", "urdf: " + path + "/x.urdf"}}).size(), 1u) << path;
    EXPECT_EQ(findForbiddenWords({{"a.yaml", path}}).size(), 1u) << path;
  }
  EXPECT_EQ(joined(findForbiddenWords({{"a.h",
                                        "src/work/a.h, body/root/x, XXXXXX, DESIGNED, design, a/ho"
                                        "me/b"}})),
            "");
}

TEST(Rules, MissingFolderIsAnError) {
  EXPECT_THROW(readFiles(MONOLITH_SOURCE_DIR, {"no_such_folder"}), std::runtime_error);
}

// ---- the house

TEST(House, SourcesAreFound) {
  for (const char* file : {"src/scene/scene.h", "src/simulation/simulation.h", "src/solve/lattice.h"}) {
    EXPECT_TRUE(sources().count(file)) << file;
  }
}

TEST(House, ImportsRunDownOnly) { EXPECT_EQ(joined(findForbiddenImports(sources())), ""); }

TEST(House, NoImportCycles) { EXPECT_EQ(joined(findImportCycles(sources())), ""); }

TEST(House, HeadersAreGuarded) { EXPECT_EQ(joined(findUnguardedHeaders(sources())), ""); }

TEST(House, FilesAreShort) { EXPECT_EQ(joined(findLongFiles(sources())), ""); }

TEST(House, LinesAreNarrow) {
  EXPECT_EQ(joined(findWideLines(readFiles(MONOLITH_SOURCE_DIR, {"src", "test", "validation", "launch"}))), "");
}

TEST(House, NothingUnfinishedAndNoPathOfOneMachine) {
  const Files files = readFiles(MONOLITH_SOURCE_DIR, {"src", "test", "validation", "launch", "config", "urdf", "msg",
                                                      "srv", ".ci", "tank", "README.md", "LICENSE", "CMakeLists.txt",
                                                      "package.xml", ".gitignore", ".clang-format", ".clang-tidy"});
  EXPECT_EQ(joined(findForbiddenWords(files)), "");
}

}  // namespace
}  // namespace monolith
