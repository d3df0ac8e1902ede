#pragma once
#include <cstddef>
#include <new>
#include <vector>

namespace trigrain {

inline constexpr std::size_t cache_line = 64; ///< bytes; a register of AVX-512 is as wide

/// Memory that begins at a cache line, so that whole packs of it do not lie across two of them: such a load or store
/// takes twice as long.
template <class T> struct LineAllocator {
  using value_type = T;
  static constexpr std::align_val_t line{cache_line};

  LineAllocator() = default;
  template <class U> LineAllocator(const LineAllocator<U>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), line)); }
  void deallocate(T* memory, std::size_t) { ::operator delete(memory, line); }
  friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};

/// One column of a structure of arrays.
template <class T> using Column = std::vector<T, LineAllocator<T>>;

} // namespace trigrain
