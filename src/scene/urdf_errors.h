#pragma once
// What is wrong with a URDF, a line each: "SOURCE: element and value: what was expected".

#include <string>
#include <utility>
#include <vector>

namespace monolith {

class UrdfErrors {
 public:
  // source: file or parameter.
  explicit UrdfErrors(std::string source) : source_(std::move(source)) {}

  void add(const std::string& element_and_value, const std::string& expected) {
    addLine(source_ + ": " + element_and_value + ": " + expected);
  }
  // One that is complete.
  void addLine(const std::string& line) { lines_.push_back(line); }

  const std::string& source() const { return source_; }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::string source_;
  std::vector<std::string> lines_;
};

}  // namespace monolith
