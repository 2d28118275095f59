#pragma once

#include "BondScene.h"
#include "Columns.h"

#include "peridynamics/fracture/FractureStudy.h"
#include "statistics/ErrorParts.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <span>
#include <vector>

class vtkDataObject;
class vtkImageData;
class vtkPolyData;
class vtkTable;

/// A fracture's outputs. Not installed.
namespace lamella
{

/// Words for the command line, for files and for Python.
[[nodiscard]] const char* wordOf(peridynamics::FractureEnd end);
[[nodiscard]] const char* wordOf(peridynamics::FractureMethod method);
[[nodiscard]] const char* wordOf(peridynamics::Breaking breaking);

/// One vertex a bond. @return what adds arrays to them
Columns<peridynamics::Bond> setBonds(
  vtkPolyData* output, std::span<const peridynamics::Bond> bonds, const BondScene& scene, const char* creator);
/// Adds `bond`, `phases`, `between_grains`.
void addEnds(
  const Columns<peridynamics::Bond>& columns, std::span<const peridynamics::BondEnds> ends, const BondScene& scene);

/// One vertex a broken bond; arrays as vtkBondFracture says, its field data not.
void setBrokenBonds(
  vtkPolyData* output, const peridynamics::FractureResult& result, const BondScene& scene, const char* creator);

/// The curve's columns.
void setFractureCurve(vtkTable* output, const peridynamics::FractureResult& result, const char* creator);

/// What was found, as field data: all that does not depend on the state.
void setFractureNumbers(vtkImageData* output, const peridynamics::FractureResult& result);

/// What field data tell of the error of a strength: "window", "segmentation".
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::vector<statistics::ErrorPart> strengthErrorParts(vtkImageData* image);

/// `spacing` [m], `lattice_size`, `lattice_origin` [m]: 3 numbers each.
void setLatticeNumbers(vtkDataObject* output, const Lattice& lattice);

/// What all states of samples that break have as point data and numbers. Collective.
void setBrokenState(
  vtkImageData* output, const peridynamics::BrokenState& state, const BondScene& scene, const char* creator);

/// A state's point data and numbers. Collective.
void setFractureState(
  vtkImageData* output, const peridynamics::FractureState& state, const BondScene& scene, const char* creator);

} // namespace lamella
