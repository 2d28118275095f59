#pragma once

#include "Furniture.h"
#include "Palette.h"
#include "PlaneField.h"
#include "SnapshotOptions.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;

namespace lamella::rendering
{

/// The field to draw: found in the data, checked, and turned into numbers, their range and colours.
struct Quantity
{
  int preset = 0;
  vtkDataArray* array = nullptr;
  bool onCells = false; ///< polygonal data only

  // A quantity has values; phases and grains have ids (places in `idColors`, −1: undefined).
  std::vector<float> values;
  const ColorMap* map = nullptr;
  double low = 0;
  double high = 1;
  bool logarithmic = false; ///< values, low and high are powers of ten
  bool below = false;
  bool above = false;
  std::string title;
  std::string unit;

  std::vector<std::int32_t> ids;
  std::vector<Color> idColors;
  std::vector<std::string> idNames; ///< empty for an id that does not occur; grains have no names
  std::vector<bool> idIsVoid;

  bool hasUndefined = false;

  [[nodiscard]] bool IsCategorical() const { return !this->idColors.empty(); }
  [[nodiscard]] std::size_t Count() const { return this->IsCategorical() ? this->ids.size() : this->values.size(); }
  /// `low` and `high` in the numbers that the legend shows.
  [[nodiscard]] std::array<double, 2> LegendRange() const;
  /// Colour of one point or cell.
  [[nodiscard]] Color ColorOf(std::size_t index) const;

private:
  mutable std::vector<Color> Table;
};

/// @param size number of points along each axis, for grains; 0s for data that are no lattice
/// @throws InputError: array missing (lists those present), wrong association, component, range, no finite value
[[nodiscard]] Quantity FindQuantity(vtkDataSet* data, const std::array<int, 3>& size, const SnapshotOptions& options);

/// Legend and colour bar of a quantity.
[[nodiscard]] Furniture Describe(const Quantity& quantity, const SnapshotOptions& options);

} // namespace lamella::rendering
