#pragma once
// <collision> of a URDF's link -> Shape.

#include <urdf_model/link.h>

#include <optional>
#include <string>

#include "geometry/shape.h"
#include "scene/scene_file.h"
#include "scene/urdf_errors.h"
#include "scene/urdf_text.h"

namespace monolith {

// `name` becomes the shape's; X_BL: the link's frame in the body's. Nothing if there is no geometry or its mesh cannot
// be read; this and wrong values are errors.
std::optional<Shape> readUrdfCollision(const urdf::Collision& collision, const std::string& name,
                                       const Eigen::Isometry3d& X_BL, const UrdfText& urdf,
                                       const SceneResolver& resolver, UrdfErrors& errors);

}  // namespace monolith
