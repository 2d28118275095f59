#pragma once

#include <cstdint>

namespace lamella::mpm
{

/// What both ends of an axis are while the whole box is strained a little.
enum class BoxSides : std::uint8_t
{
  Walls,       ///< straight walls that follow the box's strain and let slide
  StickyWalls, ///< straight walls that hold what touches them: displacements of the box's strain
  Open,        ///< free
  Periodic
};

} // namespace lamella::mpm
