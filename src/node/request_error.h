#pragma once
// Something asked of the running node that cannot be done. what() names the field, its value and what was expected;
// nothing has changed.

#include <stdexcept>

namespace monolith {

class RequestError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace monolith
