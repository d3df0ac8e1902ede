#include "dem/contact_rule.hpp"
#include <algorithm>

namespace trigrain {
namespace {

void keep_all(const Particles&, std::vector<Contact>&, std::size_t) {}

/// The deepest contact per pair of connected pieces; among equals the first. Features become the pieces' numbers.
void keep_nearest(const Particles& p, std::vector<Contact>& contacts, std::size_t first) {
  const auto piece = [&](int body, int triangle) { return p.is_sphere(body) ? 0 : p.mesh[body]->part[triangle]; };
  std::size_t end = first;
  for (std::size_t c = first; c < contacts.size(); ++c) {
    Contact contact = contacts[c];
    contact.feature_a = piece(contact.a, contact.feature_a);
    contact.feature_b = piece(contact.b, contact.feature_b);
    const auto same = std::find_if(contacts.begin() + first, contacts.begin() + end, [&](const Contact& k) {
      return k.feature_a == contact.feature_a && k.feature_b == contact.feature_b;
    });
    if (same == contacts.begin() + end)
      contacts[end++] = contact;
    else if (contact.overlap > same->overlap)
      *same = contact;
  }
  contacts.resize(end);
  std::sort(contacts.begin() + first, contacts.end(), [](const Contact& l, const Contact& r) {
    return l.feature_a != r.feature_a ? l.feature_a < r.feature_a : l.feature_b < r.feature_b;
  });
}

constexpr ContactRule table[] = {
    {"all-pairs", "every touching triangle pair is a contact (Krestenitis 2018)", keep_all},
    {"nearest", "one contact per pair of connected surface pieces, where they are closest", keep_nearest},
};

} // namespace

std::span<const ContactRule> contact_rules() { return table; }

} // namespace trigrain
