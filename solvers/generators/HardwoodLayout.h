#pragma once

#include "core/Random.h"
#include "generators/CellGeometry.h"
#include "generators/Generators.h"

#include <cstdint>
#include <span>
#include <vector>

/// The cross-section of a hardwood as polygons. All lengths are in mean fibre diameters, whatever the lattice; x is
/// radial, y tangential, (0, 0) the box's corner.
namespace lamella::generators
{

/// A cell seen along its axis: a convex polygon. Side i runs from corner i to the next one.
struct ConvexCell : PolygonPlace
{
  CellKind kind = CellKind::Fibre;
  std::uint32_t first = 0; ///< of its corners and sides
  std::uint32_t count = 0;
  double fillet = 0;    ///< radius of the lumen's corners
  double depth = 0;     ///< wallDepth() at its centre
  double thickness = 1; ///< of its wall relative to a fibre's at the start of the ring
};

class HardwoodLayout
{
public:
  explicit HardwoodLayout(const HardwoodOptions& options);

  [[nodiscard]] std::span<const ConvexCell> cells() const noexcept { return cells_; }
  [[nodiscard]] std::span<const CellSide> sides(const ConvexCell& cell) const noexcept
  {
    return { sides_.data() + cell.first, cell.count };
  }
  [[nodiscard]] std::span<const Corner> corners(const ConvexCell& cell) const noexcept
  {
    return { corners_.data() + cell.first, cell.count };
  }
  [[nodiscard]] double width() const noexcept { return width_; }
  [[nodiscard]] double height() const noexcept { return height_; }
  /// Share of the box that lies in vessels, out to the middle of their walls.
  [[nodiscard]] double vesselShare() const;

private:
  struct Site;
  struct Band;
  [[nodiscard]] double lateness(double x) const noexcept;
  [[nodiscard]] double shareWanted() const noexcept;
  void lay(double swelling);
  void layRayLines();
  void layVessels(Band& band, double swelling) const;
  void layFibres(Band& band) const;
  void relax(Band& band) const;
  void polygonOf(const Band& band, std::size_t site, std::vector<Corner>& polygon, std::vector<Corner>& spare) const;
  void addBand(Band& band);
  void addRay(std::size_t number);
  void addCell(CellKind kind, std::span<const Corner> polygon, double thickness);
  [[nodiscard]] std::array<double, 2> warped(double x, double y) const noexcept;

  Random random_;
  double width_, height_;
  double vesselEarly_, vesselLate_; ///< tangential radii
  double shareEarly_, shareLate_;
  double earlyEnd_, multiples_;
  double ring0_, ring1_;
  double rayEvery_, rayHalf_;
  double scatter_;
  double disorder_; ///< scatter over its default: scales every other irregularity
  double margin_;   ///< how far the tissue goes on beyond the box before it is cut
  std::vector<double> rayLines_;
  std::vector<ConvexCell> cells_;
  std::vector<Corner> corners_;
  std::vector<CellSide> sides_;
};

} // namespace lamella::generators
