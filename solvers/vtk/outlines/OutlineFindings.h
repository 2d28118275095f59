#pragma once

#include "lbm/ContourChecks.h"

#include "vtkLamellaSolversVTKModule.h" // for the export macro

#include <string>
#include <utility>
#include <vector>

class vtkDataObject;

/// What diffusion through outlines found, for those who tell it: the output's field data, a report. Not installed.
namespace lamella
{

struct VTKLAMELLASOLVERSVTK_EXPORT OutlineFindings
{
  std::vector<lbm::ContourAnswer> answers;                  ///< by direction that was solved
  std::vector<std::pair<std::string, double>> conductivity; ///< of the phases that were given one
  double spacing = 0;                                       ///< of the finer lattice of the first pair [m]
  bool picture = false;                                     ///< the error that its pixels leave is part of the bar
  double targetError = 0;                                   ///< 0: none
  lbm::Shortfall shortfall;
  std::string direction;             ///< as it is written: x, y, all
  std::vector<std::string> warnings; ///< the shortfall is not among them
};

/// Writes them into field data.
VTKLAMELLASOLVERSVTK_EXPORT void describe(vtkDataObject* output, const OutlineFindings& found);

} // namespace lamella
