#pragma once
// Which contact law holds between which bodies, from the scene's description.

#include <vector>

#include "coupling/contact_rows.h"
#include "scene/scene.h"

namespace monolith {

class ContactLaws {
 public:
  explicit ContactLaws(const Scene& scene);
  // body indices, or Contact::kWall.
  const ContactLaw& of(int body_a, int body_b) const;
  std::vector<ContactLaw> of(const std::vector<Contact>& contacts) const;

 private:
  std::size_t bodies_ = 0;
  std::vector<ContactLaw> table_;  // (bodies + 1)^2, the walls last
};

}  // namespace monolith
