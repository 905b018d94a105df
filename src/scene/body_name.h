#pragma once
// Names that topics and tf frames can be named after.

#include <algorithm>
#include <string>

namespace monolith {

// A letter followed by letters, digits or _; for messages.
constexpr char kBodyNameRule[] =
    "a letter followed by letters, digits or _, because topics and tf frames are named after it";

inline bool validBodyName(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && letter(name.front()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

}  // namespace monolith
