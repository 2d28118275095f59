#pragma once

#include "mpm/BackgroundGrid.h"
#include "mpm/BlockRows.h"
#include "mpm/BoxSides.h"
#include "mpm/MaterialPoints.h"
#include "mpm/PointLaw.h"
#include "mpm/ShapeFunctions.h"

#include "packing/BlockCholesky.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

/// Internal: the linear system behind PointStiffness.h.
namespace lamella::mpm
{

/// K w = f of material points at rest with quadratic splines on the background grid, for the displacement w that is
/// left when that of the box's strain is taken off: K = Σ V Bᵀ C B over the points. Beyond walls w is mirrored as
/// velocities are in GridWalls.h: odd across a wall along its normal, and along a sticky one; even along the others.
///
/// A field has Dim values a node of the grid, those beyond its ends included; `nodes` below are those that carry
/// something and are no image of another.
template <int Dim>
class PointSystem
{
public:
  static constexpr int strains = Dim == 3 ? 6 : 3;
  static constexpr int splines = Dim == 3 ? 27 : 9; ///< that a point lies within
  using Field = std::vector<double>;
  using Strain = std::array<double, strains>; ///< xx, yy, xy or xx, yy, zz, yz, xz, xy; shear strains as angles

  /// @param points within the grid; only their places, volumes, axes and phases count, not how they are deformed
  /// @param law linearised at F = I
  PointSystem(const MaterialPoints<Dim>& points, const PointLaw<Dim>& law, const BackgroundGrid<Dim>& grid,
    const std::array<BoxSides, Dim>& sides);

  /// f = K w. @param w values that are not its own (images, held by walls) are set first
  void apply(Field& w, Field& f) const;
  /// −Σ V Bᵀ C ε: what a strain of the whole box asks of w.
  [[nodiscard]] Field load(const Strain& strain) const;
  /// Σ V ε C ε' over all points [J], [J/m] in 2D.
  [[nodiscard]] double uniform(const Strain& first, const Strain& second) const;

  [[nodiscard]] const std::vector<std::int32_t>& nodes() const noexcept { return nodes_; }
  [[nodiscard]] std::size_t values() const noexcept { return static_cast<std::size_t>(grid_.count()) * Dim; }
  /// Diagonal blocks of K, by rows: Dim² a node of nodes(). Components that a wall holds have a row of zeros.
  [[nodiscard]] std::vector<double> diagonal() const;
  /// K between nodes(), unknowns scaled by `scale`, which has Dim a node. Components with a row of zeros get 1 on the
  /// diagonal.
  [[nodiscard]] packing::BlockMatrix<Dim> assemble(const std::vector<double>& scale) const;
  /// K between nodes(), both triangles, row by row. @param told asked now and then; throws to stop
  [[nodiscard]] BlockRows<Dim> rows(const std::function<void()>& told) const;
  /// Of a node of the grid: −1 … cells + 1 along each axis.
  [[nodiscard]] std::array<int, Dim> coordinates(std::int64_t node) const;
  /// Cells around a period, by axis; 0 where there is none.
  [[nodiscard]] const std::array<int, Dim>& periods() const noexcept { return periods_; }

private:
  void readPoints(const MaterialPoints<Dim>& points, const PointLaw<Dim>& law);
  void findImages(const std::array<BoxSides, Dim>& sides);
  [[nodiscard]] Strain stress(std::size_t p, const Strain& strain) const; ///< times the volume
  [[nodiscard]] std::array<AxisShape<3>, Dim> profiles(std::size_t p) const;
  [[nodiscard]] Strain strainAt(std::size_t p, const std::array<AxisShape<3>, Dim>& s, const Field& w) const;
  void scatter(std::size_t p, const std::array<AxisShape<3>, Dim>& s, const Strain& stress, Field& f) const;
  template <class Visit>
  void forEachRow(std::size_t p, const std::array<AxisShape<3>, Dim>& s, const Visit& visit) const;
  void fold(Field& f) const;
  template <class Visit>
  void forEachPoint(const Visit& visit) const;
  void addBlock(std::size_t p, std::vector<double>& to) const;
  template <class Add>
  void forEachBlock(std::size_t p, const Add& add) const;

  BackgroundGrid<Dim> grid_;
  std::array<int, Dim> periods_{};
  std::array<std::int64_t, splines> jumps_{};     // from a point's first node to all of its nodes
  std::vector<std::int64_t> base_;                // by point: its first node
  std::vector<std::array<double, Dim>> fraction_; // ½ … 3/2: how far behind its first node a point lies [spacings]
  std::vector<std::uint32_t> kind_;               // by point: which of stiffness_
  std::vector<double> stiffness_;                 // by kind: V C, its upper triangle by rows
  std::vector<std::size_t> rows_;                 // first point of each layer of cells along the last axis
  std::vector<std::int32_t> master_;              // by node of the grid: whose image it is; often its own
  std::vector<std::int8_t> sign_;                 // by value: of the image; 0 where a wall holds it
  std::vector<std::int32_t> images_;              // nodes that are not their own masters, or partly held
  std::vector<std::int32_t> nodes_;
  std::vector<std::int32_t> place_; // by node of the grid: in nodes_, or −1
};

extern template class PointSystem<2>;
extern template class PointSystem<3>;

} // namespace lamella::mpm
