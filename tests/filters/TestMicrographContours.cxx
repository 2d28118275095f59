// Outlines and polygon files through the pipeline: what the numerics give, under the names of the data model.
#include "ContourData.h"
#include "MicrographTesting.h"
#include "vtkMicrographPolygonReader.h"

#include "core/Error.h"
#include "outlines/ContourCheck.h"
#include "outlines/ContourMeasures.h"
#include "outlines/PolygonFile.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataObject.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataWriter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;
using micrograph::ContourSet;

void expectSame(const ContourSet& a, const ContourSet& b)
{
  EXPECT_EQ(a.size, b.size);
  ASSERT_EQ(a.contours.size(), b.contours.size());
  for (std::size_t i = 0; i < a.contours.size(); ++i)
  {
    EXPECT_EQ(a.contours[i].closed, b.contours[i].closed);
    EXPECT_EQ(a.contours[i].lumen, b.contours[i].lumen);
    EXPECT_EQ(a.contours[i].points, b.contours[i].points);
  }
}

/// A poly-line, or a polygon, from points.
vtkNew<vtkPolyData> polyData(const std::vector<std::array<double, 3>>& corners, bool polygon = false)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(static_cast<int>(corners.size()));
  for (const std::array<double, 3>& p : corners)
    cells->InsertCellPoint(points->InsertNextPoint(p.data()));
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  polygon ? data->SetPolys(cells) : data->SetLines(cells);
  return data;
}

std::string thrown(vtkPolyData* data)
{
  try
  {
    static_cast<void>(contoursFrom(data));
  }
  catch (const Error& error)
  {
    EXPECT_FALSE(error.hint().empty());
    return error.what();
  }
  return {};
}

/// ∫ √(r² − x²) dx from 0.
double underArc(double x, double r)
{
  return 0.5 * (x * std::sqrt(std::max(0.0, r * r - x * x)) + r * r * std::asin(std::clamp(x / r, -1.0, 1.0)));
}

/// Area of the disk about the origin within x0 … x1 below y.
double diskBelow(double x0, double x1, double y, double r)
{
  const double left = std::clamp(x0, -r, r);
  const double right = std::clamp(x1, -r, r);
  // Where the line at y leaves the disk the integrand changes its form.
  const double turn = std::abs(y) < r ? std::sqrt(r * r - y * y) : 0;
  const std::array<double, 4> at{ left, std::clamp(-turn, left, right), std::clamp(turn, left, right), right };
  double area = 0;
  for (std::size_t i = 0; i < 3; ++i)
  {
    const double middle = (at[i] + at[i + 1]) / 2;
    const double half = std::sqrt(std::max(0.0, r * r - middle * middle));
    const double arc = underArc(at[i + 1], r) - underArc(at[i], r);
    area += y >= half ? 2 * arc : y <= -half ? 0 : arc + y * (at[i + 1] - at[i]);
  }
  return area;
}

enum class DiskValues
{
  Share,
  Distance
};

/// A disk's area error, rms over places relative to its area, through the filter.
double diskError(double r, DiskValues values, bool below)
{
  constexpr int places = 20;
  double sum = 0;
  for (int place = 0; place < places; ++place)
  {
    const int n = 2 * static_cast<int>(r) + 10;
    // Places that fill a pixel evenly: multiples of irrational numbers.
    const double cx = n / 2.0 + std::fmod(place * 0.618034, 1.0) - 0.5;
    const double cy = n / 2.0 + std::fmod(place * 0.414214, 1.0) - 0.5;
    vtkNew<vtkImageData> image;
    image->SetDimensions(n, n, 1);
    image->SetOrigin(0.5, 0.5, 0);
    vtkNew<vtkDoubleArray> array;
    array->SetName("lumen_share");
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        const double value = values == DiskValues::Distance
          ? 7 + r - std::hypot(i + 0.5 - cx, j + 0.5 - cy)
          : diskBelow(i - cx, i + 1 - cx, j + 1 - cy, r) - diskBelow(i - cx, i + 1 - cx, j - cy, r);
        array->InsertNextValue(!below ? value : values == DiskValues::Share ? 1 - value : -value);
      }
    }
    image->GetPointData()->AddArray(array);
    const auto filter = contoursOf(image);
    filter->SetBasis(values == DiskValues::Share ? vtkMicrographContours::SHARES : vtkMicrographContours::LEVEL);
    filter->SetLevel(below ? -7 : 7);
    filter->SetLumenBelow(below);
    EXPECT_EQ(errorOf(filter), "");
    const double truth = std::numbers::pi * r * r;
    const double error = filter->GetOutput()->GetCellData()->GetArray("area")->GetTuple1(0) / truth - 1;
    sum += error * error / places;
  }
  return std::sqrt(sum);
}

TEST_F(Micrograph, AreasFromSharesAndLevelsAreOfSecondOrder)
{
  for (const DiskValues values : { DiskValues::Share, DiskValues::Distance })
  {
    const double coarse = diskError(8, values, false);
    const double fine = diskError(32, values, false);
    RecordProperty("order", std::to_string(std::log2(coarse / fine) / 2));
    // 2 when written, to 0.05. A mask's count of pixels has 3/2.
    EXPECT_GT(std::log2(coarse / fine) / 2, 1.9) << static_cast<int>(values);
    EXPECT_LT(fine, 2e-4);
    EXPECT_NEAR(diskError(32, values, true), fine, 1e-6) << "the other way around; shares are in 32 bits";
  }
}

TEST_F(Micrograph, SharesOfStraightEdgesAreExact)
{
  // A lumen left of a line at any angle that leaves the picture below and above; shares by exact clipping.
  const int n = 40;
  for (const double slope : { 0.0, 0.3, 0.77, -0.5 })
  {
    vtkNew<vtkImageData> image;
    image->SetDimensions(n, n, 1);
    image->SetOrigin(0.5, 0.5, 0);
    vtkNew<vtkDoubleArray> array;
    array->SetName("share");
    for (int j = 0; j < n; ++j)
    {
      for (int i = 0; i < n; ++i)
      {
        // The line lies at x = 20.3 + slope (y − 20); over a pixel's height its share in x is piecewise linear.
        double share = 0;
        constexpr int parts = 4000;
        for (int k = 0; k < parts; ++k)
        {
          const double x = 20.3 + slope * (j + (k + 0.5) / parts - 20);
          share += std::clamp(x - i, 0.0, 1.0) / parts;
        }
        array->InsertNextValue(share);
      }
    }
    image->GetPointData()->AddArray(array);
    const auto filter = contoursOf(image);
    filter->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "share");
    filter->SetBasis(vtkMicrographContours::SHARES);
    ASSERT_EQ(errorOf(filter), "");
    const ContourSet set = contoursFrom(filter->GetOutput());
    ASSERT_EQ(set.contours.size(), 1U);
    for (const micrograph::Point& p : set.contours[0].points)
    {
      if (p[1] > 2 && p[1] < n - 2) // at the border a pixel's neighbours are not known
      {
        // What is not exact at the border is spread over the chain when its area is restored.
        EXPECT_NEAR(p[0], 20.3 + slope * (p[1] - 20), 5e-3) << slope;
      }
    }
  }
}

TEST_F(Micrograph, BadLevelsAndSharesAreRefused)
{
  const auto image = toImageData(tissue());
  const auto filter = contoursOf(image);
  filter->SetBasis(vtkMicrographContours::LEVEL);
  EXPECT_NE(errorOf(filter).find("no point array 'lumen_share'"), std::string::npos);
  vtkNew<vtkDoubleArray> values;
  values->SetName("lumen_share");
  values->SetNumberOfTuples(image->GetNumberOfPoints());
  values->Fill(0.25);
  values->SetValue(0, 2.5);
  image->GetPointData()->AddArray(values);
  filter->SetBasis(vtkMicrographContours::SHARES);
  EXPECT_NE(errorOf(filter).find("has the value 2.5"), std::string::npos);
  filter->SetBasis(vtkMicrographContours::LEVEL);
  filter->SetLevel(notANumber);
  EXPECT_NE(errorOf(filter).find("level nan is not a number\nhint: "), std::string::npos);
  filter->SetLevel(3);
  EXPECT_NE(errorOf(filter).find("the picture has no lumen"), std::string::npos);
  values->SetValue(0, notANumber);
  values->Modified();
  EXPECT_NE(errorOf(filter).find("no finite numbers"), std::string::npos);
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetName("lumen_share");
  vectors->SetNumberOfComponents(2);
  vectors->SetNumberOfTuples(image->GetNumberOfPoints());
  image->GetPointData()->AddArray(vectors);
  EXPECT_NE(errorOf(filter).find("has 2 components"), std::string::npos);
}

TEST_F(Micrograph, OutlinesAreThoseOfTheLibrary)
{
  const auto image = toImageData(tissue());
  const auto filter = contoursOf(image);
  ASSERT_EQ(errorOf(filter), "");
  vtkPolyData* const outlines = filter->GetOutput();
  const micrograph::Extraction expected = micrograph::extractContours(tissue(), 0);
  expectSame(contoursFrom(outlines), expected.contours);

  vtkCellData* const cells = outlines->GetCellData();
  const std::vector<micrograph::LumenMeasures> measures = micrograph::measureLumens(expected.contours);
  vtkIdType chain = 0;
  for (const micrograph::Contour& contour : expected.contours.contours)
  {
    const auto m = std::find_if(
      measures.begin(), measures.end(), [&](const auto& measure) { return measure.lumen == contour.lumen; });
    ASSERT_NE(m, measures.end());
    EXPECT_EQ(cells->GetArray("lumen")->GetTuple1(chain), contour.lumen);
    EXPECT_EQ(cells->GetArray("closed")->GetTuple1(chain), contour.closed ? 1 : 0);
    EXPECT_EQ(cells->GetArray("area")->GetTuple1(chain), m->area);
    EXPECT_EQ(cells->GetArray("solidity")->GetTuple1(chain), m->solidity);
    EXPECT_EQ(cells->GetArray("equivalent_diameter")->GetTuple1(chain), m->equivalentDiameter);
    ++chain;
  }
  EXPECT_EQ(fieldNumbers(outlines, "lumens").at(0), static_cast<double>(expected.report.lumens));
  EXPECT_EQ(fieldNumbers(outlines, "open_lumens").at(0), static_cast<double>(expected.report.openLumens));
  // Sums in another order: round-off. And smoothing keeps each lumen's pixels' area: the mask's wall fraction.
  EXPECT_NEAR(fieldNumbers(outlines, "wall_fraction").at(0), expected.report.wallFraction, 1e-12);
  EXPECT_NEAR(fieldNumbers(outlines, "wall_fraction").at(0), tissue().fractions().at(1), 1e-3);
  EXPECT_EQ(fieldNumbers(outlines, "size").size(), 2U);
  EXPECT_EQ(fieldTexts(outlines, "report"), expected.report.lines());
  EXPECT_NE(provenance(outlines).find("\"contours\""), std::string::npos);
  const auto [unit, text, creator] = description(cells->GetArray("area"));
  EXPECT_EQ(unit, "m^2");
  EXPECT_EQ(creator, "vtkMicrographContours");
}

TEST_F(Micrograph, OptionsReachTheLibrary)
{
  const auto image = toImageData(tissue());
  const auto filter = contoursOf(image);
  const micrograph::ExtractOptions options{ false, 12, 0.1, 2e-10, 0.8 };
  filter->SetSmooth(options.smooth);
  filter->SetWavelength(options.wavelength);
  filter->SetTolerance(options.tolerance);
  filter->SetSmallestArea(options.smallestArea);
  filter->SetLeastSolidity(options.leastSolidity);
  filter->SetLumenPhase("lumen");
  ASSERT_EQ(errorOf(filter), "");
  expectSame(contoursFrom(filter->GetOutput()), expectedContours(options));
  EXPECT_LT(contoursFrom(filter->GetOutput()).contours.size(), expectedContours().contours.size());
}

TEST_F(Micrograph, DefaultsAreTheLibrarys)
{
  const micrograph::ExtractOptions options;
  vtkNew<vtkMicrographContours> filter;
  EXPECT_EQ(filter->GetBasis(), vtkMicrographContours::PHASES);
  EXPECT_EQ(filter->GetLumenPhase(), "");
  EXPECT_EQ(filter->GetSmooth(), options.smooth);
  EXPECT_EQ(filter->GetWavelength(), options.wavelength);
  EXPECT_EQ(filter->GetTolerance(), options.tolerance);
  EXPECT_EQ(filter->GetSmallestArea(), options.smallestArea);
  EXPECT_EQ(filter->GetLeastSolidity(), options.leastSolidity);
}

TEST_F(Micrograph, PhasesAreChosenByNameOrNumber)
{
  PhaseImage picture = tissue();
  picture.phases = PhaseTable({ "hole", "solid" });
  const auto named = toImageData(picture);
  const auto filter = contoursOf(named);
  EXPECT_NE(errorOf(filter).find("no phase is called void, pore, lumen or air"), std::string::npos);
  EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 0);
  for (const char* const phase : { "hole", "0" })
  {
    filter->SetLumenPhase(phase);
    ASSERT_EQ(errorOf(filter), "") << phase;
    expectSame(contoursFrom(filter->GetOutput()), expectedContours());
  }
  filter->SetLumenPhase("air");
  EXPECT_NE(errorOf(filter).find("'air' is no phase of this image\nhint: its phases are 'hole' and 'solid'"),
    std::string::npos);
}

TEST_F(Micrograph, ForeignOutlinesAreTaken)
{
  // A clockwise ring that repeats its first point, a polygon: both are a closed lumen in the box around it.
  const std::vector<std::array<double, 3>> ring{ { 1, 1, 2 }, { 1, 3, 2 }, { 4, 3, 2 }, { 4, 1, 2 }, { 1, 1, 2 } };
  for (const bool polygon : { false, true })
  {
    const auto data = polyData(ring, polygon);
    const ContourSet set = contoursFrom(data);
    ASSERT_EQ(set.contours.size(), 1U);
    EXPECT_TRUE(set.contours[0].closed);
    EXPECT_EQ(set.contours[0].points.size(), 4U);
    EXPECT_EQ(set.contours[0].lumen, 1);
    EXPECT_EQ(set.size, (std::array<double, 2>{ 3, 2 }));
    EXPECT_EQ(micrograph::measureLumens(set).at(0).area, 6);
    EXPECT_EQ(cornerOf(data), (std::array<double, 3>{ 1, 1, 2 }));
  }
}

TEST_F(Micrograph, BadOutlinesAreRefused)
{
  EXPECT_NE(thrown(vtkNew<vtkPolyData>()).find("there are no outlines"), std::string::npos);
  EXPECT_NE(thrown(polyData({ { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 1 }, { 0, 0, 0 } })).find("lies at z = "), //
    std::string::npos);
  EXPECT_NE(thrown(polyData({ { 0, 0, 0 }, { 3, 3, 0 }, { 3, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0 } })).find("cross"),
    std::string::npos);
  EXPECT_NE(thrown(polyData({ { 0, 0, 0 }, { 1, 0, 0 } })), ""); // no height
  const std::vector<std::array<double, 3>> ring{ { 0, 0, 0 }, { 2, 0, 0 }, { 2, 2, 0 }, { 0, 2, 0 }, { 0, 0, 0 } };
  const auto broken = polyData(ring);
  broken->GetPoints()->SetPoint(1, notANumber, 0, 0);
  EXPECT_NE(thrown(broken), "");
  const auto verts = polyData(ring);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell({ 0 });
  verts->SetVerts(cells);
  EXPECT_NE(thrown(verts).find("1 vertices"), std::string::npos);
  const auto sized = polyData(ring);
  setFieldNumbers(sized, "size", std::array{ 1.0, 1.0, 1.0 });
  EXPECT_NE(thrown(sized).find("'size' has 3 numbers"), std::string::npos);
  setFieldNumbers(sized, "size", std::array{ notANumber, 1.0 });
  EXPECT_NE(thrown(sized).find("nan"), std::string::npos);
  setFieldNumbers(sized, "size", std::array{ 1.0, 1.0 });
  EXPECT_NE(thrown(sized), ""); // outside of the picture
  const auto numbered = polyData(ring);
  vtkNew<vtkDoubleArray> lumen;
  lumen->SetName("lumen");
  lumen->InsertNextValue(0);
  numbered->GetCellData()->AddArray(lumen);
  EXPECT_NE(thrown(numbered).find("the lumen of chain 1 is 0"), std::string::npos);
  lumen->SetNumberOfComponents(3);
  lumen->SetNumberOfTuples(1);
  EXPECT_NE(thrown(numbered).find("has 3 components"), std::string::npos);
}

TEST_F(Micrograph, BadPicturesAreRefused)
{
  const auto image = toImageData(tissue());
  const auto filter = contoursOf(image);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "grey");
  EXPECT_NE(errorOf(filter).find("no point array 'grey'"), std::string::npos);
  const auto flow = toImageData(tissue());
  vtkNew<vtkDoubleArray> vectors;
  vectors->SetName("phase");
  vectors->SetNumberOfComponents(3);
  vectors->SetNumberOfTuples(flow->GetNumberOfPoints());
  flow->GetPointData()->AddArray(vectors);
  EXPECT_NE(errorOf(contoursOf(flow)).find("has 3 components"), std::string::npos);
  const auto volume = vtktest::picture(6, 6, 6, vtktest::blobs);
  const auto solid = vtktest::picture(
    9, 9, 1, [](int, int, int) { return 1; });
  const auto empty = vtktest::picture(9, 9, 1, [](int, int, int) { return 0; });
  for (const auto& bad : { volume, solid, empty })
  {
    const auto wrong = contoursOf(bad);
    wrong->SetLumenPhase("a");
    EXPECT_NE(errorOf(wrong).find("\nhint: "), std::string::npos);
    EXPECT_EQ(wrong->GetOutput()->GetNumberOfPoints(), 0);
  }
  const auto limits = contoursOf(image);
  limits->SetWavelength(notANumber);
  EXPECT_NE(errorOf(limits).find("\nhint: "), std::string::npos);
  limits->SetWavelength(20);
  limits->SetSmallestArea(1);
  EXPECT_NE(errorOf(limits).find("\nhint: "), std::string::npos) << "no lumen is left";
  vtkNew<vtkImageData> turned;
  turned->ShallowCopy(image);
  turned->SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1);
  EXPECT_NE(errorOf(contoursOf(turned)).find("the image is turned in space"), std::string::npos);
}

TEST_F(Micrograph, PolygonFilesComeBackAsTheyWere)
{
  const std::string name = "micrograph" + std::to_string(rank()) + ".json";
  const ContourSet expected = expectedContours();
  micrograph::writePolygons(expected, name, &expected);
  vtkNew<vtkMicrographPolygonReader> reader;
  reader->SetFileName(name.c_str());
  ASSERT_EQ(errorOf(reader), "");
  expectSame(contoursFrom(reader->GetOutput()), expected);
  expectSame(contoursFrom(reader->GetCells()), expected);
  EXPECT_NE(provenance(reader->GetOutput()).find("sha256"), std::string::npos);
  // A file of VTK's holds the same.
  const std::string vtp = "micrograph" + std::to_string(rank()) + ".vtp";
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(reader->GetOutput());
  writer->SetFileName(vtp.c_str());
  writer->SetDataModeToBinary();
  ASSERT_EQ(writer->Write(), 1);
  reader->SetFileName(vtp.c_str());
  ASSERT_EQ(errorOf(reader), "");
  expectSame(contoursFrom(reader->GetOutput()), expected);
  EXPECT_EQ(reader->GetCells()->GetNumberOfCells(), 0);
  std::filesystem::remove(name);
  std::filesystem::remove(vtp);
}

TEST_F(Micrograph, AWindowOfOutlinesIsAPartOfTheirPicture)
{
  const std::string name = "window" + std::to_string(rank()) + ".vtp";
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(toPolyData(expectedContours(), "test", { 1e-3, 2e-3, 0 }));
  writer->SetFileName(name.c_str());
  writer->SetDataModeToBinary();
  ASSERT_EQ(writer->Write(), 1);
  vtkNew<vtkMicrographPolygonReader> reader;
  reader->SetFileName(name.c_str());
  ASSERT_EQ(errorOf(reader), "");
  const double whole = fieldNumbers(reader->GetOutput(), "wall_fraction").at(0);
  const std::vector<double> size = fieldNumbers(reader->GetOutput(), "size");
  // Four parts that share no area have all of the wall.
  double sum = 0;
  for (const int part : { 0, 1, 2, 3 })
  {
    const double x = part % 2 == 0 ? 0 : 0.37 * size[0];
    const double y = part / 2 == 0 ? 0 : 0.61 * size[1];
    const double toX = part % 2 == 0 ? 0.37 * size[0] : size[0];
    const double toY = part / 2 == 0 ? 0.61 * size[1] : size[1];
    reader->SetWindow(1e-3 + x, 2e-3 + y, 1e-3 + toX, 2e-3 + toY);
    ASSERT_EQ(errorOf(reader), "") << part;
    vtkPolyData* const found = reader->GetOutput();
    EXPECT_TRUE(micrograph::validate(contoursFrom(found)).empty());
    sum += fieldNumbers(found, "wall_fraction").at(0) * (toX - x) * (toY - y) / (size[0] * size[1]);
    EXPECT_NEAR(cornerOf(found)[0], 1e-3 + x, 1e-12);
    EXPECT_NE(provenance(found).find("\"window\""), std::string::npos);
  }
  EXPECT_NEAR(sum, whole, 1e-9) << "coordinates of about a millimetre, in round-off of 1e-19 m";
  reader->SetWindow(0, 0, 1, 1);
  EXPECT_NE(errorOf(reader).find("does not lie in the picture"), std::string::npos);
  std::filesystem::remove(name);
}

TEST_F(Micrograph, PolygonsAreScaledAndCut)
{
  const std::string name = "units" + std::to_string(rank()) + ".json";
  std::ofstream(name) << R"({"units": "um", "cells": [
    {"lumen": [[1, 1], [4, 1], [4, 4], [1, 4]], "outer": [[0, 0], [5, 0], [5, 5], [0, 5]]},
    {"lumen": [[6, 1], [9, 1], [9, 4], [6, 4]], "outer": [[5, 0], [10, 0], [10, 5], [5, 5]]}]})";
  vtkNew<vtkMicrographPolygonReader> reader;
  reader->SetFileName(name.c_str());
  ASSERT_EQ(errorOf(reader), "");
  EXPECT_NEAR(fieldNumbers(reader->GetOutput(), "size").at(0), 10e-6, 1e-18);
  EXPECT_NEAR(fieldNumbers(reader->GetOutput(), "wall_fraction").at(0), 1 - 18.0 / 50, 1e-12);
  // Cells share a wall's middle, and are measured all the same.
  ASSERT_EQ(reader->GetCells()->GetNumberOfLines(), 2);
  EXPECT_NEAR(reader->GetCells()->GetCellData()->GetArray("area")->GetTuple1(1), 25e-12, 1e-22);
  reader->SetUnit(1e-3);
  reader->SetYDown(true);
  reader->SetWindow(0, 0, 7, 3);
  ASSERT_EQ(errorOf(reader), "");
  EXPECT_NEAR(fieldNumbers(reader->GetOutput(), "size").at(1), 3e-3, 1e-15);
  const ContourSet cut = contoursFrom(reader->GetOutput());
  EXPECT_EQ(std::count_if(cut.contours.begin(), cut.contours.end(), [](const auto& c) { return !c.closed; }), 2);
  std::filesystem::remove(name);
}

// Lumens of a square of 8 µm and one of 2 µm: a circle of 4 µm has an area between theirs.
TEST_F(Micrograph, SmallLumensOfAFileBecomeWall)
{
  const std::string name = "small" + std::to_string(rank()) + ".json";
  std::ofstream(name) << R"({"units": "um", "lumens": [[[1,1],[9,1],[9,9],[1,9]], [[11,1],[13,1],[13,3],[11,3]]]})";
  vtkNew<vtkMicrographPolygonReader> reader;
  reader->SetFileName(name.c_str());
  reader->SetLeastDiameter(4e-6);
  ASSERT_EQ(errorOf(reader), "");
  EXPECT_EQ(reader->GetOutput()->GetNumberOfLines(), 1);
  EXPECT_EQ(fieldNumbers(reader->GetOutput(), "unit").at(0), 1e-6);
  reader->SetLeastDiameter(20e-6);
  EXPECT_NE(errorOf(reader).find("is left\nhint: lower the least diameter"), std::string::npos);
  std::filesystem::remove(name);
}

TEST_F(Micrograph, ReaderSaysWhatIsWrong)
{
  vtkNew<vtkMicrographPolygonReader> reader;
  EXPECT_NE(errorOf(reader).find("no file is named"), std::string::npos);
  reader->SetFileName("nowhere.json");
  EXPECT_NE(errorOf(reader).find("nowhere.json"), std::string::npos);
  reader->SetFileName("nowhere.vtp");
  EXPECT_NE(errorOf(reader).find("there is no file 'nowhere.vtp'"), std::string::npos);
  const std::string name = "bad" + std::to_string(rank()) + ".json";
  reader->SetFileName(name.c_str());
  for (const char* const text : { "", "{", "{}", "[]", "[[[0, 0]]]", R"({"units": "um", "lumens": [[[0, 0]]]})",
         R"({"units": "um", "lumens": [[[0, 0], [1, 0], [NaN, 1]]]})",
         R"({"units": "um", "lumens": [[[0, 0], [9, 0], [9, 9], [0, 9]], [[1, 1], [2, 1], [2, 2]]]})" })
  {
    std::ofstream(name, std::ios::trunc) << text;
    reader->Modified();
    const std::string error = errorOf(reader);
    EXPECT_NE(error.find(name), std::string::npos) << text << ": " << error;
    EXPECT_NE(error.find("\nhint: "), std::string::npos) << text << ": " << error;
    EXPECT_EQ(reader->GetOutput()->GetNumberOfCells(), 0);
  }
  std::filesystem::remove(name);
}

} // namespace
