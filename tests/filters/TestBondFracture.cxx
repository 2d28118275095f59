// Fracture through VTK's pipeline: what breaks is what the solver breaks, arrays and tables agree with each other; on
// distributed images the same bonds break.
#include "FractureTesting.h"

#include "core/Communicator.h"
#include "peridynamics/fracture/FractureStudy.h"

#include "vtkInformation.h"
#include "vtkMath.h"

#include <algorithm>
#include <numbers>

namespace
{

using namespace lamella;
using namespace lamella::vtktest;
namespace pd = lamella::peridynamics;

pd::BondModel model(int dimension)
{
  pd::BondModel m;
  m.continuum = dimension == 3 ? pd::Continuum::Space : pd::Continuum::PlaneStress;
  m.micromodulus = dimension == 3 ? pd::Micromodulus::Isotropic : pd::Micromodulus::Continuum; // the defaults
  m.pairs[{ 1, 1 }].material = { .youngsModulus = 4e9, .criticalStretch = 1e-2 };
  m.pairs[{ 2, 2 }].material = { .youngsModulus = 1e9, .criticalStretch = 2e-3 };
  m.pairs[{ 1, 2 }] = m.pairs[{ 2, 2 }];
  return m;
}

TEST_F(BondFracture, IsTheSolver)
{
  for (const int nz : { 1, 9 })
  {
    SCOPED_TRACE(nz);
    const auto image = band(24, nz > 1 ? 24 : 36, nz);
    vtkNew<vtkBondFracture> filter;
    configure(filter);
    filter->SetInputData(image);
    filter->SetMaximumBroken(nz > 1 ? 60 : 0);
    ASSERT_EQ(errorOf(filter), "");

    const PhaseView view = viewPhases(image);
    const Communicator alone(MPI_COMM_SELF);
    pd::BondLattice bonds(model(view.lattice.dimension), view.lattice, view.phase, {}, alone);
    pd::FractureOptions options;
    if (nz > 1)
      options.maxBroken = 60;
    pd::QuasiStaticFracture direct(bonds, {}, options);
    const pd::FractureEnd end = direct.run();
    const pd::FractureRecord& record = direct.record();

    vtkPolyData* const broken = filter->GetBrokenBonds();
    const vtkIdType count = broken->GetNumberOfPoints();
    ASSERT_EQ(count, static_cast<vtkIdType>(record.broken.size()));
    ASSERT_GT(count, 50);
    EXPECT_EQ(broken->GetNumberOfVerts(), count);
    vtkPointData* const data = broken->GetPointData();
    const std::vector<pd::BondEnds> ends = pd::endsOf(bonds, record.broken, view.phase, {});
    std::vector<int> ofNode(static_cast<std::size_t>(image->GetNumberOfPoints()));
    for (vtkIdType i = 0; i < count; ++i)
    {
      const auto k = static_cast<std::size_t>(i);
      const pd::BrokenBond& b = record.broken[k];
      EXPECT_EQ(data->GetArray("event")->GetTuple1(i), static_cast<double>(b.event));
      EXPECT_EQ(data->GetArray("strain")->GetTuple1(i), b.strain);
      EXPECT_EQ(data->GetArray("critical_strain")->GetTuple1(i), b.criticalStrain);
      EXPECT_EQ(data->GetArray("stress")->GetTuple1(i), b.stress);
      EXPECT_EQ(data->GetArray("phases")->GetComponent(i, 0), ends[k].low);
      EXPECT_EQ(data->GetArray("phases")->GetComponent(i, 1), ends[k].high);
      EXPECT_EQ(data->GetArray("between_grains")->GetTuple1(i), 0);
      // half a bond to either side of its middle there are nodes, and these are where damage is counted
      for (const double side : { -0.5, 0.5 })
      {
        double at[3];
        broken->GetPoint(i, at);
        for (int c = 0; c < 3; ++c)
          at[c] += side * data->GetArray("bond")->GetComponent(i, c);
        const vtkIdType node = image->FindPoint(at);
        ASSERT_GE(node, 0);
        EXPECT_NEAR(vtkMath::Distance2BetweenPoints(at, image->GetPoint(node)), 0, 1e-6 * bandSpacing * bandSpacing);
        ++ofNode[static_cast<std::size_t>(node)];
      }
    }
    vtkImageData* const output = filter->GetOutput();
    const pd::BondLattice whole(model(view.lattice.dimension), view.lattice, view.phase, {}, alone);
    const pd::NodeLayout& l = whole.layout();
    for (vtkIdType i = 0; i < output->GetNumberOfPoints(); ++i)
    {
      ASSERT_EQ(points(output, "broken")->GetTuple1(i), ofNode[static_cast<std::size_t>(i)]);
      const int degree = whole.degree(l.index(i % l.size[0], i / l.size[0] % l.size[1], i / (l.size[0] * l.size[1])));
      const double share = degree > 0 ? static_cast<double>(ofNode[static_cast<std::size_t>(i)]) / degree : 0;
      const bool solid = view.phase[static_cast<std::size_t>(i)] != 0;
      const double damage = points(output, "damage")->GetTuple1(i);
      ASSERT_TRUE(solid ? damage == share : std::isnan(damage)) << i; // painted apart from what is whole
      const double* const moved = points(output, "displacement")->GetTuple3(i);
      ASSERT_TRUE(solid || (moved[0] == 0 && moved[1] == 0 && moved[2] == 0)) << i;
    }
    EXPECT_EQ(points(output, "phase"), points(image, "phase"));
    EXPECT_EQ(points(output, "stress"), nullptr); // not asked for
    EXPECT_EQ(filter->GetPeakStress(), record.peak.stress);
    EXPECT_EQ(number(output, "peak_stress"), record.peak.stress);
    EXPECT_EQ(number(output, "first_break_strain"), record.first.strain);
    EXPECT_EQ(number(output, "effective_modulus"), record.modulus);
    EXPECT_EQ(number(output, "total_broken"), static_cast<double>(count));
    EXPECT_EQ(fieldText(output, "end_reason"), pd::describe(end));
    EXPECT_EQ(fieldText(output, "end"), nz > 1 ? "maximum-broken" : "stress-fell");
    EXPECT_EQ(fieldText(output, "method"), "events");
    EXPECT_EQ(output->GetInformation()->Get(vtkDataObject::DATA_TIME_STEP()), direct.strain());
    EXPECT_EQ(number(broken, "spacing"), bandSpacing);
    EXPECT_EQ(number(broken, "lattice_size", 1), nz > 1 ? 24 : 36);
    EXPECT_EQ(number(broken, "horizon"), 3);
    EXPECT_EQ(fieldTexts(broken, "phase_names").size(), 3U);
    EXPECT_NE(provenance(output).find("\"fracture\""), std::string::npos);
  }
}

// Between two breaks stress is in proportion to strain, and the path that follows every snap-back never lies beyond the
// imposed strain; every event has a row.
TEST_F(BondFracture, CurveHoldsTogether)
{
  vtkNew<vtkBondFracture> filter;
  configure(filter);
  filter->SetInputData(band());
  ASSERT_EQ(errorOf(filter), "");
  vtkTable* const curve = filter->GetCurve();
  vtkPointData* const broken = filter->GetBrokenBonds()->GetPointData();
  const vtkIdType rows = curve->GetNumberOfRows();
  EXPECT_EQ(cell(curve, 0, "strain"), 0);
  EXPECT_EQ(cell(curve, 0, "stress"), 0);
  double most = 0;
  vtkIdType event = 0;
  for (vtkIdType row = 1; row < rows; ++row)
  {
    EXPECT_GE(cell(curve, row, "strain"), cell(curve, row - 1, "strain"));
    EXPECT_GE(cell(curve, row, "broken"), cell(curve, row - 1, "broken"));
    EXPECT_LE(cell(curve, row, "critical_strain"), cell(curve, row, "strain"));
    EXPECT_NEAR(cell(curve, row, "critical_stress") * cell(curve, row, "strain"),
      cell(curve, row, "stress") * cell(curve, row, "critical_strain"),
      1e-12 * cell(curve, row, "stress") * cell(curve, row, "strain"));
    most = std::max(most, cell(curve, row, "stress"));
    if (event < broken->GetNumberOfTuples() && cell(curve, row, "broken") == static_cast<double>(event) &&
      cell(curve, row, "strain") == broken->GetArray("strain")->GetTuple1(event))
    {
      EXPECT_EQ(cell(curve, row, "stress"), broken->GetArray("stress")->GetTuple1(event));
      EXPECT_EQ(cell(curve, row, "critical_strain"), broken->GetArray("critical_strain")->GetTuple1(event));
      ++event;
    }
  }
  EXPECT_EQ(event, broken->GetNumberOfTuples());
  EXPECT_EQ(most, filter->GetPeakStress());
  EXPECT_EQ(cell(curve, rows - 1, "broken"), static_cast<double>(event));
  EXPECT_LE(cell(curve, rows - 1, "stress"), 0.05 * most);
}

// With four neighbours a node one bond a column crosses the band, k = 9 E/(π h³) δx⁴ and half of k s0² δx each: when
// all have gone nothing holds, and the end bears nothing.
TEST_F(BondFracture, EnergyOfASeveredStrip)
{
  vtkNew<vtkBondFracture> filter;
  filter->SetInputData(picture(
    20, 40, 1, [](int, int y, int) { return y < 20 ? 1 : 2; }, bandSpacing));
  filter->SetHorizon(1);
  for (const char* const pair : { "b", "c", "b-c" })
    filter->SetYoungsModulus(pair, 1e9);
  filter->SetCriticalStretch("b-c", 1e-3);
  filter->SetStopShare(0);
  ASSERT_EQ(errorOf(filter), "");
  vtkImageData* const output = filter->GetOutput();
  EXPECT_EQ(fieldText(output, "end"), "severed");
  EXPECT_EQ(number(output, "total_broken"), 20);
  const double k = 9 * 1e9 / (std::numbers::pi * std::pow(bandSpacing, 3)) * std::pow(bandSpacing, 4);
  EXPECT_NEAR(number(output, "broken_energy") / (20 * 0.5 * k * 1e-6 * bandSpacing), 1, 1e-12);
  EXPECT_EQ(number(output, "stress"), 0);
  EXPECT_EQ(cell(filter->GetCurve(), filter->GetCurve()->GetNumberOfRows() - 1, "stress"), 0);
  // both halves rest with their platens, which stand apart by what the high one has moved
  const auto y = [&](vtkIdType row) { return points(output, "displacement")->GetComponent(20 * row + 7, 1); };
  EXPECT_NEAR(y(20) - y(19), number(output, "strain") * 39 * bandSpacing, 1e-6 * bandSpacing);
}

TEST_F(BondFracture, RanksChangeNothing)
{
  for (const int method : { vtkBondFracture::ACCURATE, vtkBondFracture::AUTO }) // which is by events
    expectSameOnRanks<vtkBondFracture>(
      [method](vtkBondFracture* filter, bool)
      {
        filter->SetMethod(method);
        filter->SetTolerance(1e-9);
      },
      1e-6, 1e-8);
}

} // namespace
