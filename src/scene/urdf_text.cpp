#include "scene/urdf_text.h"

#include <tinyxml.h>

#include <algorithm>
#include <filesystem>

namespace monolith {

std::string withAbsoluteMeshes(const UrdfText& urdf, const std::set<std::string>& mesh_files) {
  const auto relative = [](const std::string& file) { return file.find("://") == std::string::npos; };
  if (urdf.folder.empty() || std::none_of(mesh_files.begin(), mesh_files.end(), relative)) return urdf.xml;
  TiXmlDocument document;
  document.Parse(urdf.xml.c_str());
  const auto visit = [&](auto&& self, TiXmlElement& element) -> void {
    const char* file = element.Attribute("filename");
    if (file != nullptr && element.ValueStr() == "mesh" && relative(file)) {
      const auto path = std::filesystem::absolute(std::filesystem::path(urdf.folder) / file).lexically_normal();
      element.SetAttribute("filename", "file://" + path.string());
    }
    for (auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
      self(self, *child);
    }
  };
  visit(visit, *document.RootElement());
  TiXmlPrinter printer;
  document.Accept(&printer);
  return printer.Str();
}

}  // namespace monolith
