#pragma once
// How a solve, and the step that it was for, ended.

namespace monolith {

enum class SolveStatus { kNotRun, kConverged, kNotConverged, kInconsistent };

const char* toString(SolveStatus status);

}  // namespace monolith
