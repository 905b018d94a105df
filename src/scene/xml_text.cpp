#include "scene/xml_text.h"

#include <cstdlib>
#include <utility>

namespace monolith {
namespace {

constexpr std::pair<char, const char*> kEntities[] = {
    {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&apos;"}};

// The character of an entity from & to ;, 0 if it is none of those known.
char characterOf(const std::string& entity) {
  for (const auto& [character, name] : kEntities) {
    if (entity == name) return character;
  }
  if (entity.compare(0, 2, "&#") != 0) return 0;
  const bool is_hexadecimal = entity[2] == 'x';
  const char* digits = entity.c_str() + (is_hexadecimal ? 3 : 2);
  char* end = nullptr;
  const long code = std::strtol(digits, &end, is_hexadecimal ? 16 : 10);
  return *end == ';' && end != digits && code > 0 && code < 128 ? static_cast<char>(code) : 0;
}

}  // namespace

std::string escapedXml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const char* entity = nullptr;
    for (const auto& [character, name] : kEntities) {
      if (c == character) entity = name;
    }
    if (entity) {
      out += entity;
    } else {
      out += c;
    }
  }
  return out;
}

std::string unescapedXml(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::size_t end = text[at] == '&' ? text.find(';', at) : std::string::npos;
    const char character = end == std::string::npos ? 0 : characterOf(text.substr(at, end + 1 - at));
    out += character ? character : text[at];
    if (character) at = end;
  }
  return out;
}

}  // namespace monolith
