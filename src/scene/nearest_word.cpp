#include "scene/nearest_word.h"

#include <algorithm>
#include <numeric>

namespace monolith {
namespace {

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

// A word that is part of the other ("viscosity" of "dynamic_viscosity") was left short, not misspelt.
std::size_t wordDistance(const std::string& word, const std::string& known) {
  const bool is_part = word.size() > 2 && known.find(word) != std::string::npos;
  return is_part ? std::min<std::size_t>(editDistance(word, known), 1) : editDistance(word, known);
}

}  // namespace

std::string nearestWord(const std::string& word, const std::vector<std::string>& known) {
  return *std::min_element(known.begin(), known.end(), [&](const std::string& a, const std::string& b) {
    return wordDistance(word, a) < wordDistance(word, b);
  });
}

}  // namespace monolith
