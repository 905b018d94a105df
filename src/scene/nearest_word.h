#pragma once
// What was probably meant by a word that nobody knows.

#include <string>
#include <vector>

namespace monolith {

// The word of `known`, of which there must be one, with the least edit distance to `word`; one that has `word` as a
// part counts as near.
std::string nearestWord(const std::string& word, const std::vector<std::string>& known);

}  // namespace monolith
