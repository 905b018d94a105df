#include "simulation/contact_laws.h"

#include <algorithm>

namespace monolith {
namespace {

struct Surface {
  std::string body, material;
};

// How well a name of the description fits: 2 by body, 1 by material, 0 not at all.
int fit(const std::string& name, const Surface& s) {
  if (name == s.body) return 2;
  return !s.material.empty() && name == s.material ? 1 : 0;
}

}  // namespace

ContactLaws::ContactLaws(const Scene& scene) : bodies_(scene.bodies.size()) {
  std::vector<Surface> surfaces;
  for (const BodyDescription& body : scene.bodies) surfaces.push_back({body.name, body.material});
  surfaces.push_back({kWallsName, ""});
  for (const Surface& a : surfaces) {
    for (const Surface& b : surfaces) {
      ContactLaw law{scene.contact.friction, scene.contact.restitution};
      int best = 0;
      for (const auto& pair : scene.contact.pairs) {
        const int straight = fit(pair.a, a) * fit(pair.b, b);
        const int crossed = fit(pair.a, b) * fit(pair.b, a);
        const int score = std::max(straight, crossed);
        if (score <= best) continue;
        best = score;
        law = {pair.friction, pair.restitution};
      }
      table_.push_back(law);
    }
  }
}

const ContactLaw& ContactLaws::of(int body_a, int body_b) const {
  const auto place = [&](int body) { return body == Contact::kWall ? bodies_ : static_cast<std::size_t>(body); };
  return table_[place(body_a) * (bodies_ + 1) + place(body_b)];
}

std::vector<ContactLaw> ContactLaws::of(const std::vector<Contact>& contacts) const {
  std::vector<ContactLaw> out;
  for (const Contact& c : contacts) out.push_back(of(c.body_a, c.body_b));
  return out;
}

}  // namespace monolith
