#pragma once

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace lamella::pores
{

/// Vectors of millions that are written anyway are not filled with zeros before.
template <typename Value>
struct Unfilled : std::allocator<Value>
{
  template <typename Other>
  struct rebind
  {
    using other = Unfilled<Other>;
  };
  template <typename Other>
  void construct(Other* place) noexcept
  {
    ::new (static_cast<void*>(place)) Other;
  }
  template <typename Other, typename... Arguments>
  void construct(Other* place, Arguments&&... arguments)
  {
    std::construct_at(place, std::forward<Arguments>(arguments)...);
  }
};
template <typename Value>
using UnfilledVector = std::vector<Value, Unfilled<Value>>;

} // namespace lamella::pores
