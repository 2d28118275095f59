#pragma once

#include "CrackInput.h"
#include "CrackSample.h"

#include "cracks/CrackSurface.h"
#include "cracks/ThroughPath.h"

#include <span>
#include <string>

class vtkPolyData;
class vtkTable;

/// Helpers of vtkCrackPath; not installed.
namespace lamella
{

/// What turns places and lengths of the lattice into metres, and numbers of phases into names.
struct CrackScale
{
  const CrackInput& input;
  std::vector<std::string> phases;              ///< by id
  bool opening = false;                         ///< openings are known
  std::array<cracks::ThroughPath, 2> through{}; ///< along x, y

  [[nodiscard]] double metres(double spacings) const { return spacings * input.lattice.spacing; }
  /// "wall" within a phase, "wall-lamella" of two; between two grains "wall-wall" and "wall-lamella (grains)".
  [[nodiscard]] std::string pair(const cracks::PairShare& share) const;
};

/// One poly-line a path; paths that meet share a point.
void fillCrackPaths(vtkPolyData* output, const cracks::CrackPaths& paths, const CrackScale& scale);

/// Of the surfaces in a volume [spacings²].
struct CrackAreas
{
  double all = 0;
  double main = 0;                      ///< of crack 1
  std::vector<cracks::PairShare> pairs; ///< their length is an area
};
/// Triangles, one row a crack, and one row an event at which surfaces grew.
[[nodiscard]] CrackAreas fillCrackSurfaces(
  vtkPolyData* output, vtkTable* table, vtkTable* growth, const cracks::CrackSurface& surface, const CrackScale& scale);

/// One row a path.
void fillPathTable(vtkTable* table, const cracks::CrackPaths& paths, const CrackScale& scale);

/// One row a pair of phases that a crack runs through or that broken bonds join.
/// @param found, all lengths of paths, in space areas of surfaces
/// @param counted of all broken bonds
void fillPairTable(vtkTable* table, std::span<const cracks::PairShare> found, double all,
  std::span<const cracks::PairShare> counted, const CrackScale& scale);

/// One row an event at which a path grew.
void fillGrowthTable(vtkTable* table, const cracks::CrackPaths& paths, const CrackScale& scale);

/// One row a fragment.
void fillFragmentTable(vtkTable* table, const CrackFragments& fragments, const Lattice& lattice);

} // namespace lamella
