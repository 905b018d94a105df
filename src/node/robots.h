#pragma once
// Robots of a scene: bodies that hang on a root by movable joints, made from one URDF. What topics, services and tf
// know by the root's name.

#include <string>
#include <vector>

#include "node/frame_names.h"
#include "scene/scene.h"

namespace monolith {

struct Robot {
  std::string name;          // of its root
  std::vector<int> jointed;  // bodies in Scene::bodies that hang on others: its joints, in this order
};

// In the order of their roots, without bodies that nothing hangs on.
std::vector<Robot> findRobots(const Scene& scene);

// What a body hangs on in the end; the body itself if it hangs on none.
int rootOf(const Scene& scene, int body);

// Whether what acts on a body can move it: it is free, or hangs by a joint that is not prescribed on another or on one
// that can be moved itself.
bool canBeMoved(const Scene& scene, int body);

struct NamedFrame {
  std::string link;                                        // of the URDF
  std::string frame;                                       // tf
  Eigen::Isometry3d X_BL = Eigen::Isometry3d::Identity();  // link frame in the body frame
};

// tf frames of a body's links, ROOT/LINK, but for those that are the body's own: a body beyond a joint is called as the
// first of its links.
std::vector<NamedFrame> linkFrames(const Scene& scene, int body, const FrameNames& names);

// Bodies in Scene::bodies beyond the joints of these names. Throws RequestError with the field as the caller knows it:
// no joint, an unknown one, a prescribed one, one that is named twice.
std::vector<int> findJoints(const Scene& scene, const Robot& robot, const std::vector<std::string>& names,
                            const std::string& field);

// RequestError unless there is a finite number for each name.
void requireNumbers(const std::vector<double>& values, const std::vector<std::string>& names, const std::string& field);

}  // namespace monolith
