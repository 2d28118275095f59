// vtkCompressionCurve and vtkCollapseMap: columns, numbers, states as inputs and as time steps, what is refused.
#include "VtkTesting.h"

#include "mpm/MaterialPoints.h"
#include "vtkCollapseMap.h"
#include "vtkCompressionCurve.h"

#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkPolyDataAlgorithm.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedIntArray.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace
{

using namespace lamella;
using lamella::vtktest::cell;
using lamella::vtktest::errorOf;
using lamella::vtktest::picture;

double number(vtkDataObject* data, const char* name, std::size_t i = 0)
{
  const std::vector<double> values = fieldNumbers(data, name);
  EXPECT_GT(values.size(), i) << name;
  return values.size() > i ? values[i] : std::nan("");
}

/// 200 MPa, flat at 4 MPa from 2 %, a parabola beyond 50 %.
vtkSmartPointer<vtkTable> foam(double end, const char* stress = "stress")
{
  auto table = vtkSmartPointer<vtkTable>::New();
  vtkNew<vtkDoubleArray> strains;
  strains->SetName("strain");
  vtkNew<vtkDoubleArray> stresses;
  stresses->SetName(stress);
  for (int i = 0; i * 1e-3 <= end; ++i)
  {
    const double e = i * 1e-3;
    strains->InsertNextValue(e);
    stresses->InsertNextValue(std::min(2e8 * e, 4e6) + (e > 0.5 ? 4e8 * (e - 0.5) * (e - 0.5) : 0));
  }
  table->AddColumn(strains);
  table->AddColumn(stresses);
  return table;
}

TEST(CompressionCurveFilter, AddsColumnsAndNumbers)
{
  vtkNew<vtkCompressionCurve> filter;
  filter->SetInputData(foam(0.8));
  filter->SetStiffnessRange(0, 0.015);
  filter->SetPlateauRange(0.2, 0.4);
  EXPECT_EQ(errorOf(filter), "");
  vtkTable* const out = filter->GetOutput();
  ASSERT_EQ(out->GetNumberOfRows(), 801);
  EXPECT_NEAR(number(out, "curve_stiffness"), 2e8, 1); // a straight line: round-off
  EXPECT_NEAR(number(out, "curve_fit_range", 1), 0.015, 1e-12);
  EXPECT_EQ(number(out, "curve_fit_rows"), 16);
  EXPECT_NEAR(number(out, "curve_plateau_stress"), 4e6, 1e-3);
  EXPECT_NEAR(number(out, "curve_yield_strain"), 0.022, 1e-3); // stresses are smoothed over 1 %
  EXPECT_TRUE(std::isnan(number(out, "curve_peak_strain")));
  EXPECT_NEAR(number(out, "curve_densification_strain"), 0.51, 0.002);
  EXPECT_EQ(fieldTexts(out, "curve_missing").size(), 1U); // no peak
  EXPECT_NEAR(cell(out, 20, "absorbed_energy"), 4e4, 1e-6);
  EXPECT_NEAR(cell(out, 10, "efficiency"), 0.005, 1e-9);
  EXPECT_NEAR(cell(out, 300, "smooth_stress"), 4e6, 1e-3);
  EXPECT_NEAR(number(out, "curve_energy"), cell(out, 800, "absorbed_energy"), 0);
  EXPECT_NE(provenance(out).find("compression_curve"), std::string::npos);
  EXPECT_EQ(description(vtkDataArray::SafeDownCast(out->GetColumnByName("absorbed_energy")))[0], "J/m^3");

  filter->SetInputData(foam(0.4));
  filter->SetPlateauRange(0, 0);
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_TRUE(std::isnan(number(filter->GetOutput(), "curve_densification_strain")));
  EXPECT_TRUE(std::isnan(number(filter->GetOutput(), "curve_plateau_stress")));
  EXPECT_EQ(fieldTexts(filter->GetOutput(), "curve_missing").size(), 3U);
}

TEST(CompressionCurveFilter, WhatCannotBeDoneIsRefusedInWords)
{
  const auto refused = [](vtkTable* table, const std::function<void(vtkCompressionCurve*)>& spoil, const char* words)
  {
    vtkNew<vtkCompressionCurve> filter;
    filter->SetInputData(table);
    spoil(filter);
    EXPECT_NE(errorOf(filter).find(words), std::string::npos) << errorOf(filter);
    EXPECT_EQ(filter->GetOutput()->GetNumberOfRows(), 0);
  };
  const auto nothing = [](vtkCompressionCurve*) {};
  refused(foam(0.4, "sigma"), nothing, "the table has no column 'stress'; there are: strain, sigma");
  refused(foam(0.0015), nothing, "a curve of 2 rows");
  refused(
    foam(0.4), [](vtkCompressionCurve* f) { f->SetWindow(0.1); }, "a window of 0.1");
  vtkNew<vtkTable> words;
  words->DeepCopy(foam(0.4));
  words->RemoveColumn(1);
  vtkNew<vtkStringArray> texts;
  texts->SetName("stress");
  texts->SetNumberOfValues(words->GetNumberOfRows());
  words->AddColumn(texts);
  refused(words, nothing, "the column 'stress' does not hold one number a row");
  vtkNew<vtkTable> falling;
  falling->DeepCopy(foam(0.4));
  vtkDoubleArray::SafeDownCast(falling->GetColumn(0))->SetValue(7, 0.001);
  refused(falling, nothing, "the strain does not rise from 0.006 in row 6 to 0.001 in row 7");
  vtkNew<vtkCompressionCurve> other;
  other->SetInputData(foam(0.8, "sigma"));
  other->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_ROWS, "sigma");
  EXPECT_EQ(errorOf(other), "");
}

/// Three lumens in a row, of 4 × 4 nodes, with walls of 2.
vtkSmartPointer<vtkImageData> tissue()
{
  auto image = picture(20, 8, 1, [](int x, int y, int) { return x % 6 < 2 || y < 2 || y >= 6 ? 1 : 0; });
  setPhaseNames(image, PhaseTable({ "lumen", "wall" }));
  return image;
}

/// Its points, pressed along y to `height`; F with 9 or 4 components.
vtkSmartPointer<vtkPolyData> pressed(vtkImageData* image, double height, int components = 9)
{
  const PhaseView view = viewPhases(image);
  const auto points = mpm::pointsFromLattice<2>(view.lattice, view.phase, {}, { .perNode = 2 });
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> places;
  places->SetDataTypeToDouble();
  vtkNew<vtkUnsignedIntArray> id;
  id->SetName("id");
  vtkNew<vtkDoubleArray> gradient;
  gradient->SetName("deformation_gradient");
  gradient->SetNumberOfComponents(components);
  for (std::size_t i = points.count(); i-- > 0;) // not in their order
  {
    places->InsertNextPoint(points.column(0)[i], height * points.column(1)[i], 0);
    id->InsertNextValue(points.id()[i]);
    const std::array<double, 9> nine{ 1, 0, 0, 0, height, 0, 0, 0, 1 };
    const std::array<double, 4> four{ 1, 0, 0, height };
    gradient->InsertNextTuple(components == 9 ? nine.data() : four.data());
  }
  data->SetPoints(places);
  data->GetPointData()->AddArray(id);
  data->GetPointData()->AddArray(gradient);
  return data;
}

vtkSmartPointer<vtkPolyData> atStrain(vtkSmartPointer<vtkPolyData> data, double strain)
{
  setFieldNumbers(data, "strain", std::span(&strain, 1));
  return data;
}

/// A source of states: at a time t the tissue is pressed to 1 − t.
class Press : public vtkPolyDataAlgorithm
{
public:
  static Press* New();
  vtkTypeMacro(Press, vtkPolyDataAlgorithm);
  std::vector<double> Times;
  vtkSmartPointer<vtkImageData> Tissue;

protected:
  Press() { this->SetNumberOfInputPorts(0); }
  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector) override
  {
    const std::array<double, 2> range{ this->Times.front(), this->Times.back() };
    vtkInformation* const info = outputVector->GetInformationObject(0);
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_STEPS(), this->Times.data(), static_cast<int>(this->Times.size()));
    info->Set(vtkStreamingDemandDrivenPipeline::TIME_RANGE(), range.data(), 2);
    return 1;
  }
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector) override
  {
    const double time =
      outputVector->GetInformationObject(0)->Get(vtkStreamingDemandDrivenPipeline::UPDATE_TIME_STEP());
    vtkPolyData::GetData(outputVector)->ShallowCopy(pressed(this->Tissue, 1 - time));
    return 1;
  }
};
vtkStandardNewMacro(Press);

void expectMap(vtkCollapseMap* filter)
{
  vtkImageData* const map = filter->GetOutput();
  ASSERT_EQ(map->GetNumberOfPoints(), 160);
  EXPECT_EQ(number(map, "lumen_count"), 3);
  EXPECT_EQ(number(map, "lumen_cut"), 0);
  EXPECT_EQ(number(map, "lumen_collapsed"), 3);
  EXPECT_EQ(number(map, "state_count"), 3);
  EXPECT_NEAR(number(map, "lumen_ratio"), 0.4, 1e-9);
  // 0.7 at 0.3 and 0.4 at 0.6: a half at 0.5
  EXPECT_NEAR(number(map, "first_collapse_strain"), 0.5, 1e-9);
  EXPECT_NEAR(map->GetPointData()->GetArray("collapse_strain")->GetTuple1(3 + 20 * 3), 0.5, 1e-6); // single precision
  EXPECT_TRUE(std::isnan(map->GetPointData()->GetArray("collapse_strain")->GetTuple1(0)));
  EXPECT_NEAR(map->GetPointData()->GetArray("lumen_ratio")->GetTuple1(3 + 20 * 3), 0.4, 1e-6);
  EXPECT_EQ(map->GetPointData()->GetArray("lumen")->GetTuple1(0), 0);
  EXPECT_EQ(map->GetPointData()->GetArray("lumen")->GetTuple1(3 + 20 * 3), 1);
  ASSERT_EQ(filter->GetLumenTable()->GetNumberOfRows(), 3);
  EXPECT_EQ(cell(filter->GetLumenTable(), 2, "lumen"), 3);
  EXPECT_NEAR(cell(filter->GetLumenTable(), 2, "area"), 16e-12, 1e-24);
  EXPECT_NEAR(cell(filter->GetLumenTable(), 1, "collapse_strain"), 0.5, 1e-9);
  EXPECT_EQ(cell(filter->GetLumenTable(), 1, "cut"), 0);
  ASSERT_EQ(filter->GetStateTable()->GetNumberOfRows(), 3);
  EXPECT_NEAR(cell(filter->GetStateTable(), 1, "ratio"), 0.7, 1e-9);
  EXPECT_EQ(cell(filter->GetStateTable(), 1, "collapsed"), 0);
  EXPECT_EQ(cell(filter->GetStateTable(), 2, "collapsed_share"), 1);
}

TEST(CollapseMapFilter, StatesAsInputs)
{
  const auto image = tissue();
  vtkNew<vtkCollapseMap> filter;
  filter->SetInputData(image);
  for (const double strain : { 0.0, 0.3, 0.6 })
    filter->AddPointsData(atStrain(pressed(image, 1 - strain, strain > 0 ? 9 : 4), strain));
  EXPECT_EQ(errorOf(filter), "");
  expectMap(filter);
  EXPECT_NE(provenance(filter->GetOutput()).find("collapse_map"), std::string::npos);
  filter->SetShare(0.3);
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "lumen_collapsed"), 0);
  EXPECT_TRUE(std::isnan(number(filter->GetOutput(), "first_collapse_strain")));
}

TEST(CollapseMapFilter, StatesAsTimeSteps)
{
  vtkNew<Press> press;
  press->Tissue = tissue();
  press->Times = { 0.0, 0.3, 0.6 };
  vtkNew<vtkCollapseMap> filter;
  filter->SetInputData(press->Tissue);
  filter->SetPointsConnection(press->GetOutputPort());
  EXPECT_EQ(errorOf(filter), "");
  expectMap(filter);
  // again, from the start
  press->Times = { 0.2 };
  press->Modified();
  EXPECT_EQ(errorOf(filter), "");
  EXPECT_EQ(number(filter->GetOutput(), "state_count"), 1);
  EXPECT_NEAR(number(filter->GetOutput(), "lumen_ratio"), 0.8, 1e-9);
}

TEST(CollapseMapFilter, WhatCannotBeDoneIsRefusedInWords)
{
  const auto refused = [](const std::function<void(vtkCollapseMap*, vtkPolyData*)>& spoil, const char* words)
  {
    const auto image = tissue();
    const auto points = atStrain(pressed(image, 0.9), 0.1);
    vtkNew<vtkCollapseMap> filter;
    filter->SetInputData(image);
    spoil(filter, points);
    filter->AddPointsData(points);
    const std::string error = errorOf(filter);
    EXPECT_NE(error.find(words), std::string::npos) << error;
    EXPECT_EQ(filter->GetOutput()->GetNumberOfPoints(), 0);
    EXPECT_EQ(filter->GetLumenTable()->GetNumberOfRows(), 0);
  };
  refused([](auto* f, auto*) { f->SetPhase("resin"); }, "'resin' is no phase of this image");
  refused([](auto* f, auto*) { f->SetShare(1); }, "share 1 is not below 1");
  refused([](auto* f, auto*) { f->SetMinimumSize(17); }, "all 3 lumens are smaller than 17 nodes");
  refused([](auto*, auto* p) { p->GetPointData()->RemoveArray("id"); }, "the material points have no array 'id'");
  refused([](auto*, auto* p) { p->GetPointData()->GetArray("id")->SetTuple1(0, 0); }, "two points have the id 0");
  refused(
    [](auto*, auto* p)
    {
      vtkNew<vtkDoubleArray> vector;
      vector->SetName("deformation_gradient");
      vector->SetNumberOfComponents(3);
      vector->SetNumberOfTuples(p->GetNumberOfPoints());
      p->GetPointData()->AddArray(vector);
    },
    "array 'deformation_gradient' has 3 components");
  refused(
    [](auto*, auto* p)
    {
      vtkDataArray* const f = p->GetPointData()->GetArray("deformation_gradient");
      f->Fill(std::numeric_limits<double>::quiet_NaN());
    },
    "is not finite");
  refused([](auto*, auto* p) { p->GetFieldData()->RemoveArray("strain"); }, "neither its strain nor its time");
  refused([](auto*, auto* p) { p->Initialize(); }, "a state has no material points");
  refused([](auto* f, auto* p) { f->AddPointsData(p); }, "a state with a strain of 0.1 after one of 0.1");
  refused(
    [](auto*, auto* p)
    {
      auto other = picture(6, 6, 1, [](int x, int, int) { return x < 2 ? 0 : 1; });
      p->ShallowCopy(atStrain(pressed(other, 1), 0.1));
    },
    "points for 112 nodes of the wall");
}

} // namespace
