#pragma once

#include <cstddef>
#include <new>

namespace lamella
{

/// For containers whose first element starts a cache line, so that vectors of lanes do not straddle two.
template <class T>
struct AlignedAllocator
{
  using value_type = T;
  static constexpr std::align_val_t line{ 64 };

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>& /*other*/) noexcept
  {
  }
  [[nodiscard]] T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), line)); }
  void deallocate(T* p, std::size_t /*count*/) noexcept { ::operator delete(p, line); }
  friend bool operator==(const AlignedAllocator& /*a*/, const AlignedAllocator& /*b*/) noexcept { return true; }
};

} // namespace lamella
