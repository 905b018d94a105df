#pragma once
// A vector in a message.

#include <Eigen/Core>
#include <sstream>
#include <string>

namespace monolith {

// "[x, y, z]", six digits each.
template <class Derived>
std::string shownVector(const Eigen::MatrixBase<Derived>& v) {
  std::ostringstream text;
  text << v.transpose().format(Eigen::IOFormat(6, Eigen::DontAlignCols, ", ", ", ", "", "", "[", "]"));
  return text.str();
}

}  // namespace monolith
