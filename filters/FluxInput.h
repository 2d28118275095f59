#pragma once

#include "vtkPieces.h"

#include "lbm/SteadyDiffusion.h"

#include <optional>
#include <string>
#include <vector>

class vtkImageData;
class vtkInformation;

/// What vtkFluxMap finds in its input; the same on every rank, whatever the pieces hold.
namespace lamella
{

/// The arrays of one solved direction; a name is empty where there is no such array.
struct SolvedDirection
{
  int axis = -1; ///< −1: to be found from the arrays
  std::string value;
  std::string flux;
  std::string suffix; ///< "", or "_x" ... as the names have it
};

struct FluxInput
{
  std::vector<SolvedDirection> directions;
  std::string quantity; ///< "temperature", "concentration" or another name
  bool periodic = false;
  bool transient = false; ///< a state in time, between values on the faces of its direction whatever the other sides
  std::optional<lbm::Stencil> stencil;
  std::string phaseArray;           ///< empty: no phases, or no conductivities
  std::vector<double> conductivity; ///< by phase id
};

/// Collective. Checks in the order present, at points, components, finite.
/// @param value,flux what SetInputArrayToProcess chose (may be null, then names are looked for)
/// @throws Error on every rank
[[nodiscard]] FluxInput fluxInput(vtkImageData* piece, vtkInformation* value, vtkInformation* flux, const Team& team);

} // namespace lamella
