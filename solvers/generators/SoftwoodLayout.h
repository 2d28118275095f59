#pragma once

#include "core/Random.h"
#include "generators/CellGeometry.h"
#include "generators/Generators.h"

#include <span>
#include <vector>

/// The cross-section of a softwood as polygons: what the tissue is before it is put on a lattice.
/// All lengths are in nodes (metres over the spacing); x is radial, y tangential, z along the tracheids.
namespace lamella::generators
{

inline constexpr double softwoodRayThickness = 0.75; ///< of a ray cell's wall, over a tracheid's
inline constexpr double softwoodRayCell = 2.6;       ///< length of a ray cell in tracheids of the same place
inline constexpr double softwoodRayFillet = 0.4;     ///< radius of its corners over the ray's half width

/// A tracheid seen along its axis: a convex polygon.
struct CellShape : PolygonPlace
{
  std::uint32_t firstSide = 0;
  std::uint32_t sides = 0;
  std::int64_t file = 0;   ///< which radial file
  std::int64_t number = 0; ///< which cell in it
  double fillet = 0;       ///< radius of the lumen's corners
  double depth = 0;        ///< wallDepth() at its centre: about the radius of the largest circle inside
  double thickness = 1;    ///< thickness of its wall relative to earlywood's
};

class SoftwoodLayout
{
public:
  explicit SoftwoodLayout(const SoftwoodOptions& options);

  [[nodiscard]] std::span<const CellShape> cells() const noexcept { return cells_; }
  [[nodiscard]] std::span<const CellSide> sides(const CellShape& cell) const noexcept
  {
    return { sides_.data() + cell.firstSide, cell.sides };
  }
  [[nodiscard]] std::size_t rays() const noexcept { return rayLines_.size(); }
  [[nodiscard]] double rayHalfWidth() const noexcept { return rayHalfWidth_; }

  /// 0 in earlywood, 1 in latewood, smooth between.
  [[nodiscard]] double lateness(double x) const noexcept;
  /// Thickness of the walls at x relative to earlywood's.
  [[nodiscard]] double thickness(double x) const noexcept;
  /// Radial diameter of the tracheids at x.
  [[nodiscard]] double radialDiameter(double x) const noexcept;
  /// Where the walls between the cells of a file stand when `step` tracheids go to one cell: rising, from before the
  /// box to beyond it. `salt` tells files apart.
  [[nodiscard]] std::vector<double> crossWalls(double step, std::int64_t salt) const;

private:
  struct Site;
  void layColumns();
  void layRays();
  void layFiles();
  void layTips(std::vector<Site>& sites, std::int64_t band);
  void cutPolygons(std::span<const Site> sites, std::size_t band);
  void addCell(const Site& site, std::span<const Corner> polygon);
  [[nodiscard]] double columnAt(double number) const noexcept;
  [[nodiscard]] std::array<double, 2> warped(double x, double y) const noexcept;

  Random random_;
  double width_, height_;            ///< of the box
  double tangential_, early_, late_; ///< diameters
  double ring0_, ring1_;
  double rayEvery_, rayHalfWidth_;
  double scatter_;               ///< relative standard deviation
  double disorder_;              ///< scatter over its default: scales every other irregularity
  double stretch_;               ///< metric of the power diagram: tangential over radial
  std::vector<double> columns_;  ///< x of cell number 0, 1, 2 … of an undisturbed file
  std::vector<double> rayLines_; ///< y of the rays' centre lines, rising; the first and last are outside the box
  std::vector<CellShape> cells_;
  std::vector<CellSide> sides_;
};

} // namespace lamella::generators
