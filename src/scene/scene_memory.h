#pragma once
// How much memory a scene needs, and how much there is. Bytes.

#include <string>

#include "scene/scene.h"

namespace monolith {

// About, at the peak of a step of a scene with liquid.
double neededMemory(const Scene& scene);

// The machine's, or less where a control group, as that of a container, has a limit.
double usableMemory();

// The least limit of the control groups that a process is in; infinite if there is none. mounted: the folder
// with their files, of version 1 or 2; own: the file that names those of the process, as in /proc/self/cgroup.
double memoryLimit(const std::string& mounted, const std::string& own);

}  // namespace monolith
