// Diffusion through outlines in the pipeline: exact and published values, the library's numbers, and what is refused.
#include "ContourData.h"
#include "ContourField.h"
#include "MicrographTesting.h"
#include "vtkMicrographLattice.h"
#include "vtkOutlineDiffusion.h"

#include "lbm/ContourDiffusion.h"
#include "outlines/CoarserOutlines.h"
#include "outlines/WallThickness.h"

#include "vtkFieldData.h"
#include "vtkPolyData.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;
using micrograph::ContourSet;

/// One lumen from its corners, counter-clockwise.
micrograph::Contour chain(std::int32_t lumen, bool closed, std::vector<std::array<double, 2>> points)
{
  micrograph::Contour contour;
  contour.closed = closed;
  contour.lumen = lumen;
  contour.points = std::move(points);
  return contour;
}

vtkNew<vtkOutlineDiffusion> diffusionOf(const ContourSet& contours, double spacing)
{
  vtkNew<vtkOutlineDiffusion> filter;
  filter->SetInputData(toPolyData(contours, "test"));
  filter->SetSpacing(spacing);
  filter->SetConductivity("lumen", 0.05);
  filter->SetConductivity("wall", 1);
  return filter;
}

double number(vtkOutlineDiffusion* filter, const char* name, int index)
{
  return fieldNumbers(filter->GetOutput(), name).at(static_cast<std::size_t>(index));
}

double conductivity(vtkOutlineDiffusion* filter, int axis)
{
  return number(filter, "effective_conductivity", 4 * axis);
}

// Disks in a square array, by the series of Perrins et al. (1979), f = 0.545: within a quarter of a per cent, which is
// what the error bar of 60 nodes a cell allows, and within the error bar.
TEST(OutlineDiffusion, DisksInASquareArray)
{
  ContourSet set;
  set.size = { 12e-6, 12e-6 };
  std::vector<std::array<double, 2>> points;
  for (int i = 0; i < 720; ++i)
  {
    const double angle = 2 * std::numbers::pi * i / 720;
    points.push_back({ 6e-6 + 5e-6 * std::cos(angle), 6e-6 + 5e-6 * std::sin(angle) });
  }
  set.contours.push_back(chain(1, true, points));
  const auto filter = diffusionOf(set, 0.2e-6);
  ASSERT_EQ(errorOf(filter), "");
  const double b = (0.05 - 1) / (0.05 + 1);
  const double f = std::numbers::pi * 25 / 144;
  const double exact = 1 +
    2 * f /
      (1 / b - f - 0.305827 * b * std::pow(f, 4) / (1 - 1.402958 * b * b * std::pow(f, 8)) -
        0.013362 * b * std::pow(f, 8));
  for (const int axis : { 0, 1 })
  {
    EXPECT_NEAR(conductivity(filter, axis), exact, 2.5e-3 * exact);
    EXPECT_LT(std::abs(conductivity(filter, axis) / exact - 1), number(filter, "estimated_error_by_direction", axis));
    EXPECT_EQ(number(filter, "picture_error_by_direction", axis), 0); // outlines as they are
  }
  EXPECT_TRUE(std::isnan(number(filter, "effective_conductivity", 1)));
  EXPECT_TRUE(std::isnan(number(filter, "estimated_error_by_direction", 2)));
  EXPECT_EQ(fieldTexts(filter->GetOutput(), "phase_names"), (std::vector<std::string>{ "lumen", "wall" }));
}

// Pixels, coarser pictures, what may lie along the border and a lamella: bit for bit what the library gives that is
// asked for the same, which is what the command gave before it ran this class.
TEST(OutlineDiffusion, NumbersAreThoseOfTheLibrary)
{
  const PhaseImage image = tissue();
  const auto picture = toImageData(tissue());
  const auto outlines = contoursOf(picture);
  vtkNew<vtkOutlineDiffusion> filter;
  filter->SetInputConnection(outlines->GetOutputPort());
  filter->SetPictureData(picture);
  filter->SetConductivity("void", 0.05); // another word for lumen
  filter->SetConductivity("wall", 1);
  ASSERT_EQ(errorOf(filter), "");

  const ContourSet contours = contoursFrom(outlines->GetOutput());
  lbm::ContourStudyOptions study;
  study.spacing = image.lattice.spacing; // the pixel is the default
  study.conductivity = { 0.05, 1 };
  study.pixel = image.lattice.spacing;
  study.coarser = micrograph::coarserOutlines(image, 0);
  study.sealed = micrograph::sealedOutlines(contours, study.pixel);
  const auto answers = lbm::studyContours(contours, study, MPI_COMM_SELF);
  for (const int axis : { 0, 1 })
  {
    const lbm::ContourAnswer& answer = answers[static_cast<std::size_t>(axis)];
    EXPECT_EQ(conductivity(filter, axis), answer.value);
    EXPECT_EQ(number(filter, "lattice_error_by_direction", axis), answer.latticeError);
    EXPECT_EQ(number(filter, "picture_error_by_direction", axis), answer.pictureError);
    EXPECT_EQ(number(filter, "border_doubt", axis), std::abs(answer.sealed));
    EXPECT_EQ(number(filter, "segmentation_doubt", axis), 0);
    EXPECT_GT(answer.pictureError, 0);
  }
  EXPECT_EQ(number(filter, "estimated_error", 0), std::max(answers[0].error, answers[1].error));
  EXPECT_EQ(filter->GetOutput()->GetNumberOfLines(), outlines->GetOutput()->GetNumberOfLines());
  // Where walls of a segmented scan begin is in doubt.
  setFieldText(picture, "segmentation", "a threshold");
  picture->Modified();
  filter->SetDirection(vtkOutlineDiffusion::X);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_GT(number(filter, "segmentation_doubt", 0), 0);
  EXPECT_TRUE(std::isnan(conductivity(filter, 1)));
  EXPECT_GT(number(filter, "picture_error", 0), answers[0].pictureError);
}

// A lamella that conducts worse than the wall lowers the value, one that conducts as it does changes nothing; the
// labels of a lattice that has one give nearly what finding it anew gives.
TEST(OutlineDiffusion, TheMiddleLamellaConductsOtherwise)
{
  const ContourSet contours = expectedContours();
  const auto solved = [&](double lamella, int type)
  {
    const auto filter = diffusionOf(contours, 0.5e-6);
    filter->SetDirection(vtkOutlineDiffusion::X);
    filter->SetConductivity("lamella", lamella);
    filter->SetLamella(type);
    filter->SetLamellaThickness(1.5e-6);
    EXPECT_EQ(errorOf(filter), "");
    return conductivity(filter, 0);
  };
  const double same = solved(1, vtkOutlineDiffusion::GROWTH);
  EXPECT_EQ(same, solved(1, vtkOutlineDiffusion::CONSTANT));
  const double worse = solved(0.2, vtkOutlineDiffusion::GROWTH);
  EXPECT_LT(worse, same);
  EXPECT_LT(solved(0.2, vtkOutlineDiffusion::CONSTANT), same);

  vtkNew<vtkMicrographLattice> lattice;
  lattice->SetInputData(toPolyData(contours, "test"));
  lattice->SetSpacing(0.25e-6);
  lattice->SetLamella(vtkMicrographLattice::GROWTH);
  lattice->SetLamellaThickness(1.5e-6);
  const auto outlines = contoursOf(nullptr);
  outlines->SetInputConnection(lattice->GetOutputPort());
  vtkNew<vtkOutlineDiffusion> filter;
  filter->SetInputConnection(outlines->GetOutputPort());
  filter->SetPictureConnection(lattice->GetOutputPort());
  filter->SetDirection(vtkOutlineDiffusion::X);
  filter->SetSpacing(0.5e-6);
  filter->SetConductivity("lumen", 0.05);
  filter->SetConductivity("wall", 1);
  filter->SetConductivity("lamella", 0.2);
  filter->SetLamella(vtkOutlineDiffusion::LABELS);
  ASSERT_EQ(errorOf(filter), "");
  // Labels of half the distance of nodes: a tenth of what the lamella changes.
  EXPECT_NEAR(conductivity(filter, 0), worse, 0.1 * (same - worse));
  filter->SetLamellaPhase("glue");
  EXPECT_NE(errorOf(filter).find("'glue', the middle lamella, is no phase of the picture"), std::string::npos);
}

TEST(OutlineDiffusion, ATargetHalvesTheSpacing)
{
  const ContourSet contours = expectedContours();
  const auto filter = diffusionOf(contours, 2e-6);
  filter->SetDirection(vtkOutlineDiffusion::Y);
  ASSERT_EQ(errorOf(filter), "");
  const double error = number(filter, "estimated_error", 0);
  std::string told;
  vtkNew<vtkCallbackCommand> plan;
  plan->SetClientData(&told);
  plan->SetCallback([](vtkObject*, unsigned long, void* to, void* words)
    { *static_cast<std::string*>(to) = static_cast<const char*>(words); });
  filter->AddObserver(vtkOutlineDiffusion::PLAN_EVENT, plan);
  filter->SetTargetError(error / 1.5);
  ASSERT_EQ(errorOf(filter), "");
  EXPECT_LE(number(filter, "estimated_error", 0), error / 1.5);
  EXPECT_EQ(told.substr(0, 16), "the error bar is");
  EXPECT_EQ(fieldText(filter->GetOutput(), "target").value_or(""), "reached");
  EXPECT_GE(filter->GetOutput()->GetFieldData()->GetArray("lattices_y")->GetNumberOfTuples(), 3);
}

/// Without what VTK writes before it, and without the hint.
std::string words(const std::string& error)
{
  const std::size_t begin = error.find("): ") + 3;
  return error.substr(begin, error.find("\nhint") - begin);
}

TEST(OutlineDiffusion, WhatCannotBeDoneIsRefusedInWords)
{
  const ContourSet contours = expectedContours();
  const auto refused = [&](const std::function<void(vtkOutlineDiffusion*)>& change)
  {
    const auto filter = diffusionOf(contours, 1e-6);
    change(filter);
    const std::string error = errorOf(filter);
    EXPECT_EQ(filter->GetOutput()->GetNumberOfLines(), 0);
    return words(error);
  };
  EXPECT_EQ(refused([](auto* f) { f->RemoveAllConductivities(); }), "no conductivity was given for 'lumen'");
  EXPECT_EQ(refused([](auto* f) { f->SetConductivity("wal", 1); }),
    "'wal', which is given a conductivity, is no phase of outlines");
  EXPECT_EQ(refused([](auto* f) { f->SetConductivity("wall", -1); }),
    "a conductivity of -1 for 'wall' is no finite number of at least 0");
  EXPECT_EQ(
    refused([](auto* f) { f->SetConductivity("secondary wall", 2); }), "'wall' is given two conductivities, 2 and 1");
  EXPECT_EQ(refused(
              [](auto* f)
              {
                f->SetConductivity("wall", 0);
                f->SetConductivity("lumen", 0);
              }),
    "no phase conducts: all conductivities are 0");
  EXPECT_EQ(refused(
              [](auto* f)
              {
                f->SetConductivity("lamella", 2);
                f->SetLamella(vtkOutlineDiffusion::NONE);
              }),
    "a conductivity of the middle lamella, and there is none");
  EXPECT_EQ(refused(
              [](auto* f)
              {
                f->SetConductivity("lamella", 2);
                f->SetLamella(vtkOutlineDiffusion::LABELS);
              }),
    "a middle lamella from labels needs a picture of labels, and there is none");
  EXPECT_EQ(refused([](auto* f) { f->SetPictureData(toImageData(tissue())); }),
    "these outlines do not say how they were found in a picture");
  EXPECT_NE(refused([](auto* f) { f->SetTargetError(2); }), "");
  EXPECT_NE(refused([](auto* f) { f->SetSpacing(1e-12); }), "");
  vtkNew<vtkOutlineDiffusion> other;
  const auto outlines = contoursOf(toImageData(tissue()));
  other->SetInputConnection(outlines->GetOutputPort());
  other->SetPictureData(picture(40, 30, 1, [](int x, int, int) { return x < 20 ? 0 : 1; }));
  other->SetConductivity("lumen", 0.05);
  other->SetConductivity("wall", 1);
  EXPECT_NE(errorOf(other), "");
}

TEST(OutlineDiffusion, AbortLeavesNothing)
{
  const auto filter = diffusionOf(expectedContours(), 0.5e-6);
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  filter->AddObserver(vtkCommand::ProgressEvent, abort);
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(filter->GetOutput()->GetNumberOfLines(), 0);
}

} // namespace
