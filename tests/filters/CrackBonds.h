// Broken bonds as VTK data, and a sample that breaks.
#pragma once

#include "../verification/CrackCuts.h"
#include "OnRanks.h"
#include "VtkTesting.h"

#include "vtkCrackPath.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTypeInt64Array.h"
#include "vtkUnsignedCharArray.h"

namespace lamella::vtktest
{

class CrackPath : public OnRanks
{
};

inline constexpr double horizon = 3;
inline constexpr int size = 60;
inline constexpr double spacing = 2e-6;

/// Broken bonds as vtkBondFracture gives them.
inline vtkSmartPointer<vtkPolyData> brokenBonds(
  const Lattice& lattice, double h, std::span<const cracks::CutBond> bonds, const char* when = "strain")
{
  const auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> places;
  places->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> bond;
  bond->SetName("bond");
  bond->SetNumberOfComponents(3);
  vtkNew<vtkTypeInt64Array> event;
  event->SetName("event");
  vtkNew<vtkDoubleArray> at;
  at->SetName(when);
  vtkNew<vtkUnsignedCharArray> phases;
  phases->SetName("phases");
  phases->SetNumberOfComponents(2);
  vtkNew<vtkUnsignedCharArray> between;
  between->SetName("between_grains");
  for (const cracks::CutBond& b : bonds)
  {
    std::array<double, 3> middle{};
    std::array<double, 3> along{};
    for (std::size_t a = 0; a < 3; ++a)
    {
      along[a] = lattice.spacing * b.step[a];
      middle[a] = lattice.origin[a] + lattice.spacing * static_cast<double>(b.node[a]) + along[a] / 2;
    }
    places->InsertNextPoint(middle.data());
    bond->InsertNextTuple(along.data());
    event->InsertNextValue(b.event);
    at->InsertNextValue(b.when);
    phases->InsertNextTuple2(b.phases[0], b.phases[1]);
    between->InsertNextValue(b.betweenGrains ? 1 : 0);
  }
  data->SetPoints(places);
  for (vtkDataArray* const array : std::initializer_list<vtkDataArray*>{ bond, event, at, phases, between })
    data->GetPointData()->AddArray(array);
  const std::array<double, 3> three{ lattice.spacing, lattice.spacing, lattice.spacing };
  const std::array<double, 3> nodes{ static_cast<double>(lattice.size[0]), static_cast<double>(lattice.size[1]),
    static_cast<double>(lattice.size[2]) };
  setFieldNumbers(data, "spacing", three);
  setFieldNumbers(data, "lattice_size", nodes);
  setFieldNumbers(data, "lattice_origin", lattice.origin);
  setFieldNumbers(data, "horizon", std::array{ h });
  setPhaseNames(data, PhaseTable({ "void", "wall", "lamella" }));
  return data;
}

inline Lattice lattice()
{
  return makeLattice(size, size, 1, 2, spacing);
}

inline int strips(std::int64_t x, std::int64_t)
{
  return 1 + static_cast<int>(x / 20 % 2);
}

/// The sample that breaks.
inline vtkSmartPointer<vtkImageData> strippedPicture()
{
  const auto image = picture(
    size, size, 1, [](int x, int y, int) { return strips(x, y); }, spacing);
  setPhaseNames(image, PhaseTable({ "void", "wall", "lamella" }));
  return image;
}

/// A crack from side to side at 20°, and a short one within the sample.
inline std::vector<cracks::CutBond> sampleBonds()
{
  std::vector<cracks::CutBond> bonds =
    test::cut(lattice(), horizon, { { -1, 15.2 }, { 61, 15.2 + 62 * std::tan(20 * test::pi / 180) } }, strips);
  for (const cracks::CutBond& b : test::cut(lattice(), horizon, { { 10.1, 45.2 }, { 30.3, 49.9 } }, strips))
  {
    bonds.push_back(b);
    bonds.back().event = 2;
    bonds.back().when = 0.25;
  }
  return bonds;
}

inline double number(vtkCrackPath* filter, const char* name, std::size_t i = 0)
{
  return fieldNumbers(filter->GetOutput(), name).at(i);
}

} // namespace lamella::vtktest
