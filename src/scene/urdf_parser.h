#pragma once
// urdfdom with its complaints collected: it prints them and returns a null pointer.

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <string>

namespace monolith {

// Throws SceneError with the parser's own messages, each after `source`.
urdf::ModelInterfaceSharedPtr parseUrdf(const std::string& xml, const std::string& source);

}  // namespace monolith
