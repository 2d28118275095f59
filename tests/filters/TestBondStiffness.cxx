// Effective stiffness through VTK's pipeline: numbers and tables are the solver's; on distributed images they are those
// of one rank; what is refused.
#include "BondTesting.h"
#include "StiffnessSample.h"

#include "core/Communicator.h"
#include "peridynamics/StiffnessStudy.h"
#include "vtkBondStiffness.h"

#include "vtkExtentTranslator.h"
#include "vtkFieldData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkTrivialProducer.h"

#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>

namespace
{

using namespace lamella;
using vtktest::errorOf;
using vtktest::layersWithAHole;
namespace el = lamella::elasticity;
namespace pd = lamella::peridynamics;

class BondStiffness : public vtktest::OnBonds
{
};

void configure(vtkBondStiffness* filter)
{
  filter->SetYoungsModulus("wall", 4e9);
  filter->SetYoungsModulus("lamella", 1e9);
  filter->SetYoungsModulus("lamella-wall", 2e9);
  filter->SetHorizon(2);
  filter->SetTolerance(1e-9);
}

pd::BondModel model(int dimension)
{
  pd::BondModel m;
  m.continuum = dimension == 3 ? pd::Continuum::Space : pd::Continuum::PlaneStress;
  m.micromodulus = pd::Micromodulus::Isotropic; // the default
  m.horizon = 2;
  m.pairs[{ 1, 1 }].material = { .youngsModulus = 4e9 };
  m.pairs[{ 2, 2 }].material = { .youngsModulus = 1e9 };
  m.pairs[{ 1, 2 }].material = { .youngsModulus = 2e9 };
  return m;
}

TEST_F(BondStiffness, IsTheSolver)
{
  for (const int nz : { 1, 8 })
  {
    SCOPED_TRACE(nz);
    const auto image = layersWithAHole(nz);
    vtkNew<vtkBondStiffness> filter;
    configure(filter);
    filter->SetInputData(image);
    ASSERT_EQ(errorOf(filter), "");
    vtkImageData* const output = filter->GetOutput();
    EXPECT_EQ(vtktest::points(output, "phase"), vtktest::points(image, "phase")); // passed on, not copied

    const PhaseView view = viewPhases(image);
    const int d = view.lattice.dimension;
    pd::StiffnessOptions options;
    options.equilibrium.tolerance = 1e-9;
    options.threads = 1;
    const Communicator alone(MPI_COMM_SELF);
    const pd::StiffnessResult r = pd::studyStiffness(model(d), view.lattice, view.phase, {}, options, alone);
    EXPECT_EQ(fieldNumbers(output, "stiffness"), r.cell.stiffness);
    EXPECT_EQ(fieldNumbers(output, "stiffness_extrapolated"), r.error.extrapolated);
    EXPECT_EQ(fieldNumbers(output, "stiffness_error"), r.error.components);
    EXPECT_EQ(fieldNumbers(output, "stiffness_voigt"), r.cell.bounds.voigt);
    EXPECT_EQ(fieldNumbers(output, "constants"), el::constantValues(r.cell.constants));
    EXPECT_EQ(fieldNumbers(output, "constants_error"), r.error.ofConstants);
    EXPECT_EQ(filter->GetEstimatedError(), r.error.relative);
    EXPECT_EQ(fieldTexts(output, "stiffness_components"), el::voigtNames(d));
    EXPECT_EQ(fieldTexts(output, "constant_names"), el::constantNames(d));
    EXPECT_EQ(fieldTexts(output, "warnings"), r.warnings);
    std::vector<double> every;
    for (const pd::StiffnessStep& step : r.steps)
      every.push_back(step.every);
    EXPECT_EQ(fieldNumbers(output, "step_every"), every);
    EXPECT_GT(every.size(), 1U);
    EXPECT_EQ(fieldTexts(output, "pair_names"), (std::vector<std::string>{ "wall", "wall-lamella", "lamella" }));
    EXPECT_NE(provenance(output).find("\"bond_stiffness\""), std::string::npos);

    const std::size_t n = d == 3 ? 6 : 3;
    vtkTable* const tensor = filter->GetTensor();
    ASSERT_EQ(tensor->GetNumberOfRows(), static_cast<vtkIdType>(n));
    ASSERT_EQ(tensor->GetNumberOfColumns(), static_cast<vtkIdType>(1 + 3 * n));
    for (std::size_t a = 0; a < n; ++a)
    {
      const auto row = static_cast<vtkIdType>(a);
      EXPECT_EQ(tensor->GetValueByName(row, "stress").ToString(), el::voigtNames(d)[a]);
      EXPECT_EQ(tensor->GetValueByName(row, "yy").ToDouble(), r.cell.stiffness[a * n + 1]);
      EXPECT_EQ(tensor->GetValueByName(row, "error_xy").ToDouble(), r.error.components[a * n + n - 1]);
    }
    EXPECT_EQ(description(vtkDataArray::SafeDownCast(tensor->GetColumnByName("xx")))[0], "Pa");
    vtkTable* const constants = filter->GetConstants();
    ASSERT_EQ(constants->GetNumberOfRows(), d == 3 ? 12 : 5);
    EXPECT_EQ(constants->GetValueByName(1, "constant").ToString(), "E_y");
    EXPECT_EQ(constants->GetValueByName(1, "value").ToDouble(), r.cell.constants.youngsModulus[1]);
    EXPECT_EQ(constants->GetValueByName(1, "unit").ToString(), "Pa");
    EXPECT_EQ(constants->GetValueByName(d, "unit").ToString(), "1");
    EXPECT_EQ(fieldNumbers(tensor, "stiffness"), r.cell.stiffness);
  }
}

TEST_F(BondStiffness, WithoutTheError)
{
  vtkNew<vtkBondStiffness> filter;
  configure(filter);
  filter->SetInputData(layersWithAHole());
  filter->EstimateErrorOff();
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_TRUE(std::isnan(filter->GetEstimatedError()));
  EXPECT_TRUE(std::isnan(filter->GetTensor()->GetValueByName(0, "error_xx").ToDouble()));
  EXPECT_EQ(fieldNumbers(filter->GetOutput(), "constants_error").size(), 5U);
  EXPECT_EQ(fieldNumbers(filter->GetOutput(), "step_nodes").size(), 1U);
}

TEST_F(BondStiffness, TablesCanBeAskedForAlone)
{
  vtkNew<vtkBondStiffness> filter;
  configure(filter);
  filter->SetInputData(layersWithAHole());
  filter->Update(2);
  EXPECT_EQ(filter->GetConstants()->GetNumberOfRows(), 5);
}

TEST_F(BondStiffness, WhatIsRefused)
{
  const auto fails =
    [](const std::function<void(vtkBondStiffness*, vtkImageData*)>& change, const char* message, int failure)
  {
    const auto image = layersWithAHole();
    vtkNew<vtkBondStiffness> filter;
    configure(filter);
    filter->SetInputData(image);
    change(filter, image);
    vtktest::expectRefused(filter, message, failure);
    EXPECT_EQ(filter->GetTensor()->GetNumberOfRows(), 0);
    EXPECT_EQ(filter->GetConstants()->GetNumberOfRows(), 0);
  };
  fails([](auto* f, auto*) { f->LargeStrainsOn(); }, "a stiffness is asked of large strains",
    vtkBondAlgorithm::PARAMETER_FAILURE);
  fails([](auto* f, auto*) { f->SetHorizon(std::nan("")); }, "horizon nan is not a number",
    vtkBondAlgorithm::PARAMETER_FAILURE);
  fails(
    [](auto* f, auto*) { f->RemoveAllYoungsModuli(); }, "has no Young's modulus", vtkBondAlgorithm::PARAMETER_FAILURE);
  fails([](auto* f, auto*) { f->SetMaximumIterations(1); }, "the residual force is still",
    vtkBondAlgorithm::DIVERGENCE_FAILURE);
  fails([](auto*, auto* image) { image->GetPointData()->RemoveArray("phase"); }, "the image has no point array 'phase'",
    vtkBondAlgorithm::INPUT_FAILURE);
  fails(
    [](auto*, auto* image)
    {
      vtkDataArray* const phase = vtktest::points(image, "phase");
      for (vtkIdType i = 0; i < phase->GetNumberOfTuples(); ++i)
      {
        phase->SetTuple1(i, i % 24 < 12 && i / 24 < 12 ? 1 : 0);
      }
    },
    "no piece of the cell goes on into the next one along any axis", vtkBondAlgorithm::NO_PATH_FAILURE);
}

TEST_F(BondStiffness, RanksChangeNothing)
{
  for (const int nz : { 1, 8 })
  {
    const auto image = layersWithAHole(nz);
    vtkNew<vtkBondStiffness> alone;
    configure(alone);
    alone->SetTolerance(1e-11);
    alone->SetEstimateError(nz == 1);
    alone->SetInputData(image);
    alone->UpdatePiece(0, 1, 0);
    ASSERT_GT(alone->GetOutput()->GetNumberOfPoints(), 0);
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
    vtkNew<vtkBondStiffness> together;
    configure(together);
    together->SetTolerance(1e-11);
    together->SetEstimateError(nz == 1);
    together->SetInputConnection(producer->GetOutputPort());
    together->UpdatePiece(rank(), ranks(), 0);
    for (const char* const name : { "stiffness", "stiffness_extrapolated", "constants", "stiffness_voigt" })
    {
      const std::vector<double> one = fieldNumbers(alone->GetOutput(), name);
      const std::vector<double> many = fieldNumbers(together->GetOutput(), name);
      ASSERT_EQ(one.size(), many.size());
      for (std::size_t i = 0; i < one.size(); ++i)
      {
        if (std::isnan(one[i])) // not asked for
        {
          EXPECT_TRUE(std::isnan(many[i]));
          continue;
        }
        EXPECT_NEAR(many[i], one[i], 1e-8 * std::abs(one[0])) << name << i;
      }
    }
    EXPECT_EQ(together->GetTensor()->GetNumberOfRows(), rank() != 0 ? 0 : nz == 1 ? 3 : 6);
  }
}

} // namespace
