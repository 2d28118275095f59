#pragma once

#include "BondScene.h"
#include "FieldNumbers.h"

#include "vtkFieldData.h"
#include "vtkImageData.h"

#include <array>
#include <string>

/// What solvers on bonds say alike of their results. Not installed.
namespace lamella
{

/// Displacement [m] as point data, the active vectors. Collective.
void addDisplacement(vtkImageData* output, const BondScene& scene, const peridynamics::NodeField<double>& displacement,
  const char* creator);

/// Strain energy [J/m³] as point data. Collective.
VTKLAMELLASOLVERSVTK_EXPORT void addStrainEnergy(
  vtkImageData* output, const BondScene& scene, const peridynamics::NodeField<double>& energy, const char* creator);

/// What is found from a displacement.
struct Measures
{
  bool stress = false;
  bool energy = false;
  bool largeStrains = false;
};
/// Those that a state carries, of this rank's own nodes. Collective.
/// @throws InputError where it carries none
void displacementsOf(
  vtkImageData* state, const BondScene& scene, peridynamics::NodeField<double>& displacement, const Team& team);
/// Adds stress and strain energy to a state that carries its displacement. Collective.
void addMeasures(vtkImageData* state, const BondScene& scene, const peridynamics::BondLattice& bonds,
  const Measures& measures, const char* creator, const Team& team);

/// Takes a point array out of the output again; one that the input has by that name takes its place.
void leaveOut(vtkImageData* output, vtkImageData* input, const char* name);

/// Vectors at the nodes of a piece.
struct NodeVectors
{
  vtkDataArray* array = nullptr; ///< null where the piece is empty
  std::string name;
};

/// Collective. The point array that `choice` (vtkAlgorithm::GetInputArrayInformation) names, or `otherwise`.
/// @param whence words for the hint where there is none
/// @throws InputError on every rank where it is missing or has no such number of components
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT NodeVectors vectorsOf(vtkImageData* piece, vtkInformation* choice,
  const char* otherwise, const char* whence, int dimension, const Team& team);

/// What a study visited and what it skipped, and its warnings, as field data.
/// @param r with solidNodes, nodes, bonds, strips, bytes, warnings
template <class Result>
void setWork(vtkImageData* output, const Result& r)
{
  const auto whole = [](auto n) { return static_cast<double>(n); };
  setFieldNumber(output, "solid_nodes", whole(r.solidNodes));
  setFieldNumber(output, "skipped_nodes", whole(r.nodes - r.solidNodes));
  setFieldNumber(output, "bonds", whole(r.bonds));
  setFieldNumbers(output, "visited_strips", std::array{ whole(r.strips.uniform), whole(r.strips.mixed) });
  setFieldNumber(output, "skipped_strips", whole(r.strips.empty));
  setFieldNumber(output, "bytes", whole(r.bytes));
  setFieldTexts(output, "warnings", r.warnings);
}

/// Which layers platens hold, as field data.
/// @param r with axis, lowPlaten, highPlaten
template <class Result>
void setPlatenLayers(vtkImageData* output, const Result& r)
{
  const auto whole = [](auto n) { return static_cast<double>(n); };
  setFieldText(output, "load_axis", std::string(1, "xyz"[r.axis]));
  setFieldNumbers(output, "platen_layers",
    std::array{ whole(r.lowPlaten[0]), whole(r.lowPlaten[1] - 1), whole(r.highPlaten[0]), whole(r.highPlaten[1] - 1) });
}

/// Where platens hold a sample, and what they do not hold, as field data.
/// @param r with axis, area, length, lowPlaten, highPlaten, loosePieces, looseNodes
template <class Result>
void setPlatens(vtkImageData* output, const Result& r)
{
  setPlatenLayers(output, r);
  setFieldNumber(output, "section_area", r.area);
  setFieldNumber(output, "gauge_length", r.length);
  setFieldNumber(output, "loose_pieces", static_cast<double>(r.loosePieces));
  setFieldNumber(output, "loose_nodes", static_cast<double>(r.looseNodes));
}

/// What a pressure acts in, as field data; what an image has of it from before goes.
/// @param r with poreVolume, openNodes
template <class Result>
void setPores(vtkImageData* output, const Result& r)
{
  for (const char* const name : { "pore_volume", "open_pore_nodes" })
    output->GetFieldData()->RemoveArray(name);
  if (!(r.poreVolume > 0))
    return;
  setFieldNumber(output, "pore_volume", r.poreVolume);
  setFieldNumber(output, "open_pore_nodes", static_cast<double>(r.openNodes));
}

} // namespace lamella
