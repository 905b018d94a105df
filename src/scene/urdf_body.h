#pragma once
// URDF -> rigid bodies. Links joined by fixed joints become one: body frame B = frame of the first of them; mass,
// centre of mass and inertia are summed; every collision shape and link frame is placed in B. A revolute, continuous or
// prismatic joint begins another body, whose frame is that of the joint's child link.

#include <string>
#include <vector>

#include "scene/scene_file.h"
#include "scene/urdf_text.h"

namespace monolith {

// Sets source, urdf_xml, mass properties, shapes, links and joint of `bodies`: first that of the root link, which has
// no joint, each of the others after the one it hangs on; joint->parent counts in `bodies`. Names are left empty. In
// urdf_xml, the same for all, relative mesh paths become file:// references.
// Returns what is wrong, a line each, naming the source, the link or joint, the value and what was expected; then
// `bodies`, of which there is at least one, are only partly set.
std::vector<std::string> readUrdfBodies(const UrdfText& urdf, const SceneResolver& resolver,
                                        std::vector<BodyDescription>& bodies);

}  // namespace monolith
