// Steady diffusion as a VTK filter: exact laminates, the directions' convention, what the output carries, bad input.
#include "FieldLayers.h"
#include "VtkTesting.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkSteadyDiffusion.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnsignedShortArray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using vtktest::errorOf;
using vtktest::picture;
using vtktest::points;

// Half the layers conduct 1, half 10, on lattice nodes: the scheme is exact, the solver's tolerance remains (1e-8).
constexpr double series = 2.0 / (1.0 / 1 + 1.0 / 10);
constexpr double parallel = (1.0 + 10.0) / 2;
constexpr double exact = 1e-7;

vtkNew<vtkSteadyDiffusion> solver(vtkImageData* image, int direction)
{
  vtkNew<vtkSteadyDiffusion> filter;
  filter->SetInputData(image);
  filter->SetConductivity("a", 1);
  filter->SetConductivity("b", 10);
  filter->SetDirection(direction);
  return filter;
}

int layersAcrossX(int x, int, int)
{
  return x / 3 % 2;
}

TEST(SteadyDiffusion, LaminateIsExactInBothDirections)
{
  for (const int sides : { vtkSteadyDiffusion::INSULATED, vtkSteadyDiffusion::PERIODIC })
  {
    for (const int lattice : { vtkSteadyDiffusion::D2Q5, vtkSteadyDiffusion::D2Q9 })
    {
      const auto filter = solver(picture(24, 18, 1, layersAcrossX), vtkSteadyDiffusion::ALL);
      filter->SetSides(sides);
      filter->SetLattice(lattice);
      ASSERT_EQ(errorOf(filter), "");
      const double* const k = filter->GetEffectiveConductivity();
      // Diagonal links of D2Q9 join unlike layers along them, so only across the layers it is exact too.
      EXPECT_NEAR(k[0], series, exact * series);
      if (lattice == vtkSteadyDiffusion::D2Q5)
        EXPECT_NEAR(k[4], parallel, exact * parallel);
      EXPECT_NEAR(k[1], 0, 1e-6);
      EXPECT_NEAR(k[3], 0, 1e-6);
      EXPECT_TRUE(std::isnan(k[8]));
    }
  }
}

TEST(SteadyDiffusion, LaminateIsExactInThreeDimensions)
{
  const auto filter = solver(picture(12, 8, 6, layersAcrossX), vtkSteadyDiffusion::ALL);
  ASSERT_EQ(errorOf(filter), "");
  const double* const k = filter->GetEffectiveConductivity();
  EXPECT_NEAR(k[0], series, exact * series);
  EXPECT_NEAR(k[4], parallel, exact * parallel);
  EXPECT_NEAR(k[8], parallel, exact * parallel);
}

TEST(SteadyDiffusion, VoxelsNeedNotBeCubes)
{
  const vtkSmartPointer<vtkImageData> image = picture(12, 8, 6, layersAcrossX);
  image->SetSpacing(3, 1, 2);
  const auto filter = solver(image, vtkSteadyDiffusion::ALL);
  ASSERT_EQ(errorOf(filter), "");
  const double* const k = filter->GetEffectiveConductivity();
  EXPECT_NEAR(k[0], series, exact * series);
  EXPECT_NEAR(k[4], parallel, exact * parallel);
  EXPECT_NEAR(k[8], parallel, exact * parallel);
  double mean[3] = { 0, 0, 0 }; // of the flux per metre: the effective conductivity over the length
  vtkImageData* const output = filter->GetOutput();
  vtkDataArray* const flux = output->GetPointData()->GetArray("flux_x");
  for (vtkIdType i = 0; i < flux->GetNumberOfTuples(); ++i)
    mean[0] += flux->GetComponent(i, 0) / static_cast<double>(flux->GetNumberOfTuples());
  EXPECT_NEAR(mean[0], series / 36, 1e-5);
  EXPECT_EQ(output->GetSpacing()[2], 2);
}

TEST(SteadyDiffusion, FieldsByLayersAreThoseOfTheOutput)
{
  const auto solve = [](const std::function<void(const FieldLayers&)>& sink)
  {
    const auto filter = solver(picture(14, 10, 12, [](int x, int y, int z) { return (x * 7 + y * 5 + z * 3) % 4 / 2; }),
      vtkSteadyDiffusion::ALL);
    filter->SetEstimateError(false);
    filter->SetFieldSink(sink);
    EXPECT_EQ(errorOf(filter), "");
    return vtkSmartPointer<vtkSteadyDiffusion>(filter);
  };
  const auto whole = solve({});
  int solves = 0;
  const auto layers = solve(
    [&](const FieldLayers& fields)
    {
      EXPECT_EQ(fields.axis, solves++);
      EXPECT_TRUE(fields.image->GetPointData()->HasArray("phase"));
      for (const auto& [first, last] : { std::pair{ 0, 0 }, { 3, 9 }, { 11, 11 }, { 0, 11 } })
        for (const auto& array : fields.read(first, last))
        {
          vtkDataArray* const all = whole->GetOutput()->GetPointData()->GetArray(array->GetName());
          ASSERT_NE(all, nullptr) << array->GetName();
          ASSERT_EQ(array->GetNumberOfTuples(), (last - first + 1) * 140);
          for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
            for (int c = 0; c < array->GetNumberOfComponents(); ++c)
              ASSERT_EQ(array->GetComponent(i, c), all->GetComponent(first * 140 + i, c));
        }
    });
  EXPECT_EQ(solves, 3);
  EXPECT_FALSE(layers->GetOutput()->GetPointData()->HasArray("temperature_x"));
}

/// A ball whose surface is a voxel wide.
template <class Array>
vtkSmartPointer<vtkImageData> greyBall(double none, double all)
{
  constexpr int n = 24;
  const vtkSmartPointer<vtkImageData> image = picture(n, n, n, [](int, int, int) { return 0; });
  vtkNew<Array> grey;
  grey->SetName("grey");
  for (int i = 0; i < n * n * n; ++i)
  {
    const double distance =
      std::hypot(i % n - 11.2, i / n % n - 11.7, i / n / n - 11.4); // NOLINT(bugprone-integer-division)
    grey->InsertNextValue(static_cast<typename Array::ValueType>(
      std::round((none + (all - none) * std::clamp(9.3 - distance, 0.0, 1.0)) * 1000) / 1000));
  }
  image->GetPointData()->Initialize();
  image->GetFieldData()->Initialize(); // no names of phases
  image->GetPointData()->SetScalars(grey);
  return image;
}

double conductivityOfBall(vtkImageData* image, double none, double all)
{
  vtkNew<vtkSteadyDiffusion> filter;
  filter->SetInputData(image);
  filter->SetInputArrayToProcess(0, 0, 0, 0, "grey");
  filter->SetConductivity("low", 1);
  filter->SetConductivity("high", 10);
  filter->SetShares(none, all);
  filter->SetDirection(vtkSteadyDiffusion::X);
  EXPECT_EQ(errorOf(filter), "");
  return filter->GetEffectiveConductivity()[0];
}

// Layers three nodes thick: between two faces 7 surfaces, of a cell that repeats 8.
TEST(SteadyDiffusion, MembranesLieBetweenTwoPhases)
{
  for (const int depth : { 1, 24 })
  {
    const auto image = picture(24, 24, depth, layersAcrossX);
    const double spacing = image->GetSpacing()[0];
    const auto filter = solver(image, 0);
    filter->SetMembrane("b-a", 2 * spacing);
    EXPECT_EQ(filter->GetNumberOfMembranes(), 1);
    EXPECT_EQ(filter->GetMembrane("b-a"), 2 * spacing);
    ASSERT_EQ(errorOf(filter), "");
    const double between = 24 / (24 / series + 7 * 2);
    EXPECT_NEAR(filter->GetEffectiveConductivity()[0] / between, 1, exact);
    vtkFieldData* const data = filter->GetOutput()->GetFieldData();
    EXPECT_NEAR(data->GetArray("membrane_area")->GetTuple1(0) * spacing * 24 / 7, 1, 1e-12);
    EXPECT_EQ(data->GetArray("membrane_resistance")->GetTuple1(0), 2 * spacing);
    EXPECT_EQ(data->GetAbstractArray("membrane_names")->GetVariantValue(0).ToString(), "a-b");
    EXPECT_EQ(data->GetArray("membrane_sensitivity"), nullptr);
    EXPECT_NEAR(data->GetArray("bounds")->GetTuple1(0) / between, 1, exact);

    filter->RemoveAllMembranes();
    filter->SetPermeance("a-b", 0.5 / spacing);
    EXPECT_EQ(filter->GetNumberOfPermeances(), 1);
    EXPECT_EQ(filter->GetPermeance("a-b"), 0.5 / spacing);
    filter->SetSides(vtkSteadyDiffusion::PERIODIC);
    filter->SetComputeSensitivity(true);
    ASSERT_EQ(errorOf(filter), "");
    const double round = 24 / (24 / series + 8 * 2);
    EXPECT_NEAR(filter->GetEffectiveConductivity()[0] / round, 1, exact);
    // ∂K/∂R = −8 K²/L
    EXPECT_NEAR(filter->GetOutput()->GetFieldData()->GetArray("membrane_sensitivity")->GetComponent(0, 0) /
        (-8 * round * round / (24 * spacing)),
      1, 1e-5);
  }
}

TEST(SteadyDiffusion, MembranesThatCannotBe)
{
  const auto with = [](const char* pair, double resistance)
  {
    auto filter = solver(picture(24, 18, 1, layersAcrossX), 0);
    filter->SetMembrane(pair, resistance);
    return filter;
  };
  EXPECT_NE(errorOf(with("a-z", 1)).find("'a-z', which are not two phases"), std::string::npos);
  EXPECT_NE(errorOf(with("a-a", 1)).find("between 'a' and itself"), std::string::npos);
  EXPECT_NE(errorOf(with("a", 1)).find("between 'a' and itself"), std::string::npos);
  EXPECT_NE(errorOf(with("a-b", -1)).find("the resistance of the membrane a-b is -1"), std::string::npos);
  EXPECT_NE(errorOf(with("a-b", std::numeric_limits<double>::infinity())).find("a very large one"), std::string::npos);
  for (const int lattice : { vtkSteadyDiffusion::D2Q9, vtkSteadyDiffusion::Q1 })
  {
    const auto filter = with("a-b", 1);
    filter->SetLattice(lattice);
    EXPECT_NE(errorOf(filter).find("take d2q5"), std::string::npos);
  }
  const auto across = with("a-b", 1);
  across->SetConductivityAcross("b", 2);
  EXPECT_NE(errorOf(across).find("conduct differently by direction"), std::string::npos);
  const auto shares = with("a-b", 1);
  shares->SetShares(0, 1);
  EXPECT_NE(errorOf(shares).find("membranes between greys"), std::string::npos);
  const auto image = picture(24, 18, 1, layersAcrossX);
  image->SetSpacing(1, 20, 1);
  const auto flat = solver(image, 0);
  flat->SetMembrane("a-b", 1);
  EXPECT_NE(errorOf(flat).find("edges of 20 and 1"), std::string::npos);
}

// As above, along each axis of voxels of edges 1, 2, ½: by lengths, not by spacings.
TEST(SteadyDiffusion, MembranesBetweenVoxelsOfUnlikeEdges)
{
  const std::array<double, 3> edges{ 1e-6, 2e-6, 0.5e-6 };
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto image = picture(24, 24, 24,
      [axis](int x, int y, int z) {
        return layersAcrossX(axis == 0 ? x : axis == 1 ? y : z, 0, 0);
      });
    image->SetSpacing(edges.data());
    const double edge = edges[static_cast<std::size_t>(axis)];
    const auto filter = solver(image, axis);
    filter->SetMembrane("a-b", 2e-6);
    filter->SetComputeSensitivity(true);
    ASSERT_EQ(errorOf(filter), "");
    const double between = 24 * edge / (24 * edge / series + 7 * 2e-6);
    EXPECT_NEAR(filter->GetEffectiveConductivity()[4 * axis] / between, 1, exact);
    vtkFieldData* const data = filter->GetOutput()->GetFieldData();
    EXPECT_NEAR(data->GetArray("membrane_area")->GetTuple1(0) * edge * 24 / 7, 1, 1e-12);
    EXPECT_NEAR(data->GetArray("bounds")->GetTuple1(0) / between, 1, exact);
    // ∂K/∂R = −7 K²/L
    EXPECT_NEAR(
      data->GetArray("membrane_sensitivity")->GetComponent(0, axis) / (-7 * between * between / (24 * edge)), 1, 1e-5);
  }
}

TEST(SteadyDiffusion, SharesComeFromGreysOfAnyType)
{
  const double bytes = conductivityOfBall(greyBall<vtkUnsignedCharArray>(40, 220), 40, 220);
  EXPECT_GT(bytes, 1.2);
  // the same numbers, so the same greys
  EXPECT_DOUBLE_EQ(conductivityOfBall(greyBall<vtkIntArray>(40, 220), 40, 220), bytes);
  // 181 greys beside 255: shares differ by up to 1/360
  EXPECT_NEAR(conductivityOfBall(greyBall<vtkUnsignedShortArray>(4000, 61000), 4000, 61000) / bytes, 1, 1e-3);
  EXPECT_NEAR(conductivityOfBall(greyBall<vtkFloatArray>(-0.3F, 1.7F), -0.3, 1.7) / bytes, 1, 1e-3);
  EXPECT_NEAR(conductivityOfBall(greyBall<vtkFloatArray>(1.7F, -0.3F), 1.7, -0.3) / bytes, 1, 1e-3);

  const vtkSmartPointer<vtkImageData> none = greyBall<vtkFloatArray>(0, 1.5);
  none->GetPointData()->GetArray("grey")->SetComponent(77, 0, std::nan(""));
  vtkNew<vtkSteadyDiffusion> filter;
  filter->SetInputData(none);
  filter->SetInputArrayToProcess(0, 0, 0, 0, "grey");
  filter->SetConductivity("low", 1);
  filter->SetConductivity("high", 10);
  filter->SetShares(0, 1.5);
  EXPECT_NE(errorOf(filter).find("no numbers"), std::string::npos);
}

/// A ball of whole voxels, of a material of three phases of which one has no nodes.
vtkSmartPointer<vtkImageData> labelledBall(int inside, int outside)
{
  return picture(
    24, 24, 24,
    [=](int x, int y, int z)
    { return std::hypot(x - 11.2, y - 11.7, z - 11.4) < 8.8 ? inside : outside; }); // NOLINT(readability-magic-numbers)
}

TEST(SteadyDiffusion, LabelsAreSmoothedWhateverTheirIds)
{
  // Greys of greyBall() are half of each 8.8 from its middle: the same ball. Labels know it but for the noise of
  // voxels, 0.29/√area of a voxel or 0.1 % of the volume, and a linear rim is no share of a sphere: 1 % in all.
  const double greys = conductivityOfBall(greyBall<vtkFloatArray>(0, 1), 0, 1);
  const auto found = [&](int inside, int outside, bool smooth)
  {
    const auto filter = solver(labelledBall(inside, outside), vtkSteadyDiffusion::X);
    filter->SetConductivity(inside == 1 ? "b" : "a", 10);
    filter->SetConductivity(inside == 1 ? "a" : "b", 1);
    filter->SetSmoothLabels(smooth);
    filter->ComputeSensitivityOn();
    EXPECT_EQ(errorOf(filter), "");
    vtkImageData* const output = filter->GetOutput();
    const double k = filter->GetEffectiveConductivity()[0];
    const std::vector<double> by = fieldNumbers(output, "conductivity_sensitivity");
    const std::size_t ball = inside == 1 ? 3 : 0;
    EXPECT_NEAR(10 * by[ball] + by[3 - ball], k, 1e-4 * k);
    EXPECT_NEAR(fieldNumbers(output, "phase_fraction")[inside == 1 ? 1 : 0], 0.2065, 0.002); // 4/3 π 8.8³ / 24³
    const std::vector<double> bounds = fieldNumbers(output, "bounds");
    EXPECT_GT(k, bounds.front());
    EXPECT_LT(k, bounds.back());
    if (smooth)
      EXPECT_NEAR(fieldNumbers(output, "estimated_error").at(0),
        fieldNumbers(output, "lattice_error").at(0) + fieldNumbers(output, "picture_error").at(0), 1e-12);
    return k;
  };
  const double labels = found(1, 0, true);
  EXPECT_NEAR(labels, greys, 0.01 * greys);
  EXPECT_NEAR(found(0, 1, true), labels, 1e-7 * labels);      // the tolerance is 1e-8
  EXPECT_GT(std::abs(found(1, 0, false) / labels - 1), 1e-4); // whole voxels are something else
}

TEST(SteadyDiffusion, LabelsThatCannotBeSmoothedAreRefused)
{
  const auto refused = [](const vtkSmartPointer<vtkImageData>& image, auto&& change)
  {
    const auto filter = solver(image, vtkSteadyDiffusion::X);
    filter->SmoothLabelsOn();
    change(filter);
    return errorOf(filter);
  };
  const vtkSmartPointer<vtkImageData> two = picture(12, 8, 6, layersAcrossX);
  const auto nothing = [](vtkSteadyDiffusion*) {};
  EXPECT_EQ(refused(two, nothing), "");
  EXPECT_NE(refused(picture(
                      12, 8, 6, [](int, int, int) { return 1; }),
              nothing)
              .find("smoothed labels of 1 phase: b"),
    std::string::npos);
  EXPECT_NE(refused(
              picture(
                12, 8, 6, [](int x, int, int) { return x % 3; }),
              [](vtkSteadyDiffusion* filter) { filter->SetConductivity("c", 3); })
              .find("smoothed labels of 3 phases: a, b, c"),
    std::string::npos);
  for (const auto& [words, change] :
    std::vector<std::pair<std::string, void (*)(vtkSteadyDiffusion*)>>{
      { "smoothed labels of an image that is grey", [](vtkSteadyDiffusion* f) { f->SetShares(0, 1); } },
      { "smoothed labels of an image that is grey", [](vtkSteadyDiffusion* f) { f->SetInterpolate(true); } },
      { "smoothed labels, with pixels that are split", [](vtkSteadyDiffusion* f) { f->SetRefinement(2); } },
      { "smoothed labels, with pixels that are split", [](vtkSteadyDiffusion* f) { f->SetTargetError(0.01); } } })
    EXPECT_NE(refused(two, change).find(words), std::string::npos) << words;
}

/// Layers across x, each of a grey of its own: in series across, in parallel along; bins err by less than they tell.
TEST(SteadyDiffusion, ConductivitiesAreInterpolatedBetweenGreys)
{
  constexpr int layers = 600;
  for (const double contrast : { 3.0, 1000.0 })
    for (const bool whole : { true, false })
    {
      const vtkSmartPointer<vtkImageData> image = picture(layers, 2, 1, [](int, int, int) { return 0; });
      vtkNew<vtkDoubleArray> grey;
      grey->SetName("grey");
      double resistance = 0;
      double sum = 0;
      for (int i = 0; i < 2 * layers; ++i)
      {
        const double share = whole ? i % layers % 200 / 200.0 : std::fmod(i % layers * 0.61803398875, 1.0);
        grey->InsertNextValue(40 + 200 * share);
        const double k = std::min(1.0, share / 0.9) * (contrast - 1) + 1; // constant above 220
        resistance += 0.5 / k / layers;
        sum += 0.5 * k / layers;
      }
      image->GetPointData()->Initialize();
      image->GetFieldData()->Initialize();
      image->GetPointData()->SetScalars(grey);
      vtkNew<vtkSteadyDiffusion> filter;
      filter->SetInputData(image);
      filter->SetInputArrayToProcess(0, 0, 0, 0, "grey");
      filter->SetConductivity("40", 1);
      filter->SetConductivity("220", contrast);
      filter->SetInterpolate(true);
      filter->SetEstimateError(false);
      ASSERT_EQ(errorOf(filter), "");
      const double rounding = lamella::fieldNumbers(filter->GetOutput(), "conductivity_rounding").at(0);
      EXPECT_EQ(rounding > 0, !whole);
      EXPECT_LT(rounding, 0.015);
      const double* const k = filter->GetEffectiveConductivity();
      EXPECT_NEAR(k[0] * resistance, 1, std::max(1e-7, 0.1 * rounding));
      EXPECT_NEAR(k[4] / sum, 1, std::max(1e-7, 0.1 * rounding));
    }
}

TEST(SteadyDiffusion, GreysThatCannotBeInterpolatedAreRefused)
{
  const vtkSmartPointer<vtkImageData> named = picture(6, 6, 1, layersAcrossX);
  const auto filter = solver(named, vtkSteadyDiffusion::X);
  filter->SetInterpolate(true);
  EXPECT_NE(errorOf(filter).find("'a', which is no grey"), std::string::npos);
  filter->RemoveAllConductivities();
  EXPECT_NE(errorOf(filter).find("no grey to be interpolated"), std::string::npos);
  filter->SetConductivity("40", 1);
  EXPECT_NE(errorOf(filter).find("one grey alone"), std::string::npos);
  filter->SetConductivity("50", 1);
  EXPECT_NE(errorOf(filter).find("phases have names, as 'a'"), std::string::npos);
  filter->SetShares(40, 50);
  EXPECT_NE(errorOf(filter).find("take one of them"), std::string::npos);
}

TEST(SteadyDiffusion, EmptyBoxConductsAsItsMaterial)
{
  const auto filter = solver(picture(10, 12, 1, [](int, int, int) { return 1; }), vtkSteadyDiffusion::X);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_NEAR(filter->GetEffectiveConductivity()[0], 10, 10 * exact);
}

TEST(SteadyDiffusion, PicturesConductFromTopToBottom)
{
  const int ny = 10;
  const auto filter = solver(picture(4, ny, 1, [](int, int, int) { return 0; }), vtkSteadyDiffusion::Y);
  ASSERT_EQ(errorOf(filter), "");
  vtkDataArray* const value = points(filter->GetOutput(), "temperature");
  vtkDataArray* const flux = points(filter->GetOutput(), "flux");
  for (int y = 0; y < ny; ++y) // faces half a spacing outside the outer nodes
  {
    EXPECT_NEAR(value->GetTuple1(4 * y), (y + 0.5) / ny, 1e-7);
    EXPECT_NEAR(flux->GetComponent(4 * y, 1), -1.0 / (ny * 1e-6), 1e-1); // downwards, u per metre: 1e5
  }
}

TEST(SteadyDiffusion, VolumesConductFromLowToHigh)
{
  const auto filter = solver(picture(3, 10, 3, [](int, int, int) { return 0; }), vtkSteadyDiffusion::Y);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_NEAR(points(filter->GetOutput(), "temperature")->GetTuple1(0), 0.95, 1e-7);
}

TEST(SteadyDiffusion, CarriesWhatIsAskedForAndNothingElse)
{
  const auto filter = solver(picture(12, 12, 1, layersAcrossX), vtkSteadyDiffusion::ALL);
  filter->SetQuantity(vtkSteadyDiffusion::CONCENTRATION);
  ASSERT_EQ(errorOf(filter), "");
  for (const char* const name : { "phase", "concentration_x", "concentration_y", "flux_x", "flux_y" })
    EXPECT_NE(points(filter->GetOutput(), name), nullptr) << name;
  EXPECT_EQ(filter->GetOutput()->GetPointData()->GetNumberOfArrays(), 5);

  filter->ComputeFieldOff();
  filter->ComputeFluxOff();
  filter->SetDirection(vtkSteadyDiffusion::X);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetPointData()->GetNumberOfArrays(), 1);
  EXPECT_NEAR(filter->GetEffectiveConductivity()[0], series, exact * series);
  EXPECT_TRUE(std::isnan(filter->GetEffectiveConductivity()[4])); // of the run before
}

TEST(SteadyDiffusion, FieldDataSaysWhatWasDone)
{
  const auto image = picture(12, 12, 1, layersAcrossX);
  setFieldText(image, "pixel_size_source", "option");
  const auto filter = solver(image, vtkSteadyDiffusion::X);
  filter->EstimateErrorOn();
  ASSERT_EQ(errorOf(filter), "");
  vtkImageData* const output = filter->GetOutput();
  const auto tensor = fieldNumbers(output, "effective_conductivity");
  ASSERT_EQ(tensor.size(), 9U);
  EXPECT_NEAR(tensor[0], series, exact * series);
  EXPECT_TRUE(std::isnan(tensor[4]));
  // The laminate is exact at any resolution: what is left of the lattice is the solver's own tolerance. Whether layers
  // of three nodes end where their pixels do the picture does not tell.
  EXPECT_LT(fieldNumbers(output, "lattice_error").at(0), 1e-6);
  EXPECT_EQ(fieldNumbers(output, "lattice_error_by_direction").at(0), fieldNumbers(output, "lattice_error").at(0));
  EXPECT_TRUE(std::isnan(fieldNumbers(output, "picture_error_by_direction").at(1)));
  EXPECT_GT(fieldNumbers(output, "picture_error").at(0), 0.01);
  EXPECT_NEAR(fieldNumbers(output, "estimated_error").at(0), fieldNumbers(output, "picture_error").at(0), 1e-6);
  const auto bounds = fieldNumbers(output, "bounds");
  ASSERT_EQ(bounds.size(), 4U);
  EXPECT_NEAR(bounds[0], series, 1e-12);
  EXPECT_NEAR(bounds[3], parallel, 1e-12);
  EXPECT_LT(bounds[0], bounds[1]);
  EXPECT_LT(bounds[1], bounds[2]);
  EXPECT_EQ(fieldNumbers(output, "phase_conductivity"), (std::vector<double>{ 1, 10, 0 }));
  EXPECT_EQ(fieldNumbers(output, "phase_fraction"), (std::vector<double>{ 0.5, 0.5, 0 }));
  EXPECT_EQ(fieldText(output, "direction"), "x");
  EXPECT_EQ(fieldText(output, "sides"), "insulated");
  EXPECT_EQ(fieldText(output, "lattice"), "d2q5");
  EXPECT_EQ(fieldText(output, "pixel_size_source"), "option");
  EXPECT_EQ(phaseNames(output).names(), (std::vector<std::string>{ "a", "b", "c" }));
  EXPECT_NE(provenance(output).find("steady_diffusion"), std::string::npos);
  EXPECT_EQ(description(points(output, "flux"))[0], "conductivity/m");
}

// Layers of three nodes across 36: halves (18) and thirds (12) hold whole pairs of them, so all windows are alike and
// the picture speaks for all of its material.
TEST(SteadyDiffusion, WindowsOfARegularPictureAreAlike)
{
  const auto filter = solver(picture(36, 24, 1, layersAcrossX), vtkSteadyDiffusion::ALL);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_FALSE(filter->GetOutput()->GetFieldData()->HasArray("window_error")); // not asked for
  filter->EstimateWindowErrorOn();
  ASSERT_EQ(errorOf(filter), "");
  vtkImageData* const output = filter->GetOutput();
  constexpr double windows = 1e-3; // to which they are solved
  EXPECT_LT(fieldNumbers(output, "window_error").at(0), windows);
  EXPECT_NEAR(fieldNumbers(output, "window_low").at(0), series, windows * series);
  EXPECT_NEAR(fieldNumbers(output, "window_high").at(1), parallel, windows * parallel);
  EXPECT_TRUE(std::isnan(fieldNumbers(output, "window_low").at(2)));

  // 7 nodes make no two windows of four.
  const auto small = solver(picture(7, 7, 1, layersAcrossX), vtkSteadyDiffusion::X);
  small->EstimateWindowErrorOn();
  ASSERT_EQ(errorOf(small), ""); // it warns
  EXPECT_TRUE(std::isnan(fieldNumbers(small->GetOutput(), "window_error").at(0)));
}

// More and more of what conducts towards high x: layers, which no scatter tells. Their values are those of the shares.
TEST(SteadyDiffusion, WindowsTellAGradient)
{
  const auto image = picture(72, 72, 1,
    [](int x, int y, int) {
      return y % 4 < (x < 24 ? 1 : x < 48 ? 2 : 3) ? 1 : 0;
    });
  const auto filter = solver(image, vtkSteadyDiffusion::ALL);
  filter->EstimateWindowErrorOn();
  ASSERT_EQ(errorOf(filter), "");
  vtkImageData* const output = filter->GetOutput();
  EXPECT_EQ(fieldNumbers(output, "window_gradient").at(0), 0); // of both values along x
  EXPECT_EQ(fieldNumbers(output, "window_gradient").at(1), 0);
  // Along y slabs of series: 1/(1 − s + s/10) for shares of a quarter, a half, three quarters; side by side. In the
  // picture some flux passes from slab to slab, which raises its value a little.
  EXPECT_NEAR(
    fieldNumbers(output, "layered_conductivity").at(1) / fieldNumbers(output, "effective_conductivity").at(4), 1, 5e-3);
}

TEST(SteadyDiffusion, PhasesMayBeAnyWholeNumbers)
{
  const auto image = picture(24, 18, 1, layersAcrossX);
  vtkNew<vtkIntArray> grain;
  grain->SetName("grain");
  vtkNew<vtkFloatArray> whole;
  whole->SetName("whole");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const bool b = points(image, "phase")->GetTuple1(i) > 0;
    grain->InsertNextValue(b ? 70000 : -3);
    whole->InsertNextValue(b ? 1.0F : 0.0F);
  }
  image->GetPointData()->AddArray(grain);
  image->GetPointData()->AddArray(whole);
  for (const char* const name : { "grain", "whole" })
  {
    const auto filter = solver(image, vtkSteadyDiffusion::X);
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name);
    filter->SetConductivity("70000", 10);
    filter->SetConductivity("-3", 1);
    ASSERT_EQ(errorOf(filter), "") << name;
    EXPECT_NEAR(filter->GetEffectiveConductivity()[0], series, exact * series) << name;
    const std::string ids = fieldText(filter->GetOutput(), "phase_array").value();
    EXPECT_EQ(ids, std::string(name) + "_id");
    EXPECT_EQ(points(filter->GetOutput(), ids.c_str())->GetDataType(), VTK_UNSIGNED_CHAR);
  }
}

TEST(SteadyDiffusion, ConductivityByNumberWherePhasesHaveNoNames)
{
  const auto image = picture(24, 18, 1, layersAcrossX);
  image->GetFieldData()->RemoveArray("phase_names");
  vtkNew<vtkSteadyDiffusion> filter;
  filter->SetInputData(image);
  filter->SetConductivity("0", 1);
  filter->SetConductivity("1", 10);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_NEAR(filter->GetEffectiveConductivity()[0], series, exact * series);
}

TEST(SteadyDiffusion, ProgressRisesAndAbortLeavesNothing)
{
  const auto filter = solver(picture(40, 40, 1, vtktest::blobs), vtkSteadyDiffusion::ALL);
  filter->EstimateErrorOn();
  std::vector<double> seen;
  vtkNew<vtkCallbackCommand> watch;
  watch->SetClientData(&seen);
  watch->SetCallback([](vtkObject* caller, unsigned long, void* client, void*)
    { static_cast<std::vector<double>*>(client)->push_back(vtkAlgorithm::SafeDownCast(caller)->GetProgress()); });
  filter->AddObserver(vtkCommand::ProgressEvent, watch);
  ASSERT_EQ(errorOf(filter), "");
  ASSERT_GT(seen.size(), 4U);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));

  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*)
    {
      auto* const algorithm = vtkAlgorithm::SafeDownCast(caller);
      if (algorithm->GetProgress() > 0.2)
        algorithm->SetAbortExecute(1);
    });
  filter->AddObserver(vtkCommand::ProgressEvent, stop);
  filter->Modified();
  const std::size_t all = seen.size();
  seen.clear();
  EXPECT_EQ(errorOf(filter), ""); // cancelling is no error
  EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_LT(seen.size(), all / 2 + 1); // VTK itself says "done" at the end
}

/// Layers across x, 3 nodes thick, whose walls run at an angle to x that differs between the two phases.
vtkSmartPointer<vtkImageData> directedLayers(double ofA, double ofB)
{
  const auto image = picture(12, 9, 1, layersAcrossX);
  vtkNew<vtkFloatArray> axis;
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  for (int node = 0; node < 12 * 9; ++node)
  {
    const double angle = layersAcrossX(node % 12, 0, 0) == 0 ? ofA : ofB;
    axis->InsertNextTuple3(-2 * std::cos(angle), -2 * std::sin(angle), 0); // neither length nor sign matters
  }
  image->GetPointData()->AddArray(axis);
  return image;
}

/// Layers across x of a volume, whose voxels have a tensor each.
vtkSmartPointer<vtkImageData> tensorLayers(int components)
{
  const auto image = picture(12, 6, 5, layersAcrossX);
  vtkNew<vtkFloatArray> tensor;
  tensor->SetName("tensor");
  tensor->SetNumberOfComponents(components);
  for (int node = 0; node < 12 * 6 * 5; ++node)
  {
    const bool a = layersAcrossX(node % 12, 0, 0) == 0;
    const std::array<float, 9> rows = a ? std::array<float, 9>{ 1, 0, 0, 0, 4, 0.5F, 0, 0.5F, 3 }
                                        : std::array<float, 9>{ 2, 0, 0, 0, 10, -1, 0, -1, 6 };
    const std::array<float, 6> entries{ rows[0], rows[4], rows[8], rows[1], rows[5], rows[2] };
    components == 9 ? tensor->InsertNextTuple(rows.data()) : tensor->InsertNextTuple(entries.data());
  }
  image->GetPointData()->AddArray(tensor);
  return image;
}

TEST(SteadyDiffusion, ConductivitiesThatAreTensors)
{
  // in series across the layers, in parallel along them, y and z together
  const auto check = [](vtkSteadyDiffusion* filter)
  {
    ASSERT_EQ(errorOf(filter), "");
    const double* const k = filter->GetEffectiveConductivity();
    const std::array<double, 9> expected{ 2 / (1.0 / 1 + 1.0 / 2), 0, 0, 0, 7, -0.25, 0, -0.25, 4.5 };
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_NEAR(k[i], expected[i], 1e-5) << i; // the tensors are floats
    vtkImageData* const output = filter->GetOutput();
    EXPECT_EQ(fieldText(output, "lattice").value_or(""), "q1");
    const std::vector<double> tensors = fieldNumbers(output, "phase_conductivity_tensor");
    ASSERT_GE(tensors.size(), 12U);
    EXPECT_EQ(std::vector<double>(tensors.begin(), tensors.begin() + 6), (std::vector<double>{ 1, 4, 3, 0, 0.5, 0 }));
    const double largest = 8 + std::sqrt(5.0); // of b, of y and z
    EXPECT_NEAR(fieldNumbers(output, "phase_conductivity").at(1), largest, 1e-5);
    EXPECT_NE(provenance(output).find("[1.0,4.0,3.0,0.0,0.5,0.0]"), std::string::npos) << provenance(output);
  };
  for (const int components : { 6, 9 })
  {
    vtkNew<vtkSteadyDiffusion> filter;
    filter->SetInputData(tensorLayers(components));
    filter->SetSides(vtkSteadyDiffusion::PERIODIC);
    check(filter);
    filter->SetConductivityTensor("a", components == 6 ? "1 4 3 0 0.5 0" : "1 0 0 0 4 0.5 0 0.5 3");
    check(filter); // the other phase has that of its voxels
    filter->SetConductivityTensor("b", "2 10 6 0 -1 0");
    check(filter);
    filter->RemoveAllConductivityTensors();
    check(filter);
    filter->SetConductivity("a", 1); // what a phase is given goes before what its voxels have
    ASSERT_EQ(errorOf(filter), "");
    EXPECT_NEAR(filter->GetEffectiveConductivity()[4], (1 + 10) / 2.0, 0.05); // y and z of b are coupled
  }
}

TEST(SteadyDiffusion, TensorsThatWillNotDo)
{
  const auto refused = [](auto&& change)
  {
    const auto image = tensorLayers(6);
    vtkNew<vtkSteadyDiffusion> filter;
    filter->SetInputData(image);
    filter->SetDirection(vtkSteadyDiffusion::X);
    filter->SetConductivity("a", 1);
    change(filter.Get(), image.Get());
    return errorOf(filter);
  };
  const auto has = [](const std::string& told, const char* words)
  { EXPECT_NE(told.find(words), std::string::npos) << told; };
  const auto given = [&](const char* phase, const char* numbers)
  { return refused([&](auto* f, vtkImageData*) { f->SetConductivityTensor(phase, numbers); }); };
  has(given("b", "1 1 x"), "'x' of the conductivity of 'b' is no number");
  has(given("b", "1 1"), "2 numbers for the conductivity of 'b'");
  has(given("b", "1 0 0 0 1 0 0.5 0 1"), "xz 0 and zx 0.5");
  has(given("b", "1 1 1 2 0 0"), "of phase 'b' is not positive definite: its least principal value is -1");
  has(given("a", "1 1 1"), "phase 'a' has a conductivity and a tensor");
  has(refused([](auto* f, vtkImageData*) { f->SetLattice(vtkSteadyDiffusion::D3Q7); }), "tensors on d3q7");
  has(refused([](auto* f, vtkImageData*) { f->SetMembrane("a-b", 1); }),
    "membranes between phases that conduct differently");
  has(refused([](auto* f, vtkImageData*)
        { f->SetInputArrayToProcess(2, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "none"); }),
    "phase 'b' has no conductivity");
  has(refused([](auto*, vtkImageData* image)
        { image->GetPointData()->GetArray("tensor")->SetComponent(12 * 6 * 2 + 12 * 3 + 4, 3, -9); }),
    "at voxel (4, 3, 2) is not positive definite");
}

TEST(SteadyDiffusion, ConductivitiesAlongAndAcrossTheWalls)
{
  const double half = vtkMath::Pi() / 2;
  // a: 1 along x, 4 along y; b: 2 along x, 10 along y
  const auto filter = solver(directedLayers(half, 0), vtkSteadyDiffusion::ALL);
  filter->SetConductivity("a", 4);
  filter->SetConductivityAcross("a", 1);
  filter->SetConductivity("b", 2);
  filter->SetConductivityAcross("b", 10);
  filter->EstimateErrorOn();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_NEAR(filter->GetEffectiveConductivity()[0], 2 / (1.0 / 1 + 1.0 / 2), 1e-6); // the axes are floats
  EXPECT_NEAR(filter->GetEffectiveConductivity()[4], (4 + 10) / 2.0, 1e-6);
  EXPECT_LT(fieldNumbers(filter->GetOutput(), "lattice_error").at(0), 1e-6); // exact at any resolution
  EXPECT_GT(filter->GetEstimatedError(), 1e-6);                              // but layers of three pixels
  vtkImageData* const output = filter->GetOutput();
  EXPECT_EQ(fieldNumbers(output, "phase_conductivity"), (std::vector<double>{ 4, 2, 0 }));
  EXPECT_EQ(fieldNumbers(output, "phase_conductivity_across"), (std::vector<double>{ 1, 10, 0 }));
  EXPECT_EQ(fieldText(output, "lattice").value_or(""), "d2q9");
  const std::vector<double> bounds = fieldNumbers(output, "bounds"); // of the smaller and of the larger ones
  EXPECT_DOUBLE_EQ(bounds[0], 2 / (1.0 / 1 + 1.0 / 2));
  EXPECT_DOUBLE_EQ(bounds[3], 7);
  EXPECT_NE(provenance(output).find("[4.0,1.0]"), std::string::npos) << provenance(output);

  // Periodic, one tensor everywhere: it is its own effective one, and in the axes of the data.
  const auto uniform = solver(directedLayers(0.5, 0.5), vtkSteadyDiffusion::ALL);
  for (const char* const phase : { "a", "b" })
  {
    uniform->SetConductivity(phase, 3);
    uniform->SetConductivityAcross(phase, 1);
  }
  uniform->SetSides(vtkSteadyDiffusion::PERIODIC);
  ASSERT_EQ(errorOf(uniform), "");
  const double* const k = uniform->GetEffectiveConductivity();
  const double c = std::cos(0.5);
  const double s = std::sin(0.5);
  EXPECT_NEAR(k[0], 3 * c * c + s * s, 1e-6);
  EXPECT_NEAR(k[1], 2 * c * s, 1e-6);
  EXPECT_NEAR(k[3], 2 * c * s, 1e-6);
  EXPECT_NEAR(k[4], 3 * s * s + c * c, 1e-6);
  // Forgotten again: five-point links, no second values.
  uniform->RemoveAllConductivitiesAcross();
  EXPECT_TRUE(std::isnan(uniform->GetConductivityAcross("a")));
  ASSERT_EQ(errorOf(uniform), "");
  EXPECT_NEAR(uniform->GetEffectiveConductivity()[0], 3, 1e-7);
  EXPECT_TRUE(fieldNumbers(uniform->GetOutput(), "phase_conductivity_across").empty());
}

TEST(SteadyDiffusion, ConductivitiesAcrossThatCannotBe)
{
  struct Case
  {
    const char* what;
    std::function<void(vtkSteadyDiffusion*, vtkImageData*)> spoil;
    std::vector<const char*> words;
  };
  const std::vector<Case> cases{
    { "no axis", [](auto*, auto* i) { i->GetPointData()->RemoveArray("axis"); },
      { "no point array 'axis'", "MicrographLattice", "one conductivity a phase" } },
    { "another axis", [](auto* f, auto*) { f->SetInputArrayToProcess(1, 0, 0, 0, "grain"); },
      { "no point array 'grain'" } },
    { "one component", [](auto* f, auto*) { f->SetInputArrayToProcess(1, 0, 0, 0, "phase"); },
      { "'phase' has 1 components" } },
    { "zero", [](auto*, auto* i) { i->GetPointData()->GetArray("axis")->Fill(0); }, { "54 nodes", "have no axis" } },
    { "ratio",
      [](auto* f, auto*)
      {
        f->SetConductivityAcross("a", 0.1);
        f->SetLattice(vtkSteadyDiffusion::D2Q9);
      },
      { "a ratio of 10", "28.6", "5.82", "q1" } },
    { "negative", [](auto* f, auto*) { f->SetConductivityAcross("a", -1); }, { "'a' is -1" } },
    { "none along", [](auto* f, auto*) { f->SetConductivityAcross("c", 1); },
      { "'c' has a conductivity across the wall and none" } },
    { "lattice", [](auto* f, auto*) { f->SetLattice(vtkSteadyDiffusion::D2Q5); }, { "on d2q5", "d2q9" } },
  };
  for (const Case& test : cases)
  {
    const auto image = directedLayers(0.5, 0.5);
    const auto filter = solver(image, vtkSteadyDiffusion::X);
    filter->SetConductivityAcross("a", 0.5);
    test.spoil(filter.Get(), image.Get());
    const std::string error = errorOf(filter);
    for (const char* const word : test.words)
      EXPECT_NE(error.find(word), std::string::npos) << test.what << ": " << error;
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0) << test.what;
  }
  const auto volume = solver(picture(4, 4, 4, layersAcrossX), vtkSteadyDiffusion::X);
  volume->SetConductivityAcross("a", 0.5);
  EXPECT_NE(errorOf(volume).find("no point array 'axis'"), std::string::npos);
  volume->SetLattice(vtkSteadyDiffusion::D3Q7);
  EXPECT_NE(errorOf(volume).find("q1"), std::string::npos);
}

/// One material with a direction of its own in space: its tensor, of any ratio, with every kind of sides.
TEST(SteadyDiffusion, VolumesConductAlongAndAcross)
{
  const vtkSmartPointer<vtkImageData> image = picture(6, 7, 8, [](int, int, int) { return 1; });
  vtkNew<vtkFloatArray> axis;
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    axis->InsertNextTuple3(2, -1, 2);
  image->GetPointData()->AddArray(axis);
  const auto filter = solver(image, vtkSteadyDiffusion::ALL);
  filter->SetConductivityAcross("b", 0.5);
  filter->SetSides(vtkSteadyDiffusion::PERIODIC);
  ASSERT_EQ(errorOf(filter), "");
  const double a[3] = { 2.0 / 3, -1.0 / 3, 2.0 / 3 };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(filter->GetEffectiveConductivity()[3 * i + j], (i == j ? 0.5 : 0.0) + 9.5 * a[i] * a[j], 1e-6);
  EXPECT_EQ(lamella::fieldText(filter->GetOutput(), "lattice").value_or(""), "q1");
  filter->SetSides(vtkSteadyDiffusion::MIXED);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_NEAR(filter->GetEffectiveConductivity()[0], 0.5 + 9.5 * a[0] * a[0], 1e-6);
  filter->SetSides(vtkSteadyDiffusion::INSULATED); // what would leave through the sides does not
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_GT(filter->GetEffectiveConductivity()[0], 1);
  EXPECT_LT(filter->GetEffectiveConductivity()[0], 0.7 * (0.5 + 9.5 * a[0] * a[0]));
}

TEST(SteadyDiffusion, InputThatCannotBeUsedIsRefusedInWords)
{
  const auto image = picture(8, 8, 1, layersAcrossX);
  struct Case
  {
    const char* what;
    std::function<void(vtkSteadyDiffusion*, vtkImageData*)> spoil;
    std::vector<const char*> words;
  };
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Case> cases{
    { "no array", [](auto* f, auto*) { f->SetInputArrayToProcess(0, 0, 0, 0, "grain"); },
      { "no point array 'grain'", "there are: phase" } },
    { "cells",
      [](auto* f, auto* i)
      {
        i->GetCellData()->AddArray(adopt(std::vector<std::uint8_t>(49), "grain"));
        f->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, "grain");
      },
      { "'grain' is cell data", "hint: " } },
    { "components",
      [](auto* f, auto* i)
      {
        vtkNew<vtkIntArray> two;
        two->SetName("two");
        two->SetNumberOfComponents(2);
        two->SetNumberOfTuples(64);
        two->Fill(0);
        i->GetPointData()->AddArray(two);
        f->SetInputArrayToProcess(0, 0, 0, 0, "two");
      },
      { "'two' has 2 components" } },
    { "not whole",
      [](auto* f, auto* i)
      {
        vtkNew<vtkFloatArray> half;
        half->SetName("half");
        half->SetNumberOfTuples(64);
        half->Fill(0.5);
        i->GetPointData()->AddArray(half);
        f->SetInputArrayToProcess(0, 0, 0, 0, "half");
      },
      { "'half' holds 0.5", "whole numbers" } },
    { "not finite",
      [](auto* f, auto* i)
      {
        vtkNew<vtkFloatArray> bad;
        bad->SetName("bad");
        bad->SetNumberOfTuples(64);
        bad->Fill(std::nan(""));
        i->GetPointData()->AddArray(bad);
        f->SetInputArrayToProcess(0, 0, 0, 0, "bad");
      },
      { "'bad' holds nan" } },
    { "too many",
      [](auto* f, auto* i)
      {
        vtkNew<vtkIntArray> many;
        many->SetName("many");
        for (int n = 0; n < 400; ++n)
          many->InsertNextValue(n);
        i->SetDimensions(20, 20, 1);
        i->GetPointData()->Initialize();
        i->GetPointData()->AddArray(many);
        f->SetInputArrayToProcess(0, 0, 0, 0, "many");
      },
      { "more than 256 different values" } },
    { "no conductivity", [](auto* f, auto*) { f->RemoveConductivity("b"); },
      { "phase 'b' has no conductivity", "24 nodes", "a, b" } },
    { "negative", [](auto* f, auto*) { f->SetConductivity("b", -1); }, { "'b' is -1" } },
    { "nan", [](auto* f, auto*) { f->SetConductivity("b", std::nan("")); }, { "'b' is nan" } },
    { "infinite", [inf](auto* f, auto*) { f->SetConductivity("b", inf); }, { "'b' is inf" } },
    { "no path", [](auto* f, auto*) { f->SetConductivity("b", 0); }, { "no conducting path", "along x" } },
    { "z in 2D", [](auto* f, auto*) { f->SetDirection(vtkSteadyDiffusion::Z); }, { "two-dimensional" } },
    { "lattice", [](auto* f, auto*) { f->SetLattice(vtkSteadyDiffusion::D3Q7); }, { "d3q7", "d2q5" } },
    { "spacing", [](auto*, auto* i) { i->SetSpacing(1, -3, 1); }, { "spacings are positive" } },
    { "no spacing", [](auto*, auto* i) { i->SetSpacing(1, 0, 1); }, { "spacings are positive" } },
    { "diagonals",
      [](auto* f, auto* i)
      {
        i->SetSpacing(1, 3, 1);
        f->SetLattice(vtkSteadyDiffusion::D2Q9);
      },
      { "go with straight links", "d2q9" } },
    { "empty", [](auto*, auto* i) { i->Initialize(); }, { "has no nodes" } },
  };
  for (const Case& test : cases)
  {
    vtkNew<vtkImageData> input;
    input->DeepCopy(image);
    const auto filter = solver(input, vtkSteadyDiffusion::X);
    test.spoil(filter.Get(), input.Get());
    const std::string error = errorOf(filter);
    for (const char* const word : test.words)
      EXPECT_NE(error.find(word), std::string::npos) << test.what << ": " << error;
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0) << test.what;
  }
}

} // namespace
