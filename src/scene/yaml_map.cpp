#include "scene/yaml_map.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "scene/nearest_word.h"
#include "scene/scene.h"

namespace monolith {
namespace {

constexpr std::size_t kMostShown = 300;  // bytes of a value in a message
constexpr int kMostDepth = 4;            // of collections in it

std::string expectedText(Range range) {
  switch (range) {
    case Range::kPositive: return "a finite number > 0";
    case Range::kNotNegative: return "a finite number >= 0";
    case Range::kFinite: break;
  }
  return "a finite number";
}

bool within(double value, Range range) {
  if (!std::isfinite(value)) return false;
  if (range == Range::kPositive) return value > 0.0;
  return range == Range::kFinite || value >= 0.0;
}

// A collection may be an alias for one that it is in: what it shows has to end.
void show(const YAML::Node& node, int depth, std::string& text) {
  if (!node.IsDefined() || node.IsNull()) {
    text += "(nothing)";
  } else if (node.IsScalar()) {
    text += node.Scalar();
  } else if (depth > kMostDepth) {
    text += "...";
  } else {
    const bool is_list = node.IsSequence();
    text += is_list ? "[" : "{";
    bool first = true;
    for (const auto& entry : node) {
      if (text.size() > kMostShown) return;
      if (!first) text += ", ";
      first = false;
      if (is_list) {
        show(entry, depth + 1, text);
      } else {
        show(entry.first, depth + 1, text);
        text += ": ";
        show(entry.second, depth + 1, text);
      }
    }
    text += is_list ? "]" : "}";
  }
}

bool toNumber(const YAML::Node& node, double& out) {
  return node.IsScalar() && YAML::convert<double>::decode(node, out);
}

}  // namespace

void Violations::add(const YAML::Node& at, const std::string& text) {
  const int line = at.IsDefined() ? at.Mark().line : -1;
  lines_.push_back(file_ + (line >= 0 ? ":" + std::to_string(line + 1) : "") + ": " + text);
}

void Violations::throwIfAny() const {
  if (lines_.empty()) return;
  std::string text;
  for (const std::string& line : lines_) text += (text.empty() ? "" : "\n") + line;
  throw SceneError(text);
}

std::string shownValue(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) return "(nothing)";
  std::string text;
  show(node, 0, text);
  if (text.size() <= kMostShown) return text;
  std::size_t end = kMostShown;
  while (end > 0 && (text[end] & 0xC0) == 0x80) --end;  // within a character of UTF-8
  return text.substr(0, end) + "...";
}

YamlMap::YamlMap(const YAML::Node& node, const std::string& path, const std::vector<std::string>& known,
                 Violations& violations)
    : node_(node), path_(path), violations_(violations) {
  if (!node.IsMap()) {
    violations.add(node, (path.empty() ? "" : path + ": ") + "value " + shownValue(node) +
                             ": expected a map with keys such as \"" + known.front() + "\"");
    node_ = YAML::Node(YAML::NodeType::Map);
    return;
  }
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string key = shownValue(entry.first);
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      violations.add(entry.first, this->path(key) + ": unknown key: expected another, the nearest is \"" +
                                      nearestWord(key, known) + "\"");
    } else if (!seen.insert(key).second) {
      violations.add(entry.first, this->path(key) + ": given twice: expected once");
    }
  }
}

bool YamlMap::has(const std::string& key) const { return get(key).IsDefined(); }

YAML::Node YamlMap::get(const std::string& key) const {
  const YAML::Node& constant = node_;  // operator[] of a mutable node would insert the key
  return constant[key];
}

std::string YamlMap::path(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

void YamlMap::require(const std::string& key, const std::string& expected) const {
  if (!has(key)) violations_.add(node_, path(key) + ": missing: expected " + expected);
}

void YamlMap::fail(const std::string& key, const std::string& expected) const {
  const YAML::Node value = get(key);
  violations_.add(value.IsDefined() ? value : node_,
                  path(key) + ": value " + shownValue(value) + ": expected " + expected);
}

void YamlMap::read(const std::string& key, double& out, Range range) const {
  if (!has(key)) return;
  double value;
  if (!toNumber(get(key), value) || !within(value, range)) return fail(key, expectedText(range));
  out = value;
}

void YamlMap::read(const std::string& key, int& out, int least, int most) const {
  if (!has(key)) return;
  const YAML::Node node = get(key);
  double value;
  if (!toNumber(node, value) || value != std::floor(value) || value < least || value > most) {
    return fail(key, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  }
  out = static_cast<int>(value);
}

void YamlMap::read(const std::string& key, std::string& out) const {
  if (!has(key)) return;
  const YAML::Node node = get(key);
  if (!node.IsScalar() || node.Scalar().empty()) return fail(key, "a text");
  out = node.Scalar();
}

void YamlMap::read(const std::string& key, bool& out) const {
  if (!has(key)) return;
  const YAML::Node node = get(key);
  if (!node.IsScalar() || !YAML::convert<bool>::decode(node, out)) fail(key, "true or false");
}

void YamlMap::read(const std::string& key, bool (&out)[3]) const {
  if (!has(key)) return;
  const YAML::Node node = get(key);
  bool values[3];
  bool good = node.IsSequence() && node.size() == 3;
  for (int i = 0; good && i < 3; ++i) {
    good = node[i].IsScalar() && YAML::convert<bool>::decode(node[i], values[i]);
  }
  if (!good) return fail(key, "a list of 3 times true or false");
  std::copy(values, values + 3, out);
}

std::string YamlMap::readWord(const std::string& key, const std::string& otherwise,
                              const std::vector<std::string>& words) const {
  if (!has(key)) return otherwise;
  const std::string word = shownValue(get(key));
  if (std::find(words.begin(), words.end(), word) != words.end()) return word;
  std::string all;
  for (const std::string& known : words) all += (all.empty() ? "" : ", ") + known;
  fail(key, "one of " + all + "; the nearest is \"" + nearestWord(word, words) + "\"");
  return otherwise;
}

void YamlMap::readNumbers(const std::string& key, double* out, int count, Range range) const {
  if (!has(key)) return;
  const YAML::Node node = get(key);
  std::vector<double> values(count);
  bool good = node.IsSequence() && static_cast<int>(node.size()) == count;
  for (int i = 0; good && i < count; ++i) good = toNumber(node[i], values[i]) && within(values[i], range);
  if (!good) return fail(key, "a list of " + std::to_string(count) + ", each " + expectedText(range));
  std::copy(values.begin(), values.end(), out);
}

}  // namespace monolith
