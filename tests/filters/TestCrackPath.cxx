// Crack paths through VTK's pipeline: arrays, tables, field data, fragments, what is refused.
#include "CrackBonds.h"

#include "vtkCellData.h"
#include "vtkFieldData.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;

TEST_F(CrackPath, LinesTablesAndNumbers)
{
  const auto broken = brokenBonds(lattice(), horizon, sampleBonds());
  vtkNew<vtkCrackPath> filter;
  filter->SetInputData(broken);
  filter->SetImageData(strippedPicture());
  ASSERT_EQ(errorOf(filter), "");
  vtkPolyData* const lines = filter->GetOutput();
  ASSERT_EQ(lines->GetNumberOfCells(), 2);
  const double expected = size * spacing / std::cos(20 * test::pi / 180);
  vtkDataArray* const length = lines->GetCellData()->GetArray("length");
  EXPECT_NEAR(length->GetTuple1(0), expected, 0.005 * expected);
  EXPECT_NEAR(lines->GetCellData()->GetArray("angle")->GetTuple1(0), 20, 0.5);
  EXPECT_EQ(lines->GetCellData()->GetArray("crack")->GetTuple1(1), 2);
  double bounds[6];
  lines->GetBounds(bounds);
  EXPECT_NEAR(bounds[0], 0, 1e-12); // it ends on the sides
  EXPECT_NEAR(bounds[1], size * spacing, 1e-12);
  for (const char* const name : { "event", "strain", "phases", "between_grains", "arc_length" })
  {
    vtkDataArray* const array = lines->GetPointData()->GetArray(name);
    ASSERT_NE(array, nullptr) << name;
    EXPECT_EQ(array->GetNumberOfTuples(), lines->GetNumberOfPoints()) << name;
    EXPECT_NE(description(array)[2], "") << name;
  }
  EXPECT_EQ(lines->GetPointData()->GetArray("opening"), nullptr);

  vtkTable* const table = filter->GetPathTable();
  ASSERT_EQ(table->GetNumberOfRows(), 2);
  EXPECT_EQ(cell(table, 0, "length"), length->GetTuple1(0));
  EXPECT_NEAR(cell(table, 0, "tortuosity"), 1, 1e-3);
  EXPECT_EQ(cell(table, 1, "first_event"), 2);
  EXPECT_EQ(cell(table, 1, "last_strain"), 0.25);
  EXPECT_EQ(table->GetValueByName(0, "begins_at").ToString(), "side");
  EXPECT_EQ(table->GetValueByName(1, "ends_at").ToString(), "tip");
  EXPECT_NEAR(
    cell(table, 0, "share_wall") + cell(table, 0, "share_lamella") + cell(table, 0, "share_wall-lamella"), 1, 1e-12);
  EXPECT_NEAR(cell(table, 0, "share_wall"), 2.0 / 3, 0.05);
  EXPECT_NEAR(cell(table, 1, "y_max"), 50.4 * spacing, spacing);

  vtkTable* const pairs = filter->GetPairTable();
  ASSERT_EQ(pairs->GetNumberOfRows(), 3);
  double bonds = 0;
  double share = 0;
  double counted = 0;
  for (vtkIdType row = 0; row < 3; ++row)
  {
    bonds += cell(pairs, row, "bonds");
    share += cell(pairs, row, "share");
    counted += cell(pairs, row, "counted_length");
  }
  EXPECT_EQ(bonds, static_cast<double>(broken->GetNumberOfPoints()));
  EXPECT_NEAR(share, 1, 1e-12);
  EXPECT_NEAR(counted, number(filter, "counted_size"), 1e-12 * counted);

  EXPECT_EQ(number(filter, "crack_count"), 2);
  EXPECT_EQ(number(filter, "main_through", 0), 1);
  EXPECT_EQ(number(filter, "main_through", 1), 0);
  EXPECT_NEAR(number(filter, "through_length", 0), length->GetTuple1(0), 1e-15);
  EXPECT_TRUE(std::isnan(number(filter, "through_length", 1)));
  // all of it broke at once: from one end to the other
  EXPECT_NEAR(number(filter, "main_extension"), number(filter, "main_length"), 1e-15);
  EXPECT_NEAR(std::abs(number(filter, "main_tip", 0) - number(filter, "main_start", 0)), size * spacing, 1e-12);
  EXPECT_NEAR(std::abs(cell(table, 0, "end_x") - cell(table, 0, "begin_x")), size * spacing, 1e-12);
  EXPECT_NEAR(std::max(cell(table, 1, "begin_y"), cell(table, 1, "end_y")), cell(table, 1, "y_max"), 1e-15);
  EXPECT_EQ(lines->GetCellData()->GetArray("through_x")->GetTuple1(0), 1);
  EXPECT_EQ(lines->GetCellData()->GetArray("through_x")->GetTuple1(1), 0);
  EXPECT_NEAR(number(filter, "counted_size"), number(filter, "crack_length"), 0.05 * number(filter, "crack_length"));
  EXPECT_EQ(number(filter, "left_out_bonds"), 0);
  EXPECT_NE(provenance(lines).find("crack_path"), std::string::npos);
  EXPECT_EQ(fieldNumbers(table, "crack_count").at(0), 2);

  vtkTable* const growth = filter->GetGrowthTable();
  ASSERT_EQ(growth->GetNumberOfRows(), 2);
  EXPECT_NEAR(cell(growth, 1, "length"), number(filter, "crack_length"), 1e-12);
  EXPECT_NEAR(cell(growth, 1, "main_length"), number(filter, "main_length"), 1e-12);

  // two pieces: the nodes below and above the crack
  vtkDataArray* const fragment = points(filter->GetImage(), "fragment");
  ASSERT_NE(fragment, nullptr);
  EXPECT_EQ(number(filter, "fragment_count"), 2);
  EXPECT_EQ(number(filter, "severed", 0), 0);
  EXPECT_EQ(number(filter, "severed", 1), 1);
  for (vtkIdType node = 0; node < size * size; ++node)
  {
    const double height = 15.2 + (static_cast<double>(node % size) + 1) * std::tan(20 * test::pi / 180);
    ASSERT_EQ(fragment->GetTuple1(node), static_cast<double>(node / size) > height ? 1 : 2) << node; // the larger: 1
  }
  vtkTable* const fragments = filter->GetFragmentTable();
  ASSERT_EQ(fragments->GetNumberOfRows(), 2);
  EXPECT_EQ(cell(fragments, 0, "nodes") + cell(fragments, 1, "nodes"), size * size);
  EXPECT_EQ(cell(fragments, 1, "touches_y_min"), 1);
  EXPECT_EQ(cell(fragments, 1, "touches_y_max"), 0);
}

TEST_F(CrackPath, WithoutAnImageAndWithOpenings)
{
  const auto broken = brokenBonds(lattice(), horizon, sampleBonds(), "time");
  vtkNew<vtkCrackPath> filter;
  filter->SetInputData(broken);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 2);
  EXPECT_EQ(filter->GetImage()->GetNumberOfPoints(), 0);
  EXPECT_EQ(filter->GetFragmentTable()->GetNumberOfRows(), 0);
  EXPECT_TRUE(fieldNumbers(filter->GetOutput(), "fragment_count").empty());
  EXPECT_NEAR(cell(filter->GetPathTable(), 0, "share_wall"), 2.0 / 3, 0.05); // the bonds know
  EXPECT_NE(filter->GetOutput()->GetPointData()->GetArray("time"), nullptr);
  EXPECT_NE(filter->GetGrowthTable()->GetColumnByName("rate"), nullptr);

  filter->SetMinimumLength(40);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 1);
  EXPECT_EQ(number(filter, "left_out_cracks"), 1);
  EXPECT_NEAR(number(filter, "left_out_length"), spacing * std::hypot(20.2, 4.7), spacing);
  EXPECT_GT(number(filter, "left_out_bonds"), 0);

  const auto image = strippedPicture();
  vtkNew<vtkDoubleArray> u;
  u->SetName("displacement");
  u->SetNumberOfComponents(3);
  for (vtkIdType node = 0; node < size * size; ++node)
  {
    const double height = 15.2 + (static_cast<double>(node % size) + 1) * std::tan(20 * test::pi / 180);
    u->InsertNextTuple3(0, static_cast<double>(node / size) > height ? 1e-7 : 0, 0);
  }
  image->GetPointData()->AddArray(u);
  filter->SetImageData(image);
  filter->ComputeFragmentsOff();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_NEAR(cell(filter->GetPathTable(), 0, "largest_opening"), 1e-7 * std::cos(20 * test::pi / 180), 2e-9);
  EXPECT_EQ(points(filter->GetImage(), "fragment"), nullptr);
}

using Level = std::function<double(double, double, double)>;

/// All bonds of a volume between whose ends a level changes its sign, where the point between lies within another.
std::vector<cracks::CutBond> cutSpace(const Lattice& lattice, double horizon, const Level& level, const Level& within)
{
  const peridynamics::Stencil stencil(3, horizon);
  std::vector<cracks::CutBond> bonds;
  for (std::int64_t z = 0; z < lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < lattice.size[1]; ++y)
      for (std::int64_t x = 0; x < lattice.size[0]; ++x)
        for (const peridynamics::Offset& o : stencil.half())
        {
          const std::array<std::int64_t, 3> n{ x + o.step[0], y + o.step[1], z + o.step[2] };
          if (n[0] < 0 || n[1] < 0 || n[2] < 0 || n[0] >= lattice.size[0] || n[1] >= lattice.size[1] ||
            n[2] >= lattice.size[2])
            continue;
          const std::array<double, 3> at{ static_cast<double>(x), static_cast<double>(y), static_cast<double>(z) };
          const double here = level(at[0], at[1], at[2]);
          const double there = level(at[0] + o.step[0], at[1] + o.step[1], at[2] + o.step[2]);
          if ((here < 0) == (there < 0))
            continue;
          const double share = here / (here - there);
          if (within(at[0] + share * o.step[0], at[1] + share * o.step[1], at[2] + share * o.step[2]) < 0)
            bonds.push_back({ { x, y, z }, o.step, 1, 0.1, { 1, 1 }, false });
        }
  return bonds;
}

double surfaceOf(const Lattice& lattice, double horizon, const std::vector<cracks::CutBond>& bonds)
{
  vtkNew<vtkCrackPath> filter;
  filter->SetInputData(brokenBonds(lattice, horizon, bonds));
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter, "crack_count"), 1);
  return number(filter, "crack_area") / (lattice.spacing * lattice.spacing);
}

// Planes through the sides of a box at many angles: a column of the box has 1/|n·z| of area. Stairs alone would be up
// to 73 % too large.
TEST_F(CrackPath, PlanesInSpaceHaveTheirArea)
{
  const Lattice space = makeLattice(28, 24, 60, 3, spacing);
  std::mt19937 random(4);
  double worst = 0;
  for (int k = 0; k < 8; ++k)
  {
    const auto slope = [&] { return 1.4 * (static_cast<double>(random()) / 4294967296.0 - 0.5); };
    const double a = slope();
    const double b = slope();
    const double c = 29.5 + slope();
    const auto bonds = cutSpace(
      space, 3, [&](double x, double y, double z) { return z - c - a * (x - 13.5) - b * (y - 11.5); },
      [](double, double, double) { return -1.0; });
    const double exact = 28 * 24 * std::sqrt(1 + a * a + b * b);
    const double found = surfaceOf(space, 3, bonds);
    worst = std::max(worst, std::abs(found / exact - 1));
  }
  EXPECT_LT(worst, 0.01);
}

// Closed and open ones: spheres, and a disk askew, whose rim is known to half a spacing.
TEST_F(CrackPath, SpheresAndDisksInSpaceHaveTheirArea)
{
  const Lattice space = makeLattice(44, 44, 44, 3, spacing);
  for (const double radius : { 6.3, 10.2, 15.7 })
  {
    const auto bonds = cutSpace(
      space, 3, [&](double x, double y, double z) { return std::hypot(x - 21.3, y - 21.6, z - 21.8) - radius; },
      [](double, double, double) { return -1.0; });
    const double found = surfaceOf(space, 3, bonds);
    EXPECT_NEAR(found / (4 * std::numbers::pi * radius * radius), 1, 0.01);
  }
  for (const double radius : { 8.0, 12.0, 16.0 })
  {
    const auto bonds = cutSpace(
      space, 3, [&](double x, double y, double z) { return (z - 21.7) + 0.4 * (x - 21.3) - 0.7 * (y - 21.6); },
      [&](double x, double y, double z) { return std::hypot(x - 21.3, y - 21.6, z - 21.7) - radius; });
    const double found = surfaceOf(space, 3, bonds);
    EXPECT_NEAR(std::sqrt(found / std::numbers::pi), radius, 0.1);
  }
}

// A plane through a volume: its area by the broken bonds, and two fragments.
TEST_F(CrackPath, VolumesAreCounted)
{
  const Lattice space = makeLattice(16, 14, 18, 3, spacing);
  const peridynamics::Stencil stencil(3, 2);
  std::vector<cracks::CutBond> bonds;
  for (int z = 0; z < 18; ++z)
  {
    for (int y = 0; y < 14; ++y)
    {
      for (int x = 0; x < 16; ++x)
      {
        for (const peridynamics::Offset& o : stencil.half())
        {
          const auto in = [](int i, int n) { return i >= 0 && i < n; };
          if (in(x + o.step[0], 16) && in(y + o.step[1], 14) && in(z + o.step[2], 18) && (z < 7) != (z + o.step[2] < 7))
            bonds.push_back({ { x, y, z }, o.step, 1, 0.1, { 1, 1 }, false });
        }
      }
    }
  }
  const auto image = picture(
    16, 14, 18, [](int, int, int) { return 1; }, spacing);
  vtkNew<vtkCrackPath> filter;
  filter->SetInputData(brokenBonds(space, 2, bonds));
  filter->SetImageData(image);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 2 * 16 * 14);
  EXPECT_EQ(filter->GetPathTable()->GetNumberOfRows(), 1);
  EXPECT_NEAR(number(filter, "crack_area") / (16 * 14 * spacing * spacing), 1, 1e-12);
  EXPECT_NEAR(cell(filter->GetPathTable(), 0, "normal_z"), 1, 1e-12);
  EXPECT_NEAR(cell(filter->GetPathTable(), 0, "z_min"), 7 * spacing, 1e-12 * spacing);
  EXPECT_EQ(cell(filter->GetPathTable(), 0, "first_event"), 1);
  EXPECT_NEAR(cell(filter->GetPairTable(), 0, "area"), number(filter, "crack_area"), 1e-20);
  EXPECT_TRUE(fieldNumbers(filter->GetOutput(), "crack_length").empty());
  EXPECT_TRUE(fieldNumbers(filter->GetOutput(), "main_tip").empty()); // a front is no point
  // as many bonds of each step as fit between the sides, times how far they reach across
  const cracks::BondCount count(3, 2);
  double area = 0;
  for (const peridynamics::Offset& o : stencil.half())
    area += count.weight(o.step) * std::abs(o.step[2]) * (16 - std::abs(o.step[0])) * (14 - std::abs(o.step[1]));
  area *= spacing * spacing;
  EXPECT_NEAR(number(filter, "counted_size") / area, 1, 1e-12);
  EXPECT_NEAR(area / (16 * 14 * spacing * spacing), 1, 0.15); // by direction 8 %; the rest are bonds that sides cut off
  EXPECT_NEAR(number(filter, "crack_normals", 8), 1, 0.25);   // few directions
  EXPECT_NEAR(cell(filter->GetPairTable(), 0, "counted_area"), number(filter, "counted_size"), 1e-20);
  ASSERT_EQ(filter->GetFragmentTable()->GetNumberOfRows(), 2);
  EXPECT_EQ(cell(filter->GetFragmentTable(), 0, "nodes"), 16 * 14 * 11);
  EXPECT_EQ(number(filter, "severed", 2), 1);
  EXPECT_EQ(number(filter, "severed", 0), 0);
}

TEST_F(CrackPath, NoBrokenBondIsNoCrack)
{
  vtkNew<vtkCrackPath> filter;
  filter->SetInputData(brokenBonds(lattice(), horizon, {}));
  filter->SetImageData(strippedPicture());
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter, "broken_bonds"), 0);
  EXPECT_EQ(number(filter, "crack_count"), 0);
  EXPECT_TRUE(std::isnan(number(filter, "main_tip", 1)));
  EXPECT_EQ(number(filter, "main_extension"), 0);
  EXPECT_EQ(number(filter, "fragment_count"), 1);
}

TEST_F(CrackPath, WhatCannotBeDoneIsRefusedInWords)
{
  struct Case
  {
    std::function<void(vtkCrackPath*, vtkPolyData*, vtkImageData*)> spoil;
    const char* words;
    const char* hint;
  };
  const std::vector<Case> cases{
    { [](auto*, auto* b, auto*) { b->GetPointData()->RemoveArray("bond"); }, "the points have no array 'bond'",
      "lamella fracture" },
    { [](auto*, auto* b, auto*) { b->GetFieldData()->RemoveArray("lattice_size"); }, "do not tell their lattice",
      "lamella fracture" },
    { [](auto*, auto* b, auto*) { b->GetFieldData()->RemoveArray("horizon"); }, "do not tell their horizon",
      "give it in spacings" },
    { [](auto*, auto* b, auto*) { b->GetPointData()->GetArray("bond")->SetComponent(3, 0, std::nan("")); },
      "array 'bond' is not finite at point 3", "leave such bonds out" },
    { [](auto*, auto* b, auto*) { b->GetPoints()->SetPoint(5, 1.3e-6, 0, 0); },
      "the broken bond at point 5 joins no two nodes", "middles of bonds" },
    { [](auto* f, auto*, auto*) { f->SetHorizon(2); }, "is longer than the horizon of 2", "give the horizon" },
    { [](auto* f, auto*, auto*) { f->SetHorizon(9); }, "horizon 9 is above 8", "from 0 to 8" },
    { [](auto* f, auto*, auto*) { f->SetMinimumLength(std::nan("")); }, "minimum length nan is not a number",
      "-1 or more" },
    { [](auto*, auto*, auto* i) { i->SetDimensions(60, 30, 1); }, "is not on the lattice of the broken bonds",
      "give the image that was broken" },
    { [](auto*, auto*, auto* i) { i->GetPointData()->Initialize(); }, "no point array 'phase'", "picture reader" },
  };
  for (const Case& test : cases)
  {
    const auto broken = brokenBonds(lattice(), horizon, sampleBonds());
    const auto image = strippedPicture();
    vtkNew<vtkCrackPath> filter;
    filter->SetInputData(broken);
    filter->SetImageData(image);
    test.spoil(filter.Get(), broken.Get(), image.Get());
    const std::string error = errorOf(filter);
    EXPECT_NE(error.find(test.words), std::string::npos) << test.words << ": " << error;
    EXPECT_NE(error.find(test.hint), std::string::npos) << test.words << ": " << error;
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0) << test.words;
    EXPECT_EQ(filter->GetPathTable()->GetNumberOfRows(), 0) << test.words;
  }
}

TEST_F(CrackPath, AbortLeavesNothing)
{
  vtkNew<vtkCrackPath> filter;
  filter->SetInputData(brokenBonds(lattice(), horizon, sampleBonds()));
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { vtkAlgorithm::SafeDownCast(caller)->SetAbortExecute(1); });
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_EQ(filter->GetPathTable()->GetNumberOfRows(), 0);
}

} // namespace
