#pragma once
// A YAML map read key by key, with every violation collected: "FILE:LINE: key: value ...: expected ...".

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

namespace monolith {

class Violations {
 public:
  explicit Violations(std::string file) : file_(std::move(file)) {}

  void add(const YAML::Node& at, const std::string& text);
  std::size_t count() const { return lines_.size(); }
  // Throws SceneError with a line for each violation, if there is any.
  void throwIfAny() const;

 private:
  std::string file_;
  std::vector<std::string> lines_;
};

// What a number must fulfil.
enum class Range { kFinite, kPositive, kNotNegative };

// A value as it stands in the file, on one line; of a long or a deep one the beginning.
std::string shownValue(const YAML::Node& node);

class YamlMap {
 public:
  // `path` is the map's own key ("" for the whole file). Anything but a map, an unknown and a repeated key are
  // violations.
  YamlMap(const YAML::Node& node, const std::string& path, const std::vector<std::string>& known,
          Violations& violations);

  bool has(const std::string& key) const;
  YAML::Node get(const std::string& key) const;
  std::string path(const std::string& key) const;
  // Reports the key if it is missing.
  void require(const std::string& key, const std::string& expected) const;
  // "key: value ...: expected ..."
  void fail(const std::string& key, const std::string& expected) const;

  // Each leaves `out` alone if the key is missing or its value wrong; a wrong value is a violation.
  void read(const std::string& key, double& out, Range range) const;
  void read(const std::string& key, int& out, int least, int most = std::numeric_limits<int>::max()) const;
  void read(const std::string& key, std::string& out) const;
  void read(const std::string& key, bool& out) const;
  void read(const std::string& key, bool (&out)[3]) const;
  // Size N vectors, every component within the range.
  template <int N>
  void read(const std::string& key, Eigen::Matrix<double, N, 1>& out, Range range = Range::kFinite) const {
    readNumbers(key, out.data(), N, range);
  }
  // One of `words`, or `otherwise` if the key is missing or its value wrong.
  std::string readWord(const std::string& key, const std::string& otherwise,
                       const std::vector<std::string>& words) const;

 private:
  void readNumbers(const std::string& key, double* out, int count, Range range) const;

  YAML::Node node_;
  std::string path_;
  Violations& violations_;
};

}  // namespace monolith
