#pragma once
// Text in XML: what its attributes hold, and how it is written there.

#include <string>

namespace monolith {

// For an attribute in quotes of either kind.
std::string escapedXml(const std::string& text);

// The five named entities and those by number up to 127; others stay as they are.
std::string unescapedXml(const std::string& text);

}  // namespace monolith
