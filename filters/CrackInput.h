#pragma once

#include "vtkPieces.h"

#include "cracks/CutBond.h"

#include <string>
#include <vector>

class vtkPolyData;

/// Helpers of vtkCrackPath; not installed.
namespace lamella
{

/// What vtkCrackPath finds in the broken bonds; the same on every rank, whatever the pieces hold.
struct CrackInput
{
  Lattice lattice;
  double horizon = 0; ///< [spacings]
  std::vector<cracks::CutBond> bonds;
  std::vector<std::string> phases; ///< names by id; empty where bonds do not tell their phases
  std::string when;                ///< the array that CutBond::when is from: strain, time or event
};

/// Collective. Checks in the order present, at points, components, finite, on the lattice.
/// @param horizon 0: the field data `horizon`
/// @throws Error on every rank
[[nodiscard]] CrackInput crackInput(vtkPolyData* piece, double horizon, const Team& team);

} // namespace lamella
