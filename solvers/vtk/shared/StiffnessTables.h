#pragma once

#include "elasticity/ElasticConstants.h"
#include "elasticity/SideMatch.h"
#include "elasticity/StiffnessError.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

class vtkImageData;
class vtkTable;

/// An effective stiffness as field data and tables, whatever found it. Not installed.
namespace lamella
{

struct StiffnessFound
{
  int dimension = 2;
  std::span<const double> stiffness, voigt, reuss; ///< by rows [Pa]; empty: not known
  double asymmetry = 0;
  const elasticity::ElasticConstants* constants = nullptr;
  const elasticity::StiffnessError* error = nullptr;
  std::span<const elasticity::StiffnessStep> steps;
  std::array<elasticity::SideMatch, 3> sides{};
  std::array<bool, 3> crosses{};
  std::int64_t pieces = 0, loosePieces = 0, looseNodes = 0;
};

/// Numbers of the tensor, the constants, the solves and the sides.
void setStiffness(vtkImageData* output, const StiffnessFound& found);
void fillTensor(vtkTable* table, const StiffnessFound& found, const char* creator);
void fillConstants(vtkTable* table, const StiffnessFound& found, const char* creator);

} // namespace lamella
