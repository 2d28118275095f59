#pragma once

#include "vtkLatticeConversion.h"
#include "vtkSteadyDiffusion.h"

#include "vtkAlgorithm.h"
#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkTable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

/// What the tests of VTK classes share.
namespace lamella::vtktest
{

/// For names of test cases, in which only letters, digits and _ may stand.
inline std::string latticeName(int lattice)
{
  static const char* const names[] = { "D2Q5", "D2Q9", "D3Q7", "D3Q19" };
  return names[lattice - vtkSteadyDiffusion::D2Q5];
}

/// Updates an algorithm and returns the first error it reports, or an empty string; nothing is printed.
inline std::string errorOf(vtkAlgorithm* algorithm, const std::function<void()>& update)
{
  std::string first;
  vtkNew<vtkCallbackCommand> keep;
  keep->SetClientData(&first);
  keep->SetCallback(
    [](vtkObject*, unsigned long, void* client, void* text)
    {
      auto& kept = *static_cast<std::string*>(client);
      if (kept.empty())
        kept = static_cast<const char*>(text);
    });
  vtkNew<vtkCallbackCommand> silence; // the executive only says that the algorithm failed
  silence->SetCallback([](vtkObject*, unsigned long, void*, void*) {});
  algorithm->AddObserver(vtkCommand::ErrorEvent, keep);
  algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, silence);
  update();
  algorithm->RemoveObserver(keep);
  algorithm->GetExecutive()->RemoveObserver(silence);
  return first;
}
inline std::string errorOf(vtkAlgorithm* algorithm)
{
  return errorOf(
    algorithm, [algorithm] { algorithm->Update(); });
}

/// A picture of phases "a", "b", ... from a rule (x, y, z) → id.
inline vtkSmartPointer<vtkImageData> picture(
  int nx, int ny, int nz, const std::function<int(int, int, int)>& rule, double spacing = 1e-6)
{
  PhaseImage image;
  image.lattice = makeLattice(nx, ny, nz, nz > 1 ? 3 : 2, spacing);
  image.phases = PhaseTable({ "a", "b", "c" });
  for (int z = 0; z < nz; ++z)
  {
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        image.phase.push_back(static_cast<std::uint8_t>(rule(x, y, z)));
  }
  return toImageData(std::move(image));
}

/// A picture without symmetry: blobs, and bars that lead from side to side along each axis.
inline int blobs(int x, int y, int z)
{
  return (x * x + 3 * y + 5 * z * z + x * y) % 17 < 6 || x % 7 == 3 || (y + z) % 5 == 1 ? 1 : 0;
}

inline vtkDataArray* points(vtkImageData* image, const char* name)
{
  return image->GetPointData()->GetArray(name);
}

/// The number in one row of a table; NaN, and a failure, where there is no such column.
inline double cell(vtkTable* table, vtkIdType row, const char* column)
{
  auto* const array = vtkDataArray::SafeDownCast(table->GetColumnByName(column));
  EXPECT_NE(array, nullptr) << column;
  return array != nullptr ? array->GetTuple1(row) : std::nan("");
}

} // namespace lamella::vtktest
