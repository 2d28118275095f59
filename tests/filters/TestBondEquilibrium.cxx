// Elastic equilibrium through VTK's pipeline: arrays and numbers are the solver's; stress by the filter is that of the
// solver; on distributed images the numbers are those of one rank; what is refused.
#include "BondTesting.h"

#include "core/Communicator.h"
#include "peridynamics/ElasticStudy.h"
#include "vtkBondEquilibrium.h"
#include "vtkBondStress.h"

#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIntArray.h"
#include "vtkMPIController.h"
#include "vtkMultiProcessController.h"

#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <limits>

namespace
{

using namespace lamella;
using vtktest::errorOf;
using vtktest::picture;
using vtktest::points;
namespace pd = lamella::peridynamics;

class BondEquilibrium : public vtktest::OnBonds
{
};

constexpr double spacing = 1e-5;

/// Two phases, b and c, with holes of a; grains 1 to 6 in blocks.
int holes(int x, int y, int z)
{
  return (x - 9) * (x - 9) + (y - 14) * (y - 14) + (z - 5) * (z - 5) < 30 ? 0 : (x + y) % 24 < 12 ? 1 : 2;
}

vtkSmartPointer<vtkImageData> sample(int nx = 24, int ny = 40, int nz = 1)
{
  const auto image = picture(nx, ny, nz, holes, spacing);
  setFieldTexts(image, "phase_names", std::vector<std::string>{ "void", "wall", "lamella" });
  vtkNew<vtkIntArray> grain;
  grain->SetName("grain");
  for (int z = 0; z < nz; ++z)
  {
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        grain->InsertNextValue(1 + x / 12 + 2 * (y / 15));
  }
  image->GetPointData()->AddArray(grain);
  return image;
}

void configure(vtkBondAlgorithm* filter)
{
  filter->SetYoungsModulus("wall", 4e9);
  filter->SetYoungsModulus("lamella", 1e9);
  filter->SetYoungsModulus("lamella-wall", 2e9);
  filter->SetYoungsModulus("wall-wall", 1e9);
  filter->SetCriticalStretch("wall", 1e-2);
  filter->SetToughness("lamella", 1e5);
}

pd::BondModel model(int dimension)
{
  pd::BondModel m;
  m.continuum = dimension == 3 ? pd::Continuum::Space : pd::Continuum::PlaneStress;
  m.micromodulus = dimension == 3 ? pd::Micromodulus::Isotropic : pd::Micromodulus::Continuum; // the defaults
  m.pairs[{ 1, 1 }].material = { .youngsModulus = 4e9, .criticalStretch = 1e-2 };
  m.pairs[{ 1, 1 }].betweenGrains = pd::BondMaterial{ .youngsModulus = 1e9 };
  m.pairs[{ 2, 2 }].material = { .youngsModulus = 1e9, .toughness = 1e5 };
  m.pairs[{ 1, 2 }].material = { .youngsModulus = 2e9 };
  m.pairByGrain = true;
  return m;
}

double number(vtkImageData* image, const char* name, std::size_t i = 0)
{
  const std::vector<double> values = fieldNumbers(image, name);
  EXPECT_GT(values.size(), i) << name;
  return values.size() > i ? values[i] : std::nan("");
}

TEST_F(BondEquilibrium, IsTheSolver)
{
  for (const int nz : { 1, 14 })
  {
    SCOPED_TRACE(nz);
    const auto image = sample(24, nz > 1 ? 20 : 40, nz);
    vtkNew<vtkBondEquilibrium> filter;
    configure(filter);
    filter->SetInputData(image);
    filter->ComputeStressOn();
    filter->ComputeStrainEnergyOn();
    filter->ComputeSensitivityOn();
    ASSERT_EQ(errorOf(filter), "");
    vtkImageData* const output = filter->GetOutput();
    EXPECT_EQ(points(output, "phase"), points(image, "phase")); // passed on, not copied

    const PhaseView view = viewPhases(image);
    auto* const grain = vtkIntArray::SafeDownCast(points(image, "grain"));
    pd::ElasticOptions options;
    options.stress = true;
    options.energyDensity = true;
    options.sensitivity = true;
    options.threads = 1;
    const Communicator alone(MPI_COMM_SELF);
    const pd::ElasticResult r = pd::studyElastic(model(view.lattice.dimension), view.lattice, view.phase,
      { grain->GetPointer(0), static_cast<std::size_t>(grain->GetNumberOfValues()) }, options, alone);
    const int d = view.lattice.dimension;
    const std::vector<int> places = d == 2 ? std::vector<int>{ 0, 1, 3 } : std::vector<int>{ 0, 1, 2, 3, 4, 5 };
    vtkDataArray* const u = points(output, "displacement");
    vtkDataArray* const stress = points(output, "stress");
    vtkDataArray* const energy = points(output, "strain_energy");
    ASSERT_EQ(u->GetNumberOfComponents(), 3);
    ASSERT_EQ(stress->GetNumberOfComponents(), 6);
    EXPECT_STREQ(stress->GetComponentName(3), "XY");
    EXPECT_EQ(description(stress)[0], "Pa");
    for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
    {
      const auto [nx, ny, nzz] = view.lattice.size;
      const std::int64_t x = i % nx;
      const std::int64_t y = i / nx % ny;
      const std::int64_t z = i / (nx * ny);
      const bool empty = view.phase[static_cast<std::size_t>(i)] == 0;
      for (int c = 0; c < d; ++c)
      {
        // 0 in voids, whatever the solver keeps there
        ASSERT_EQ(u->GetComponent(i, c), empty ? 0 : r.displacement.at(c, x, y, z));
      }
      for (std::size_t c = 0; c < places.size(); ++c)
        ASSERT_EQ(stress->GetComponent(i, places[c]), r.stress->at(static_cast<int>(c), x, y, z));
      ASSERT_EQ(energy->GetComponent(i, 0), r.energyDensity->at(0, x, y, z));
      if (d == 2)
      {
        ASSERT_EQ(stress->GetComponent(i, 2), 0); // plane stress
        ASSERT_EQ(u->GetComponent(i, 2), 0);
      }
    }
    EXPECT_EQ(filter->GetEffectiveModulus(), r.effectiveModulus);
    EXPECT_EQ(number(output, "effective_modulus"), r.effectiveModulus);
    EXPECT_EQ(number(output, "effective_stress"), r.effectiveStress);
    EXPECT_EQ(number(output, "elastic_energy"), r.elasticEnergy);
    EXPECT_EQ(number(output, "mean_stress", 1), r.meanStress[1]);
    EXPECT_EQ(number(output, "reaction_high", static_cast<std::size_t>(d - 1)),
      r.reactions.high[static_cast<std::size_t>(d - 1)]);
    EXPECT_EQ(number(output, "first_break_strain"), r.firstBreak->strain);
    EXPECT_EQ(number(output, "first_break_position"), r.firstBreak->position[0]);
    EXPECT_EQ(fieldTexts(output, "first_break_phases").size(), 2U);
    double moduli = 0; // σ ~ all of them together
    double critical = 0;
    const std::vector<std::string> names = fieldTexts(output, "material_numbers");
    for (std::size_t i = 0; i < names.size(); ++i)
    {
      const double change = number(output, "first_break_sensitivity", i) * number(output, "material_values", i);
      (names[i].starts_with("young:") ? moduli : critical) += change / r.firstBreak->stress;
    }
    EXPECT_NEAR(critical, 1, 1e-6);
    // lamella's toughness: s₀ ~ K/E; to the solver's tolerance of 1e-6
    EXPECT_NEAR(moduli, r.sensitivity->pair == 3 ? 0 : 1, 1e-4);
    EXPECT_EQ(number(output, "bonds"), static_cast<double>(r.bonds));
    EXPECT_EQ(fieldTexts(output, "warnings"), r.warnings);
    EXPECT_EQ(fieldText(output, "load"), "stretch");
    EXPECT_EQ(fieldText(output, "load_axis"), d == 2 ? "y" : "z");
    EXPECT_EQ(number(output, "platen_layers", 1), 2);
    EXPECT_EQ(
      fieldTexts(output, "pair_names"), (std::vector<std::string>{ "wall", "wall-wall", "wall-lamella", "lamella" }));
    EXPECT_NEAR(number(output, "pair_toughness", 3), 1e5, 1e-6);
    EXPECT_TRUE(std::isinf(number(output, "pair_critical_stretch", 1)));
    EXPECT_NE(provenance(output).find("\"equilibrium\""), std::string::npos);
  }
}

TEST_F(BondEquilibrium, NothingIsComputedThatWasNotAskedFor)
{
  vtkNew<vtkBondEquilibrium> filter;
  configure(filter);
  filter->SetInputData(sample());
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_EQ(points(filter->GetOutput(), "stress"), nullptr);
  EXPECT_EQ(points(filter->GetOutput(), "strain_energy"), nullptr);
  EXPECT_TRUE(fieldNumbers(filter->GetOutput(), "first_break_sensitivity").empty());
}

TEST_F(BondEquilibrium, UncertaintiesAreOfSomething)
{
  vtkNew<vtkBondEquilibrium> filter;
  configure(filter);
  filter->SetInputData(sample());
  filter->SetYoungsModulusUncertainty("stone", 1e8);
  EXPECT_NE(
    errorOf(filter).find("'stone' has an uncertainty of its Young's modulus, and no such number"), std::string::npos);
  filter->RemoveAllYoungsModulusUncertainties();
  filter->SetYoungsModulusUncertainty("wall", 1e8);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_GT(number(filter->GetOutput(), "first_break_input_error"), 0);
}

// The filter takes the model that came with the image, whatever it is, or one of its own.
TEST_F(BondEquilibrium, StressFromTheDisplacement)
{
  for (const bool strain : { false, true })
  {
    vtkNew<vtkBondEquilibrium> filter;
    configure(filter);
    filter->SetInputData(sample());
    filter->ComputeStressOn();
    filter->ComputeStrainEnergyOn();
    filter->SetHorizon(4);
    filter->SurfaceCorrectionOn();
    filter->AddNotch(0, 2.25e-4, 6e-5, 2.25e-4);
    filter->SetContinuum(strain ? vtkBondAlgorithm::PLANE_STRAIN : vtkBondAlgorithm::PLANE_STRESS);
    filter->SetLargeStrains(strain);
    ASSERT_EQ(errorOf(filter), "");
    vtkNew<vtkImageData> bare;
    bare->ShallowCopy(filter->GetOutput());
    bare->GetPointData()->RemoveArray("stress");
    bare->GetPointData()->RemoveArray("strain_energy");
    vtkNew<vtkBondStress> stress;
    stress->SetInputData(bare);
    stress->ComputeStrainEnergyOn();
    ASSERT_EQ(errorOf(stress), "");
    vtkDataArray* const found = points(stress->GetOutput(), "stress");
    vtkDataArray* const expected = points(filter->GetOutput(), "stress");
    for (vtkIdType i = 0; i < 6 * found->GetNumberOfTuples(); ++i)
      ASSERT_EQ(found->GetVariantValue(i), expected->GetVariantValue(i));
    const double* const s = found->GetTuple(24 * 20 + 20);
    EXPECT_NEAR(s[2], strain ? 0.25 * (s[0] + s[1]) : 0, 1e-9 * s[1]);
    EXPECT_NEAR(number(stress->GetOutput(), "mean_stress", 1) / number(filter->GetOutput(), "mean_stress", 1), 1, 1e-9);
    // a model of its own: with one modulus everywhere, twice that is twice the stress
    const auto ofModulus = [&](double young)
    {
      vtkNew<vtkBondStress> own;
      own->SetInputData(bare);
      own->ModelFromInputOff();
      for (const char* const pair : { "wall", "lamella", "wall-lamella" })
        own->SetYoungsModulus(pair, young);
      EXPECT_EQ(errorOf(own), "");
      return number(own->GetOutput(), "mean_stress", 1);
    };
    EXPECT_NEAR(ofModulus(2e9) / ofModulus(1e9), 2, 1e-12);
  }
}

TEST_F(BondEquilibrium, WhatTheStressFilterRefuses)
{
  vtkNew<vtkBondStress> filter;
  filter->SetInputData(sample());
  EXPECT_NE(errorOf(filter).find("the image does not tell its model"), std::string::npos);
  filter->ModelFromInputOff();
  configure(filter);
  EXPECT_NE(errorOf(filter).find("the image has no point array 'displacement'"), std::string::npos);
  const auto image = sample();
  vtkNew<vtkDoubleArray> u;
  u->SetName("displacement");
  u->SetNumberOfComponents(3);
  u->SetNumberOfTuples(image->GetNumberOfPoints());
  u->Fill(0);
  u->SetComponent(24 * 3 + 5, 1, std::numeric_limits<double>::quiet_NaN());
  image->GetPointData()->AddArray(u);
  filter->SetInputData(image);
  EXPECT_NE(
    errorOf(filter).find("array 'displacement' holds a value that is not finite at node 5, 3, 0"), std::string::npos);
  u->SetComponent(24 * 3 + 5, 1, 0);
  u->SetComponent(24 * 14 + 9, 0, std::numeric_limits<double>::quiet_NaN()); // in a void
  u->Modified();
  image->Modified();
  EXPECT_EQ(errorOf(filter), "");
  vtkNew<vtkDoubleArray> flat;
  flat->SetName("displacement");
  flat->SetNumberOfTuples(image->GetNumberOfPoints());
  image->GetPointData()->AddArray(flat);
  filter->Modified();
  EXPECT_NE(errorOf(filter).find("array 'displacement' has 1 components"), std::string::npos);
  image->GetPointData()->AddArray(u);
  setFieldText(image, "bond_model", "{\"young\": 3}");
  filter->ModelFromInputOn();
  EXPECT_NE(errorOf(filter).find("is not what lamella wrote"), std::string::npos);
}

TEST_F(BondEquilibrium, WhatIsRefused)
{
  const auto fails = [](const std::function<void(vtkBondEquilibrium*, vtkImageData*)>& change, const char* message,
                       int failure = vtkBondAlgorithm::PARAMETER_FAILURE)
  {
    const auto image = sample();
    vtkNew<vtkBondEquilibrium> filter;
    configure(filter);
    filter->SetInputData(image);
    change(filter, image);
    vtktest::expectRefused(filter, message, failure);
  };
  fails(
    [](auto* f, auto*) { f->RemoveAllYoungsModuli(); }, "it is said how wall breaks, but it has no Young's modulus");
  fails(
    [](auto* f, auto*)
    {
      f->RemoveAllYoungsModuli();
      f->SetYoungsModulus("wall", 1);
      f->SetYoungsModulus("lamella", 1);
    },
    "no material is given for bonds of wall and lamella");
  fails([](auto* f, auto*) { f->SetYoungsModulus("wall", 0); }, "Young's modulus of wall is 0");
  fails([](auto* f, auto*) { f->SetCriticalStretch("wall", -1e-3); }, "the critical stretch of wall is -0.001");
  fails([](auto* f, auto*) { f->SetToughness("wall", 1); },
    "wall has more than one of fracture energy, toughness and critical stretch");
  fails([](auto* f, auto*) { f->AddVoid("viod"); }, "'viod' is to be void, but is no phase of this image");
  fails([](auto* f, auto*) { f->SetHorizon(0.9); }, "horizon 0.9 is below 1");
  fails([](auto* f, auto*) { f->SetHorizon(std::nan("")); }, "horizon nan is not a number");
  fails(
    [](auto* f, auto*)
    {
      f->SetInputData(sample(7, 40));
      f->SetHorizon(8);
    },
    "a horizon of 8 spacings does not fit into 7 nodes along x");
  fails([](auto* f, auto*) { f->AddNotch(1, 1, 2, 2); }, "notch 1 from (1, 1, 0) m lies outside the sample");
  fails([](auto* f, auto*) { f->SetContinuum(vtkBondAlgorithm::SPACE); }, "space is asked of a picture");
  fails([](auto* f, auto*) { f->SetStrain(0); }, "the strain is 0: nothing is loaded");
  fails([](auto* f, auto*) { f->SetLoad(vtkBondEquilibrium::TRACTION); }, "the traction is 0: nothing is loaded");
  fails([](auto* f, auto*) { f->SetLoadAxis(vtkBondEquilibrium::Z); }, "there is no axis 2 in 2 dimensions");
  fails(
    [](auto* f, auto*) { f->SetPeriodic(0, 1, 0); }, "the sample is periodic along y, where a platen is to hold it");
  fails(
    [](auto* f, auto*) { f->SetPlatenLayers(20); }, "two platens of 20 layers leave nothing of a sample of 40 nodes");
  fails([](auto*, auto* image) { image->GetPointData()->RemoveArray("grain"); },
    "bonds between grains have a material of their own, but the image has no point array 'grain'",
    vtkBondAlgorithm::INPUT_FAILURE);
  fails([](auto*, auto* image) { image->GetPointData()->RemoveArray("phase"); }, "the image has no point array 'phase'",
    vtkBondAlgorithm::INPUT_FAILURE);
  fails(
    [](auto*, auto* image)
    {
      vtkNew<vtkFloatArray> phase;
      phase->SetName("phase");
      phase->SetNumberOfTuples(image->GetNumberOfPoints());
      phase->Fill(1);
      phase->SetValue(3, std::numeric_limits<float>::quiet_NaN());
      image->GetPointData()->AddArray(phase);
    },
    "array 'phase' holds nan; phases are whole numbers", vtkBondAlgorithm::INPUT_FAILURE);
  fails(
    [](auto*, auto* image)
    {
      vtkDataArray* const phase = points(image, "phase");
      for (int i = 0; i < 24 * 6; ++i)
      {
        phase->SetTuple1(24 * 20 + i, 0);
      }
    },
    "no piece of the sample reaches from one platen to the other along y: it is in 2 pieces",
    vtkBondAlgorithm::NO_PATH_FAILURE);
}

// Pieces split along x and into blocks, with and without a ghost layer.
TEST_F(BondEquilibrium, RanksChangeNothing)
{
  for (const int nz : { 1, 14 })
  {
    const auto image = sample(24, 40, nz);
    const auto set = [](vtkBondEquilibrium* filter)
    {
      configure(filter);
      filter->ComputeStressOn();
      filter->SetTolerance(1e-11);
    };
    vtkNew<vtkBondEquilibrium> alone;
    set(alone);
    alone->SetInputData(image);
    alone->UpdatePiece(0, 1, 0);
    vtkImageData* const whole = alone->GetOutput();
    ASSERT_GT(whole->GetNumberOfPoints(), 0);
    for (const bool blocks : { false, true })
    {
      const auto producer = pieceOf(image, blocks);
      vtkNew<vtkBondEquilibrium> together;
      set(together);
      together->SetInputConnection(producer->GetOutputPort());
      vtkNew<vtkBondStress> stress;
      stress->SetInputConnection(together->GetOutputPort());
      stress->UpdatePiece(rank(), ranks(), 0);
      vtkImageData* const part = stress->GetOutput();
      ASSERT_EQ(
        part->GetNumberOfPoints(), vtkImageData::SafeDownCast(producer->GetOutputDataObject(0))->GetNumberOfPoints());
      const double scale = number(whole, "effective_stress");
      for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
      {
        const vtkIdType other = whole->FindPoint(part->GetPoint(i));
        for (int c = 0; c < 6; ++c)
        {
          ASSERT_NEAR(
            points(part, "stress")->GetComponent(i, c), points(whole, "stress")->GetComponent(other, c), 1e-8 * scale);
        }
      }
      for (const char* const name : { "effective_modulus", "elastic_energy", "first_break_strain", "bonds" })
        EXPECT_NEAR(number(part, name) / number(whole, name), 1, 1e-8) << name;
      EXPECT_EQ(fieldTexts(part, "warnings"), fieldTexts(whole, "warnings"));
    }
  }
}

} // namespace
