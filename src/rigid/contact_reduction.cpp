#include "rigid/contact_reduction.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace monolith {
namespace {

// rad. A contact that lies no higher above the lowest than its distance from those kept times this may close by a small
// rotation; one further up counts as so much nearer. Else the far rim of a round body, which is in reach but cannot
// touch yet, takes the places of those that carry it.
constexpr double kSmallRotation = 0.05;

}  // namespace

void mergeCoincident(std::vector<Contact>& contacts, double distance) {
  std::vector<Contact> kept;
  for (const Contact& contact : contacts) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const Contact& other) {
      // On either: what spans the periods of the tank is touched by all images of the other in the same way.
      const double at_a = (other.point - contact.point).squaredNorm();
      const double at_b = (other.pointOnB() - contact.pointOnB()).squaredNorm();
      return other.body_a == contact.body_a && other.body_b == contact.body_b &&
             std::min(at_a, at_b) <= distance * distance && other.normal.dot(contact.normal) > 0.9;
    });
    if (same == kept.end()) {
      kept.push_back(contact);
    } else if (contact.gap < same->gap) {
      *same = contact;
    }
  }
  contacts = std::move(kept);
}

void reduceContacts(std::vector<Contact>& contacts, int most) {
  const int count = static_cast<int>(contacts.size());
  if (count <= most) return;
  std::vector<int> by_gap(count);
  std::iota(by_gap.begin(), by_gap.end(), 0);
  std::stable_sort(by_gap.begin(), by_gap.end(), [&](int i, int j) { return contacts[i].gap < contacts[j].gap; });
  std::vector<char> keep(count, 0);
  std::vector<double> nearest(count, std::numeric_limits<double>::max());
  const auto take = [&](int i) {
    keep[i] = 1;
    for (int j = 0; j < count; ++j) {
      nearest[j] = std::min(nearest[j], (contacts[j].point - contacts[i].point).norm());
    }
  };
  const double lowest = contacts[by_gap.front()].gap;
  const auto reach = [&](int i) { return nearest[i] - (contacts[i].gap - lowest) / kSmallRotation; };
  // Flat contact has no deepest point: then all but the first go by distance.
  const int deepest = std::max(1, most / 4);
  const double spread_of_gaps = contacts[by_gap.back()].gap - contacts[by_gap.front()].gap;
  for (int k = 0; k < deepest; ++k) {
    if (k == 0 || contacts[by_gap[most]].gap - contacts[by_gap[k]].gap > 1e-3 * spread_of_gaps + 1e-12) {
      take(by_gap[k]);
    }
  }
  int taken = static_cast<int>(std::count(keep.begin(), keep.end(), 1));
  while (taken < most) {
    int farthest = -1;
    for (const int i : by_gap) {
      // Ties within round-off go to the earlier one.
      if (!keep[i] && (farthest < 0 || reach(i) > reach(farthest) + 1e-9 * nearest[farthest])) farthest = i;
    }
    take(farthest);
    ++taken;
  }
  std::vector<Contact> kept;
  for (int i = 0; i < count; ++i)
    if (keep[i]) kept.push_back(contacts[i]);
  contacts = std::move(kept);
}

}  // namespace monolith
