#include "dem/contact_rule.hpp"
#include <algorithm>
#include <cmath>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Contacts = std::vector<Touch>;

std::span<Touch> from(Contacts& contacts, std::size_t first) { return std::span(contacts).subspan(first); }

void set_springs(std::span<Touch> contacts) {
  for (Touch& c : contacts) c.push = c.overlap * c.normal;
}

/// Dashpots as published: each contact has the mass that the bodies have without turning.
void set_masses_of_bodies(const Particles& p, std::span<Touch> contacts) {
  for (Touch& c : contacts) c.mass = 1 / (p.inverse_mass[c.a] + p.inverse_mass[c.b]);
}

/// Inverse of the mass that resists the springs of contacts: their sum and its torque about the centre of body i
/// (1/kg).
double inverse_mass(const Particles& p, int i, const Vector3d& force, const Vector3d& torque) {
  if (p.fixed(i)) return 0;
  const double pushed = p.inverse_mass[i] * force.squaredNorm();
  if (p.is_sphere(i)) return pushed; // they point at its centre
  const Vector3d t = p.orientation[i].conjugate() * torque;
  return pushed + t.cwiseQuotient(p.inertia[i]).dot(t);
}

} // namespace

/// The springs of a pair hold k s^2 / 2 with s^2 = sum share overlap^2. Along s the pair is one spring of stiffness k;
/// dashpots for the effective mass along s give every contact the damping ratio that was asked for: one corner far from
/// the centre of mass, an edge, or a face on all its corners.
void set_collective_mass(const Particles& p, std::span<Touch> contacts) {
  const int a = contacts.front().a, b = contacts.front().b;
  Vector3d force = Vector3d::Zero(), torque_a = force, torque_b = force;
  double s2 = 0;
  for (const Touch& c : contacts) {
    const Vector3d f = c.share * c.overlap * c.normal;
    s2 += c.share * c.overlap * c.overlap;
    force += f;
    torque_a += (c.point - p.position[a]).cross(f);
    torque_b += (c.point - p.position[b]).cross(f);
  }
  const double mass = s2 / (inverse_mass(p, a, force, torque_a) + inverse_mass(p, b, force, torque_b));
  for (Touch& c : contacts) c.mass = mass;
}

void settle_pieces(const Particles& p, std::span<Touch> contacts) {
  if (contacts.size() > 1) std::sort(contacts.begin(), contacts.end(), by_features);
  set_springs(contacts);
  set_collective_mass(p, contacts);
}

bool by_features(const Touch& l, const Touch& r) {
  return l.feature_a != r.feature_a ? l.feature_a < r.feature_a : l.feature_b < r.feature_b;
}

namespace {

void keep_all(const Particles& p, Contacts& contacts, std::size_t first) {
  set_springs(from(contacts, first));
  set_masses_of_bodies(p, from(contacts, first));
}

double shortest_edge(const Particles& p, int body, int triangle) {
  if (p.is_sphere(body)) return p.radius[body];
  const auto& x = p.mesh[body]->vertices;
  const auto& f = p.mesh[body]->faces[triangle];
  return std::min({(x[f[1]] - x[f[0]]).norm(), (x[f[2]] - x[f[1]]).norm(), (x[f[0]] - x[f[2]]).norm()});
}

/// Deepest first, leaves out what is nearer to a contact that is kept than the shortest edge of its own triangles.
void drop_close_ones(const Particles& p, Contacts& contacts, std::size_t first) {
  std::stable_sort(contacts.begin() + first, contacts.end(),
                   [](const Touch& l, const Touch& r) { return l.overlap > r.overlap; });
  std::size_t end = first;
  for (std::size_t c = first; c < contacts.size(); ++c) {
    const Touch contact = contacts[c];
    const double h =
        std::min(shortest_edge(p, contact.a, contact.feature_a), shortest_edge(p, contact.b, contact.feature_b));
    const bool repeated = std::any_of(contacts.begin() + first, contacts.begin() + end, [&](const Touch& kept) {
      return (kept.point - contact.point).squaredNorm() < h * h;
    });
    if (!repeated) contacts[end++] = contact;
  }
  contacts.resize(end);
  std::sort(contacts.begin() + first, contacts.end(), by_features);
  set_springs(from(contacts, first));
  set_masses_of_bodies(p, from(contacts, first));
}

/// The deepest contact per pair of connected pieces; among equals the first. Features become the pieces' numbers.
void keep_nearest(const Particles& p, Contacts& contacts, std::size_t first) {
  const auto piece = [&](int body, int triangle) { return p.is_sphere(body) ? 0 : p.mesh[body]->part[triangle]; };
  std::size_t end = first;
  for (std::size_t c = first; c < contacts.size(); ++c) {
    Touch contact = contacts[c];
    contact.feature_a = piece(contact.a, contact.feature_a);
    contact.feature_b = piece(contact.b, contact.feature_b);
    const auto same = std::find_if(contacts.begin() + first, contacts.begin() + end, [&](const Touch& k) {
      return k.feature_a == contact.feature_a && k.feature_b == contact.feature_b;
    });
    if (same == contacts.begin() + end)
      contacts[end++] = contact;
    else if (contact.overlap > same->overlap)
      *same = contact;
  }
  contacts.resize(end);
  settle_pieces(p, from(contacts, first));
}

constexpr ContactRule table[] = {
    {"all-pairs", "every touching triangle pair is a contact (Krestenitis 2018)", false, false, keep_all},
    {"dedupe", "the same without those nearer to a deeper one than their shortest edge (Krestenitis 2018)", false,
     false, drop_close_ones},
    {"nearest", "one contact per pair of connected surface pieces, where they are closest", false, true, keep_nearest},
    {"features", "corners against the other body, edges against edges, however faces are cut; curved bodies as nearest",
     true, true, keep_nearest},
};

} // namespace

std::span<const ContactRule> contact_rules() { return table; }

} // namespace trigrain
