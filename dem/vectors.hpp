#pragma once
#include "kernels/column.hpp"
#include "kernels/lanes.hpp"
#include "kernels/vec3.hpp"
#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace trigrain {

/// Between the vectors of bodies and those of kernels.
inline Vec3<double> vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

/// What each lane of a pack is read from.
template <class T> using LanesFrom = std::array<const T*, lane_count>;
/// Of items[0], ..., items[count - 1]; lanes beyond repeat the last one.
template <class T> [[gnu::always_inline]] inline LanesFrom<T> lanes_from(const T* items, int count) {
  LanesFrom<T> from;
  for (int lane = 0; lane < lane_count; ++lane) from[lane] = items + std::min(lane, count - 1);
  return from;
}
/// The numbers get(item) of each.
template <class T, class Get> [[gnu::always_inline]] inline Lanes gather(const LanesFrom<T>& from, const Get& get) {
  return Lanes([&](auto lane) { return get(*from[lane]); });
}
/// The same of vectors, which get() returns by reference.
template <class T, class Get>
[[gnu::always_inline]] inline Vec3<Lanes> gather_vectors(const LanesFrom<T>& from, const Get& get) {
  const auto axis = [&](int d) { return gather(from, [&](const T& item) { return get(item)[d]; }); };
  return {axis(0), axis(1), axis(2)};
}
/// Calls set(lane, number) for the first `count` lanes.
template <class Set> [[gnu::always_inline]] inline void scatter(const Lanes& x, int count, const Set& set) {
  alignas(cache_line) std::array<double, lane_count> each;
  store(x, each.data());
  for (int lane = 0; lane < count; ++lane) set(lane, each[lane]);
}
template <class Set> [[gnu::always_inline]] inline void scatter(const Vec3<Lanes>& v, int count, const Set& set) {
  alignas(cache_line) std::array<double, 3 * lane_count> each;
  store(v.x, each.data()), store(v.y, each.data() + lane_count), store(v.z, each.data() + 2 * lane_count);
  for (int lane = 0; lane < count; ++lane)
    set(lane, Eigen::Vector3d(each[lane], each[lane + lane_count], each[lane + 2 * lane_count]));
}

} // namespace trigrain
