#pragma once

#include "packing/Bridges.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

/// Internal: what lines along x meet in a cemented packing.
namespace lamella::packing
{

struct Section
{
  double low = 0; ///< x [m], within the box
  double high = 0;
  std::int32_t grain = 0; ///< its number from 0
};

/// Grains and bridges on one line, each sorted by where it begins. Sections may overlap.
struct LineSections
{
  std::vector<Section> grains;
  std::vector<Section> bridges;
};

/// Calls `visit(row, plane, sections)` for the lines at y = rows[row], z = planes[plane] (2D: y = planes[plane], one
/// row), plane after plane, rows rising.
void forEachLine(const Packing& packing, std::span<const Bridge> bridges, double width, std::span<const double> rows,
  std::span<const double> planes,
  const std::function<void(std::size_t row, std::size_t plane, const LineSections&)>& visit);

} // namespace lamella::packing
