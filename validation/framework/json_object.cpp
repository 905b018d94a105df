#include "framework/json_object.h"

#include <cmath>
#include <cstdio>

namespace monolith {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else if (static_cast<unsigned char>(c) >= 0x20) {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace

void JsonObject::add(const std::string& key, double value) {
  char text[32] = "null";
  if (std::isfinite(value)) std::snprintf(text, sizeof text, "%.10g", value);
  addRaw(key, text);
}

void JsonObject::add(const std::string& key, const std::string& value) { addRaw(key, quoted(value)); }

void JsonObject::addRaw(const std::string& key, const std::string& json) {
  text_ += (text_.empty() ? "" : ", ") + quoted(key) + ": " + json;
}

}  // namespace monolith
