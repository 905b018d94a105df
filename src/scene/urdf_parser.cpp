#include "scene/urdf_parser.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <exception>
#include <mutex>

#include "scene/scene.h"

namespace monolith {
namespace {

// Takes over console_bridge, which is global to the process, while it lives.
class CapturedErrors : public console_bridge::OutputHandler {
 public:
  CapturedErrors() : lock_(mutex()), previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~CapturedErrors() override { console_bridge::useOutputHandler(previous_); }

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) text_ += (text_.empty() ? "" : "; ") + text;
  }

  const std::string& text() const { return text_; }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  std::string text_;
};

// Comments may speak of xacro without using it.
std::string withoutComments(std::string xml) {
  for (std::size_t begin = xml.find("<!--"); begin != std::string::npos; begin = xml.find("<!--", begin)) {
    const std::size_t end = xml.find("-->", begin + 4);
    xml.erase(begin, end == std::string::npos ? std::string::npos : end + 3 - begin);
  }
  return xml;
}

// The parser goes down into elements by recursion: without end, its stack has one. URDF needs about six.
constexpr int kDeepestElement = 100;

// Of elements in each other.
int deepestElement(const std::string& xml) {
  int depth = 0, deepest = 0;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const char next = at + 1 < xml.size() ? xml[at + 1] : ' ';
    if (xml.compare(at, 4, "<!--") == 0) {
      at = std::min(xml.find("-->", at + 4), xml.size());
    } else if (next == '/') {
      --depth;
    } else if (next != '?' && next != '!') {
      deepest = std::max(deepest, ++depth);
      char quote = 0;
      for (; at < xml.size() && (quote != 0 || xml[at] != '>'); ++at) {
        if (quote != 0 ? xml[at] == quote : xml[at] == '"' || xml[at] == '\'') quote = quote != 0 ? 0 : xml[at];
      }
      if (at < xml.size() && xml[at - 1] == '/') --depth;
    }
  }
  return deepest;
}

}  // namespace

urdf::ModelInterfaceSharedPtr parseUrdf(const std::string& xml, const std::string& source) {
  if (withoutComments(xml).find("<xacro:") != std::string::npos) {
    throw SceneError(source + ": has <xacro:...> elements: expected plain URDF, expanded by xacro beforehand");
  }
  const int depth = deepestElement(xml);
  if (depth > kDeepestElement) {
    throw SceneError(source + ": has elements " + std::to_string(depth) + " deep in each other: expected at most " +
                     std::to_string(kDeepestElement));
  }
  CapturedErrors errors;
  std::string reason;
  try {
    const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(xml);
    // The parser drops some elements that it cannot read and goes on: that would be another body.
    if (model && model->getRoot() && errors.text().empty()) return model;
  } catch (const std::exception& exception) {
    reason = exception.what();
  }
  if (reason.empty()) reason = errors.text();
  if (reason.empty()) reason = "no root link";
  throw SceneError(source + ": malformed URDF: " + reason + ": expected a <robot> with one tree of links");
}

}  // namespace monolith
