#pragma once
// One JSON object, on one line, built key by key.

#include <string>

namespace monolith {

class JsonObject {
 public:
  void add(const std::string& key, double value);  // null unless finite
  void add(const std::string& key, const std::string& value);
  void add(const std::string& key, const char* value) { add(key, std::string(value)); }
  // json: any JSON value as it stands.
  void addRaw(const std::string& key, const std::string& json);
  std::string str() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

}  // namespace monolith
