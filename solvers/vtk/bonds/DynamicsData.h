#pragma once

#include "BondScene.h"

#include "peridynamics/fracture/DynamicsStudy.h"

class vtkImageData;
class vtkPolyData;
class vtkTable;

/// Outputs of a sample in motion. Not installed.
namespace lamella
{

/// A word for the command line, for files and for Python.
[[nodiscard]] const char* wordOf(peridynamics::MotionEnd end);

/// One vertex a broken bond; arrays as vtkBondDynamics says, its field data not.
void setBrokenBonds(
  vtkPolyData* output, const peridynamics::DynamicsResult& result, const BondScene& scene, const char* creator);

/// The history's columns.
void setHistory(vtkTable* output, const peridynamics::DynamicsResult& result, int dimension, const char* creator);

/// What was found, as field data: all that does not depend on the state.
void setDynamicsNumbers(vtkImageData* output, const peridynamics::DynamicsResult& result);

/// A state's point data and numbers. Collective.
void setMotionState(
  vtkImageData* output, const peridynamics::MotionState& state, const BondScene& scene, const char* creator);

} // namespace lamella
