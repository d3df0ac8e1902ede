#pragma once

namespace trigrain {

/// Three coordinates whose scalar may be double, float or a pack of lanes; the kernels' only vector type.
/// (Eigen, which the engine uses, costs packs of lanes 20-30 % in these formulas.)
template <class T> struct Vec3 { T x, y, z; };

template <class T> [[gnu::always_inline]] constexpr Vec3<T> operator+(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T> [[gnu::always_inline]] constexpr Vec3<T> operator-(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T> [[gnu::always_inline]] constexpr Vec3<T> operator*(const T& s, const Vec3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T> [[gnu::always_inline]] constexpr T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T> [[gnu::always_inline]] constexpr Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

} // namespace trigrain
