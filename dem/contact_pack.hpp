#pragma once
#include "dem/contact.hpp"
#include "dem/vectors.hpp"
#include <algorithm>
#include <span>

namespace trigrain {

/// Up to lane_count contacts, of which each lane holds one; lanes beyond the last repeat it.
struct ContactPack {
  std::span<const Contact> contacts;
  LanesFrom<Contact> each;

  explicit ContactPack(std::span<const Contact> of) : contacts(of), each(lanes_from(of.data(), size())) {}
  int size() const { return static_cast<int>(contacts.size()); }
  /// get(contact) of each.
  template <class Get> Lanes numbers(const Get& get) const { return gather(each, get); }
  /// The same of vectors, which get() returns by reference.
  template <class Get> Vec3<Lanes> vectors(const Get& get) const { return gather_vectors(each, get); }
  Lanes overlap() const {
    return numbers([](const Contact& c) { return c.overlap; });
  }
  Lanes share() const {
    return numbers([](const Contact& c) { return c.share; });
  }
  Lanes mass() const {
    return numbers([](const Contact& c) { return c.mass; });
  }
  Vec3<Lanes> normal() const {
    return vectors([](const Contact& c) -> auto& { return c.normal; });
  }
  Vec3<Lanes> push() const {
    return vectors([](const Contact& c) -> auto& { return c.push; });
  }

  /// What moves with A at the contact against what moves with B (m/s); from the places (m), velocities (m/s) and
  /// angular velocities (rad/s) of all bodies.
  Vec3<Lanes> relative_velocity(std::span<const Eigen::Vector3d> position, std::span<const Eigen::Vector3d> velocity,
                                std::span<const Eigen::Vector3d> angular_velocity) const {
    const Vec3<Lanes> point = vectors([](const Contact& c) -> auto& { return c.point; });
    const auto of_body = [&](auto body) {
      const auto gathered = [&](std::span<const Eigen::Vector3d> column) {
        LanesFrom<Eigen::Vector3d> from;
        for (int lane = 0; lane < lane_count; ++lane) from[lane] = &column[each[lane]->*body];
        return gather_vectors(
            from, [](const Eigen::Vector3d& v) -> auto& { return v; });
      };
      return gathered(velocity) + cross(gathered(angular_velocity), point - gathered(position));
    };
    return of_body(&Contact::a) - of_body(&Contact::b);
  }
};

/// Calls visit(first, pack) for all contacts, a pack of those from `first` on at a time.
template <class Visit> void for_packs(std::span<const Contact> contacts, const Visit& visit) {
  for (std::size_t first = 0; first < contacts.size(); first += lane_count)
    visit(first, ContactPack(contacts.subspan(first, std::min<std::size_t>(lane_count, contacts.size() - first))));
}

} // namespace trigrain
