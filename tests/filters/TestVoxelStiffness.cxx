// Stiffness by elements through VTK's pipeline: numbers and tables are the solver's; fields of a load; materials as
// people say them; what is across a picture's plane; on distributed images all is that of one rank; what is refused.
#include "OnRanks.h"
#include "StiffnessSample.h"
#include "VtkTesting.h"

#include "elasticity/VoxelStiffness.h"
#include "vtkVoxelStiffness.h"

#include "vtkExtentTranslator.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkOutputWindow.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkTrivialProducer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <sstream>

namespace
{

using namespace lamella;
using vtktest::errorOf;
using vtktest::layersWithAHole;
using vtktest::picture;
namespace el = lamella::elasticity;

class VoxelStiffness : public vtktest::OnRanks
{
protected:
  static void SetUpTestSuite()
  {
    OnRanks::SetUpTestSuite();
    vtkOutputWindow::GetInstance()->SetDisplayModeToNever(); // warnings of seams
  }
};

void configure(vtkVoxelStiffness* filter)
{
  filter->SetYoungsModulus("wall", 4e9);
  filter->SetYoungsModulus("lamella", 1e9);
  filter->SetPoissonsRatio("lamella", 0.4);
  filter->SetTolerance(1e-10);
}

std::vector<el::VoxelMaterial> materials(el::Continuum continuum)
{
  return { { el::voidStiffness(continuum), {}, false, {} },
    { el::isotropicStiffness(continuum, 4e9, 0.3), {}, false, {} },
    { el::isotropicStiffness(continuum, 1e9, 0.4), {}, false, {} } };
}

TEST_F(VoxelStiffness, IsTheSolver)
{
  for (const int nz : { 1, 8 })
  {
    SCOPED_TRACE(nz);
    const auto image = layersWithAHole(nz);
    vtkNew<vtkVoxelStiffness> filter;
    configure(filter);
    filter->SetInputData(image);
    ASSERT_EQ(errorOf(filter), "");
    vtkImageData* const output = filter->GetImage();
    EXPECT_EQ(vtktest::points(output, "phase"), vtktest::points(image, "phase")); // passed on, not copied

    const PhaseView view = viewPhases(image);
    const int d = view.lattice.dimension;
    el::VoxelStiffnessOptions options;
    options.tolerance = 1e-10;
    const el::VoxelStiffness r = el::studyVoxelStiffness(
      view.lattice, view.phase, materials(d == 3 ? el::Continuum::Space : el::Continuum::PlaneStress), {}, options);
    EXPECT_EQ(fieldNumbers(output, "stiffness"), r.stiffness);
    EXPECT_EQ(fieldNumbers(output, "stiffness_extrapolated"), r.error.extrapolated);
    EXPECT_EQ(fieldNumbers(output, "stiffness_error"), r.error.components);
    EXPECT_EQ(fieldNumbers(output, "stiffness_voigt"), r.voigt);
    EXPECT_EQ(fieldNumbers(output, "constants"), el::constantValues(r.constants));
    EXPECT_EQ(filter->GetEstimatedError(), r.error.relative);
    EXPECT_EQ(fieldTexts(output, "stiffness_components"), el::voigtNames(d));
    EXPECT_EQ(fieldTexts(output, "warnings"), r.warnings);
    EXPECT_GT(fieldNumbers(output, "step_every").size(), 1U);
    EXPECT_NE(provenance(output).find("\"voxel_stiffness\""), std::string::npos);
    EXPECT_EQ(output->GetPointData()->GetArray("stress"), nullptr); // no load

    const std::size_t n = d == 3 ? 6 : 3;
    vtkTable* const tensor = filter->GetTensor();
    ASSERT_EQ(tensor->GetNumberOfRows(), static_cast<vtkIdType>(n));
    ASSERT_EQ(tensor->GetNumberOfColumns(), static_cast<vtkIdType>(1 + 3 * n));
    EXPECT_EQ(tensor->GetValueByName(1, "yy").ToDouble(), r.stiffness[n + 1]);
    vtkTable* const constants = filter->GetConstants();
    ASSERT_EQ(constants->GetNumberOfRows(), d == 3 ? 12 : 5);
    EXPECT_EQ(constants->GetValueByName(1, "value").ToDouble(), r.constants.youngsModulus[1]);
    EXPECT_EQ(fieldNumbers(tensor, "stiffness"), r.stiffness);
    // Young's modulus along x and y, by direction
    vtkPolyData* const directions = filter->GetDirections();
    ASSERT_GT(directions->GetNumberOfPoints(), 300);
    EXPECT_EQ(fieldText(directions, "length_unit"), "1");
    auto* const modulus = directions->GetPointData()->GetArray("youngs_modulus");
    double nearest = 0;
    double found = 0;
    for (vtkIdType i = 0; i < directions->GetNumberOfPoints(); ++i)
      if (const double x = directions->GetPointData()->GetArray("direction")->GetComponent(i, 0); x > nearest)
      {
        nearest = x;
        found = modulus->GetTuple1(i);
      }
    EXPECT_NEAR(found, r.constants.youngsModulus[0], (d == 2 ? 1e-6 : 1e-2) * found);
    // what is least and most over all directions is so of those of the shape, and has its place
    const std::vector<double> extremes = fieldNumbers(output, "extremes");
    ASSERT_EQ(extremes.size(), 6U);
    EXPECT_EQ(fieldNumbers(output, "extreme_directions").size(), 18U);
    EXPECT_EQ(fieldNumbers(output, "extreme_across").size(), 18U);
    const auto rangeOf = [&](const std::string& least, const std::string& most)
    {
      vtkDataArray* const low = directions->GetPointData()->GetArray(least.c_str());
      vtkDataArray* const high = directions->GetPointData()->GetArray(most.c_str());
      EXPECT_EQ(description(low)[0], least.starts_with("poisson") ? "1" : "Pa");
      return std::array{ low->GetRange()[0], high->GetRange()[1] };
    };
    const std::array<std::array<double, 2>, 3> shown{ rangeOf("youngs_modulus", "youngs_modulus"),
      rangeOf(d == 3 ? "shear_modulus_least" : "shear_modulus", d == 3 ? "shear_modulus_most" : "shear_modulus"),
      rangeOf(d == 3 ? "poissons_ratio_least" : "poissons_ratio", d == 3 ? "poissons_ratio_most" : "poissons_ratio") };
    for (std::size_t k = 0; k < 3; ++k)
    {
      // directions of the shape are 1° and 4° apart; constants that vary threefold change by less than 1 % over half
      const double most = std::abs(shown[k][1]);
      EXPECT_NEAR(extremes[2 * k], shown[k][0], 0.01 * most) << k;
      EXPECT_NEAR(extremes[2 * k + 1], shown[k][1], 0.01 * most) << k;
      EXPECT_LE(extremes[2 * k], shown[k][0] + 1e-6 * most) << k;
      EXPECT_GE(extremes[2 * k + 1], shown[k][1] - 1e-6 * most) << k;
    }
    EXPECT_EQ(fieldNumbers(output, "hashin_shtrikman").size(), 4U);
    EXPECT_EQ(fieldNumbers(output, "hashin_shtrikman")[0], 0); // there is a void
  }
}

TEST_F(VoxelStiffness, StressesOfALoad)
{
  for (const int nz : { 1, 8 })
  {
    SCOPED_TRACE(nz);
    const auto image = layersWithAHole(nz);
    vtkNew<vtkVoxelStiffness> filter;
    configure(filter);
    filter->EstimateErrorOff();
    filter->SetMeanStrain("xx", 0.01);
    filter->SetMeanStress("yy", 0);
    filter->SetInputData(image);
    ASSERT_EQ(errorOf(filter), "");
    vtkImageData* const output = filter->GetImage();
    const std::vector<double> stress = fieldNumbers(output, "load_stress");
    const std::vector<double> strain = fieldNumbers(output, "load_strain");
    const double modulus = fieldNumbers(output, "constants")[0];
    EXPECT_NEAR(strain[0], 0.01, 1e-12);
    EXPECT_NEAR(stress[0], 0.01 * modulus, 1e-5 * stress[0]);
    for (std::size_t k = 1; k < stress.size(); ++k)
      EXPECT_NEAR(stress[k], 0, 1e-5 * stress[0]);
    auto* const array = vtkFloatArray::SafeDownCast(output->GetPointData()->GetArray("stress"));
    ASSERT_NE(array, nullptr);
    ASSERT_EQ(array->GetNumberOfComponents(), 6);
    double mean = 0;
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
    {
      mean += array->GetComponent(i, 0) / static_cast<double>(array->GetNumberOfTuples());
      if (vtktest::points(image, "phase")->GetTuple1(i) == 0)
        EXPECT_EQ(array->GetComponent(i, 0), 0);
    }
    EXPECT_NEAR(mean, stress[0], 1e-5 * stress[0]);
    EXPECT_EQ(description(array)[0], "Pa");
    EXPECT_NE(output->GetPointData()->GetArray("displacement"), nullptr);
    filter->ComputeStressOff();
    filter->ComputeTensorOff();
    filter->RemoveAllMeanStresses();
    ASSERT_EQ(errorOf(filter), "");
    EXPECT_EQ(filter->GetImage()->GetPointData()->GetArray("stress"), nullptr);
    EXPECT_EQ(filter->GetTensor()->GetNumberOfRows(), 0);
    EXPECT_TRUE(std::isnan(fieldNumbers(filter->GetImage(), "stiffness")[0]));
  }
}

TEST_F(VoxelStiffness, MaterialsAsPeopleSayThem)
{
  // a cubic tensor by its three numbers is the isotropic one that it stands for
  const auto image = layersWithAHole(8);
  vtkNew<vtkVoxelStiffness> filter;
  configure(filter);
  filter->EstimateErrorOff();
  filter->SetInputData(image);
  ASSERT_EQ(errorOf(filter), "");
  const std::vector<double> isotropic = fieldNumbers(filter->GetImage(), "stiffness");
  filter->RemoveAllYoungsModuli();
  filter->RemoveAllPoissonsRatios();
  filter->SetYoungsModulus("lamella", 1e9);
  filter->SetPoissonsRatio("lamella", 0.4);
  const double mu = 4e9 / 2.6;
  const double lambda = 2 * mu * 0.3 / 0.4;
  std::ostringstream numbers;
  numbers.precision(17);
  numbers << lambda + 2 * mu << ' ' << lambda << ' ' << mu;
  filter->SetStiffness("wall", numbers.str().c_str());
  ASSERT_EQ(errorOf(filter), "");
  const std::vector<double> cubic = fieldNumbers(filter->GetImage(), "stiffness");
  for (std::size_t i = 0; i < 36; ++i)
    EXPECT_NEAR(cubic[i], isotropic[i], 1e-5 * isotropic[0]);
  EXPECT_EQ(fieldNumbers(filter->GetImage(), "hashin_shtrikman").size(), 0U);

  // rigid: stiffer than a void; expansion of one phase
  const auto plane = layersWithAHole();
  vtkNew<vtkVoxelStiffness> stiff;
  configure(stiff);
  stiff->EstimateErrorOff();
  stiff->SetInputData(plane);
  ASSERT_EQ(errorOf(stiff), "");
  const double hollow = fieldNumbers(stiff->GetImage(), "stiffness")[0];
  stiff->AddRigid("void");
  stiff->SetExpansion("wall", 1e-5);
  ASSERT_EQ(errorOf(stiff), "");
  EXPECT_GT(fieldNumbers(stiff->GetImage(), "stiffness")[0], hollow);
  const std::vector<double> expansion = fieldNumbers(stiff->GetImage(), "expansion");
  ASSERT_EQ(expansion.size(), 3U);
  EXPECT_GT(expansion[0], 0);
  EXPECT_LT(expansion[0], 1e-5);

  // along an axis that every point has
  vtkNew<vtkFloatArray> axis;
  axis->SetName("axis");
  axis->SetNumberOfComponents(3);
  axis->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    axis->SetTuple3(i, 0, 2, 0);
  image->GetPointData()->AddArray(axis);
  vtkNew<vtkVoxelStiffness> wood;
  wood->SetInputData(image);
  wood->EstimateErrorOff();
  for (const char* const phase : { "void", "wall", "lamella" })
  {
    wood->SetYoungsModulus(phase, 8e9);
    wood->SetYoungsModulusAcross(phase, 2e9);
    wood->SetPoissonsRatio(phase, 0.25);
    wood->SetPoissonsRatioAcross(phase, 0.4);
    wood->SetShearModulus(phase, 1e9);
    wood->SetExpansion(phase, 1e-3);
    wood->SetExpansionAcross(phase, 1e-2);
  }
  ASSERT_EQ(errorOf(wood), "");
  const std::vector<double> constants = fieldNumbers(wood->GetImage(), "constants");
  EXPECT_NEAR(constants[0], 2e9, 1e4);
  EXPECT_NEAR(constants[1], 8e9, 4e4);
  EXPECT_NEAR(constants[11], 1e9, 1e4);
  EXPECT_NEAR(fieldNumbers(wood->GetImage(), "expansion")[1], 1e-3, 1e-8);
  EXPECT_NEAR(fieldNumbers(wood->GetImage(), "expansion")[0], 1e-2, 1e-7);
}

TEST_F(VoxelStiffness, ExpandsByAField)
{
  const auto image = layersWithAHole();
  vtkNew<vtkFloatArray> temperature;
  temperature->SetName("temperature");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
    temperature->InsertNextValue(0.5F);
  image->GetPointData()->AddArray(temperature);
  vtkNew<vtkVoxelStiffness> filter;
  configure(filter);
  filter->EstimateErrorOff();
  filter->SetExpansion("wall", 1e-5);
  filter->SetExpansion("lamella", 3e-5);
  filter->SetChange(40);
  filter->SetChangeArray("temperature");
  filter->SetMeanStress("xx", 0);
  filter->SetInputData(image);
  ASSERT_EQ(errorOf(filter), "");
  const std::vector<double> expansion = fieldNumbers(filter->GetImage(), "expansion");
  const std::vector<double> strain = fieldNumbers(filter->GetImage(), "load_strain");
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(strain[k], 20 * expansion[k], 1e-8);
  EXPECT_NE(filter->GetImage()->GetPointData()->GetArray("stress"), nullptr);
  filter->SetChangeArray("moisture");
  EXPECT_NE(errorOf(filter).find("no point array 'moisture'"), std::string::npos);
}

/// The value of a component in every point, which is to be the same but for single precision.
double uniform(vtkVoxelStiffness* filter, const char* name, int component)
{
  vtkDataArray* const array = vtktest::points(filter->GetImage(), name);
  const std::array<double, 2> range{ array->GetRange(component)[0], array->GetRange(component)[1] };
  const double largest = array->GetMaxNorm();
  EXPECT_LE(range[1] - range[0], 1e-5 * largest) << name << ' ' << component;
  return 0.5 * (range[0] + range[1]);
}

// Of one material a plane of a volume is under plane stress where nothing pulls across it, and under plane strain where
// that strain is held: what a picture has across its plane is what the volume has. Floats and the tolerance leave 1e-5.
TEST_F(VoxelStiffness, AcrossThePlaneAsInSpace)
{
  const auto nothing = [](int, int, int) { return 0; };
  struct Case
  {
    const char* what;
    std::function<void(vtkVoxelStiffness*)> give;
  };
  const std::array<Case, 4> cases{ {
    { "isotropic",
      [](vtkVoxelStiffness* f)
      {
        f->SetYoungsModulus("wall", 4e9);
        f->SetPoissonsRatio("wall", 0.4);
        f->SetExpansion("wall", 1e-4);
      } },
    { "with an axis",
      [](vtkVoxelStiffness* f)
      {
        f->SetYoungsModulus("wall", 8e9);
        f->SetYoungsModulusAcross("wall", 2e9);
        f->SetPoissonsRatio("wall", 0.25);
        f->SetPoissonsRatioAcross("wall", 0.45);
        f->SetShearModulus("wall", 1e9);
        f->SetExpansion("wall", 1e-5);
        f->SetExpansionAcross("wall", 2e-4);
      } },
    { "orthotropic",
      [](vtkVoxelStiffness* f)
      {
        f->SetStiffness("wall", "12e9 4e9 3e9 9e9 2.5e9 6e9 1e9 1.5e9 2e9");
        f->SetExpansion("wall", 1e-4);
      } },
    // z a plane of symmetry, x and y not: shears in the plane stretch across it
    { "monoclinic",
      [](vtkVoxelStiffness* f)
      {
        f->SetStiffness("wall", "12e9 4e9 3e9 0 0 1e9 9e9 2.5e9 0 0 -0.5e9 6e9 0 0 0.8e9 1e9 0.2e9 0 1.5e9 0 2e9");
        f->SetExpansion("wall", 1e-4);
      } },
  } };
  for (const Case& c : cases)
    for (const int plane : { vtkVoxelStiffness::PLANE_STRESS, vtkVoxelStiffness::PLANE_STRAIN })
    {
      SCOPED_TRACE(c.what);
      SCOPED_TRACE(plane);
      std::array<vtkNew<vtkVoxelStiffness>, 2> filters;
      for (std::size_t space = 0; space < 2; ++space)
      {
        const auto image = picture(6, 5, space != 0 ? 4 : 1, nothing, 1e-5);
        setFieldTexts(image, "phase_names", std::vector<std::string>{ "wall" });
        vtkNew<vtkFloatArray> axis;
        axis->SetName("axis");
        axis->SetNumberOfComponents(3);
        for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
          axis->InsertNextTuple3(2, 1, 0);
        image->GetPointData()->AddArray(axis);
        vtkVoxelStiffness* const filter = filters[space];
        c.give(filter);
        filter->SetPlane(plane);
        filter->SetTolerance(1e-10);
        filter->EstimateErrorOff();
        filter->SetMeanStress("xx", 5e6);
        filter->SetMeanStress("yy", -2e6);
        filter->SetMeanStress("xy", 3e6);
        if (space != 0 && plane == vtkVoxelStiffness::PLANE_STRAIN)
          filter->SetMeanStrain("zz", 0);
        filter->SetChange(3);
        filter->SetInputData(image);
        ASSERT_EQ(errorOf(filter), "");
      }
      for (const char* const name : { "strain", "stress" })
        for (const int component : { 0, 1, 2, 3 })
        {
          const double found = uniform(filters[0], name, component);
          const double exact = uniform(filters[1], name, component);
          const double largest = vtktest::points(filters[1]->GetImage(), name)->GetMaxNorm();
          EXPECT_NEAR(found, exact, 1e-5 * largest) << name << ' ' << component;
        }
      EXPECT_GT(std::abs(uniform(filters[0], plane == vtkVoxelStiffness::PLANE_STRESS ? "strain" : "stress", 2)), 0);
    }
}

// Layers of two materials across x under stress xx = S, free along y: ε_yy is e in both, and with σ_yy = E (e − α Δ) +
// ν S their mean is 0. So ε_zz = −ν/E (S + σ_yy) + α Δ in each.
TEST_F(VoxelStiffness, AcrossThePlaneOfALaminate)
{
  const auto image = picture(
    8, 4, 1, [](int x, int, int) { return x < 2 ? 0 : 1; }, 1e-5);
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "wall", "lamella" });
  const std::array<double, 2> young{ 4e9, 1e9 };
  const std::array<double, 2> poisson{ 0.3, 0.4 };
  const std::array<double, 2> expansion{ 1e-4, 5e-5 };
  constexpr double stress = 5e6;
  constexpr double change = 7;
  vtkNew<vtkVoxelStiffness> filter;
  for (std::size_t i = 0; i < 2; ++i)
  {
    const char* const name = i == 0 ? "wall" : "lamella";
    filter->SetYoungsModulus(name, young[i]);
    filter->SetPoissonsRatio(name, poisson[i]);
    filter->SetExpansion(name, expansion[i]);
  }
  filter->SetTolerance(1e-10);
  filter->EstimateErrorOff();
  filter->SetMeanStress("xx", stress);
  filter->SetChange(change);
  filter->SetInputData(image);
  ASSERT_EQ(errorOf(filter), "");
  const double stiff = 0.25 * young[0] + 0.75 * young[1];
  double pull = 0;
  for (std::size_t i = 0; i < 2; ++i)
    pull += (i == 0 ? 0.25 : 0.75) * (young[i] * expansion[i] * change - poisson[i] * stress);
  vtkDataArray* const strain = vtktest::points(filter->GetImage(), "strain");
  for (vtkIdType k = 0; k < strain->GetNumberOfTuples(); ++k)
  {
    const std::size_t i = k % 8 < 2 ? 0 : 1;
    const double side = young[i] * (pull / stiff - expansion[i] * change) + poisson[i] * stress;
    const double exact = -poisson[i] / young[i] * (stress + side) + expansion[i] * change;
    EXPECT_NEAR(strain->GetComponent(k, 2), exact, 1e-5 * strain->GetMaxNorm()) << k; // floats, and the tolerance
  }

  // of the plane's own tensor nobody knows; greys that are shares of a solid and a void have the solid's strain
  filter->RemoveAllYoungsModuli();
  filter->SetYoungsModulus("wall", young[0]);
  filter->RemoveAllExpansions();
  filter->SetStiffness("lamella", "1e9 3e8 1e9 4e8");
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_FALSE(std::isnan(vtktest::points(filter->GetImage(), "strain")->GetComponent(0, 2)));
  EXPECT_TRUE(std::isnan(vtktest::points(filter->GetImage(), "strain")->GetComponent(7, 2)));

  const auto grey = picture(
    8, 4, 1, [](int, int, int) { return 100; }, 1e-5);
  grey->GetFieldData()->Initialize(); // greys have no names
  for (const int plane : { vtkVoxelStiffness::PLANE_STRESS, vtkVoxelStiffness::PLANE_STRAIN })
  {
    vtkNew<vtkVoxelStiffness> half;
    half->SetShares(0, 200);
    half->SetPlane(plane);
    half->SetYoungsModulus("high", young[0]);
    half->SetExpansion("high", expansion[0]);
    half->EstimateErrorOff();
    half->SetMeanStress("xx", stress);
    half->SetChange(change);
    half->SetInputData(grey);
    ASSERT_EQ(errorOf(half), "");
    if (plane == vtkVoxelStiffness::PLANE_STRESS)
      EXPECT_NEAR(uniform(half, "strain", 2), -0.3 * stress / (0.5 * young[0]) + expansion[0] * change, 1e-8);
    else // half of the solid's, which is under twice the stress
      EXPECT_NEAR(
        uniform(half, "stress", 2), 0.5 * (0.3 * 2 * stress - young[0] * expansion[0] * change), 1e-5 * stress);
  }
}

TEST_F(VoxelStiffness, WhatIsRefused)
{
  const auto fails =
    [](const std::function<void(vtkVoxelStiffness*, vtkImageData*)>& change, const char* message, int failure)
  {
    SCOPED_TRACE(message);
    const auto image = layersWithAHole();
    vtkNew<vtkVoxelStiffness> filter;
    configure(filter);
    filter->SetInputData(image);
    change(filter, image);
    const std::string error = errorOf(filter);
    EXPECT_NE(error.find(message), std::string::npos) << error;
    EXPECT_NE(error.find("hint: "), std::string::npos) << error;
    EXPECT_EQ(filter->GetFailure(), failure);
    EXPECT_EQ(filter->GetTensor()->GetNumberOfRows(), 0);
  };
  constexpr int parameter = vtkVoxelStiffness::PARAMETER_FAILURE;
  fails([](auto* f, auto*) { f->RemoveAllYoungsModuli(); }, "have no Young's modulus", parameter);
  fails([](auto* f, auto*) { f->SetPoissonsRatio("wall", 1); }, "a Poisson's ratio of 1", parameter);
  fails([](auto* f, auto*) { f->SetPoissonsRatio("wall", -1); }, "a Poisson's ratio of -1", parameter);
  fails(
    [](auto* f, auto*)
    {
      f->SetPlane(vtkVoxelStiffness::PLANE_STRAIN);
      f->SetPoissonsRatio("wall", 0.5);
    },
    "a Poisson's ratio of 0.5", parameter);
  fails(
    [](auto* f, auto*)
    {
      f->RemoveAllYoungsModuli();
      f->SetYoungsModulus("lamella", 1);
      f->SetStiffness("wall", "1 2 1 1");
    },
    "is not positive definite", parameter);
  fails(
    [](auto* f, auto*)
    {
      f->RemoveAllYoungsModuli();
      f->SetYoungsModulus("lamella", 1);
      f->SetStiffness("wall", "1 2 x");
    },
    "'x' of the stiffness of 'wall' is no number", parameter);
  fails([](auto* f, auto*) { f->SetYoungsModulusAcross("wall", 1e9); }, "the image has no point array 'axis'",
    vtkVoxelStiffness::INPUT_FAILURE);
  fails([](auto* f, auto*) { f->AddRigid("wall"); }, "is to be rigid and has a stiffness", parameter);
  fails([](auto* f, auto*) { f->AddRigid("glue"); }, "'glue' is to be rigid, and is no phase", parameter);
  fails([](auto* f, auto*) { f->SetMeanStrain("zz", 0.1); }, "a mean strain 'zz' of a picture", parameter);
  fails([](auto* f, auto*) { f->ComputeTensorOff(); }, "neither the tensor nor the stresses of a load", parameter);
  fails(
    [](auto* f, auto*) { f->SetMaximumIterations(1); }, "after 1 iterations", vtkVoxelStiffness::DIVERGENCE_FAILURE);
  fails(
    [](auto* f, auto*)
    {
      f->SetSides(vtkVoxelStiffness::GRIP);
      f->SetMeanStrain("xy", 0.1);
    },
    "between platens", parameter);
  fails(
    [](auto*, auto* image)
    {
      vtkDataArray* const phase = vtktest::points(image, "phase");
      for (vtkIdType i = 0; i < phase->GetNumberOfTuples(); ++i)
        phase->SetTuple1(i, i % 24 < 12 && i / 24 < 12 ? 1 : 0);
    },
    "leads across the box along no axis", vtkVoxelStiffness::NO_PATH_FAILURE);
}

TEST_F(VoxelStiffness, RanksChangeNothing)
{
  for (const int nz : { 1, 8 })
  {
    const auto image = layersWithAHole(nz);
    const auto load = [](vtkVoxelStiffness* filter)
    {
      configure(filter);
      filter->SetMeanStrain("xx", 0.01);
    };
    vtkNew<vtkVoxelStiffness> alone;
    load(alone);
    alone->SetInputData(image);
    alone->UpdatePiece(0, 1, 0);
    vtkImageData* const whole = alone->GetImage();
    ASSERT_GT(whole->GetNumberOfPoints(), 0);
    vtkNew<vtkExtentTranslator> translator;
    translator->SetWholeExtent(image->GetExtent());
    translator->SetNumberOfPieces(ranks());
    translator->SetPiece(rank());
    translator->SetSplitModeToXSlab();
    translator->PieceToExtent();
    vtkNew<vtkImageData> piece;
    piece->DeepCopy(image);
    piece->Crop(translator->GetExtent());
    vtkNew<vtkTrivialProducer> producer;
    producer->SetOutput(piece);
    producer->SetWholeExtent(image->GetExtent());
    vtkNew<vtkVoxelStiffness> together;
    load(together);
    together->SetInputConnection(producer->GetOutputPort());
    together->UpdatePiece(rank(), ranks(), 0);
    vtkImageData* const part = together->GetImage();
    if (rank() == 0)
      EXPECT_EQ(fieldNumbers(part, "stiffness"), fieldNumbers(whole, "stiffness"));
    EXPECT_EQ(together->GetTensor()->GetNumberOfRows(), rank() != 0 ? 0 : nz == 1 ? 3 : 6);
    for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
    {
      std::array<double, 3> place{};
      part->GetPoint(i, place.data());
      const vtkIdType same = whole->FindPoint(place.data());
      ASSERT_GE(same, 0);
      EXPECT_EQ(part->GetPointData()->GetArray("stress")->GetComponent(i, 1),
        whole->GetPointData()->GetArray("stress")->GetComponent(same, 1));
    }
  }
}

} // namespace
