#pragma once
// Fewer contacts for the same support. Both keep the given order and depend on nothing else.

#include <vector>

#include "rigid/contact.h"

namespace monolith {

// Of contacts of the same bodies closer than `distance` (m) on one of them whose normals agree within 25 degrees keeps
// the deepest, in the place of the first.
void mergeCoincident(std::vector<Contact>& contacts, double distance);

// Keeps at most `most`: the deepest quarter of them, and those farthest from the ones already kept, of such as a small
// rotation could close.
void reduceContacts(std::vector<Contact>& contacts, int most);

}  // namespace monolith
