#pragma once

#include "DiffusionReport.h"
#include "OutputFile.h"
#include "Session.h"

#include <vtkDoubleArray.h>
#include <vtkSmartPointer.h>

#include <string>

namespace lamella::cli
{

/// Field and flux of one direction, whole, on rank 0; empty arrays on the others.
struct Fields
{
  vtkSmartPointer<vtkDoubleArray> value;
  vtkSmartPointer<vtkDoubleArray> flux;
};

/// Takes them from the solver after a solve, on all ranks, in the picture's sense: y runs from the top of a picture
/// (value 1) to its bottom (0).
[[nodiscard]] Fields takeFields(const Session& session, const lbm::SteadyDiffusion& solver, int axis,
  const Lattice& lattice, const Block& block, const std::string& quantity);

/// Writes them with the phases and all that is known about the answer to the file's temporary name; rank 0.
void writeFields(
  const DiffusionReport& report, const lbm::DiffusionAnswer& answer, Fields fields, const OutputFile& file);

} // namespace lamella::cli
