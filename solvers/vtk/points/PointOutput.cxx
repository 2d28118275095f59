#include "PointOutput.h"

#include "Columns.h"
#include "FieldNumbers.h"

#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTable.h"
#include "vtkTypeUInt32Array.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella
{
namespace
{

constexpr std::array<const char*, 6> stressNames{ "XX", "YY", "ZZ", "XY", "YZ", "XZ" };
constexpr std::array<std::array<int, 2>, 6> stressPlaces{ { { 0, 0 }, { 1, 1 }, { 2, 2 }, { 0, 1 }, { 1, 2 },
  { 0, 2 } } };

struct Column
{
  const char* name;
  double mpm::CompressionRow::*value;
  const char* unit;
  const char* text;
};
constexpr std::array<Column, 14> curveColumns{ {
  { "strain", &mpm::CompressionRow::strain, "1", "of the height, positive in compression" },
  { "stress", &mpm::CompressionRow::stress, "Pa", "mean force on the platens over the section at the start" },
  { "imbalance", &mpm::CompressionRow::imbalance, "Pa", "upper platen's stress less the lower one's" },
  { "lateral_stress", &mpm::CompressionRow::lateral, "Pa", "mean on the sides, over their present area" },
  { "lateral_strain", &mpm::CompressionRow::lateralStrain, "1", "of the width, positive where it grows" },
  { "porosity", &mpm::CompressionRow::porosity, "1", "of the box" },
  { "elastic_energy", &mpm::CompressionRow::elastic, "J", "J/m in a plane" },
  { "kinetic_energy", &mpm::CompressionRow::kinetic, "J", "J/m in a plane" },
  { "work", &mpm::CompressionRow::work, "J", "of the platens; J/m in a plane" },
  { "dissipated", &mpm::CompressionRow::dissipated, "J", "by method, damping and yield; J/m in a plane" },
  { "plastic_work", &mpm::CompressionRow::plastic, "J", "of what was dissipated: by walls that yield; J/m in a plane" },
  { "speed", &mpm::CompressionRow::speed, "1", "of the platens towards each other, over the fastest wave in the wall" },
  { "steps", &mpm::CompressionRow::steps, "1", "done" },
  { "time", &mpm::CompressionRow::time, "s", "of the motion" },
} };
static_assert(sizeof(mpm::CompressionRow) == curveColumns.size() * sizeof(double), "a column a number of the row");

/// A state's arrays, one value a point; those not asked for are empty.
struct StateColumns
{
  StateColumns(const PointArrays& arrays, std::size_t count)
    : asked(arrays)
    , displacement(newArray<vtkDoubleArray>("displacement", 3, arrays.displacement ? count : 0))
    , velocity(newArray<vtkDoubleArray>("velocity", 3, arrays.velocity ? count : 0))
    , stress(newArray<vtkDoubleArray>("stress", 6, arrays.stress ? count : 0))
    , gradient(newArray<vtkDoubleArray>("deformation_gradient", 9, arrays.deformationGradient ? count : 0))
    , energy(newArray<vtkDoubleArray>("energy_density", 1, arrays.energyDensity ? count : 0))
    , plastic(newArray<vtkDoubleArray>("plastic_strain", 1, arrays.plasticStrain ? count : 0))
  {
    for (int c = 0; c < 6; ++c)
      stress->SetComponentName(c, stressNames[static_cast<std::size_t>(c)]);
  }

  /// @param period of periodic axes, where points come in again at the other end; else 0
  template <int Dim>
  void setMotion(vtkIdType to, const mpm::Vector<Dim>& x, const mpm::Vector<Dim>& start, const mpm::Vector<Dim>& v,
    const std::array<double, Dim>& period)
  {
    for (int c = 0; c < 3 && asked.displacement; ++c)
    {
      double u = c < Dim ? x[c] - start[c] : 0;
      if (const double length = c < Dim ? period[static_cast<std::size_t>(c)] : 0; length > 0)
        u -= length * std::round(u / length);
      displacement->SetTypedComponent(to, c, u);
    }
    for (int c = 0; c < 3 && asked.velocity; ++c)
      velocity->SetTypedComponent(to, c, c < Dim ? v[c] : 0);
  }

  template <int Dim>
  void setDeformation(
    vtkIdType to, const mpm::MaterialPoints<Dim>& points, std::size_t i, const mpm::PointLaw<Dim>& law)
  {
    using Points = mpm::MaterialPoints<Dim>;
    if (!asked.stress && !asked.deformationGradient && !asked.energyDensity && !asked.plasticStrain)
      return;
    const auto phase = points.phase()[i];
    const mpm::Matrix<Dim> F = points.matrix(Points::deformations, i);
    const mpm::Vector<Dim> axis = points.vector(Points::axes, i);
    const auto memory = points.memory(i);
    const double thirdStretch = law.thirdStretch(memory.data());
    if (asked.stress)
    {
      const mpm::Matrix<Dim> tau = law.kirchhoff(phase, F, axis, memory.data());
      const double third = law.thirdStress(phase, F, axis, memory.data());
      const double J = mpm::determinant(F) * thirdStretch;
      for (int c = 0; c < 6; ++c)
      {
        const auto [a, b] = stressPlaces[static_cast<std::size_t>(c)];
        stress->SetTypedComponent(to, c, (a < Dim && b < Dim ? tau(a, b) : a == b ? third : 0) / J);
      }
    }
    for (int c = 0; c < 9 && asked.deformationGradient; ++c)
    {
      const int a = c / 3;
      const int b = c % 3;
      gradient->SetTypedComponent(to, c, a < Dim && b < Dim ? F(a, b) : (a == b ? thirdStretch : 0));
    }
    if (asked.energyDensity)
      energy->SetValue(to, law.energy(phase, F, axis, memory.data()));
    if (asked.plasticStrain)
      plastic->SetValue(to, law.plasticStrain(memory.data()));
  }

  void addTo(vtkPointData* data, const char* creator) const
  {
    describe(displacement, "m", "from the start", creator);
    describe(velocity, "m/s", "half a step ago", creator);
    describe(stress, "Pa", "Cauchy's, tension positive; of a picture yz and xz are 0, in plane stress zz too", creator);
    describe(gradient, "1",
      "by rows; of walls that yield its elastic part; of a picture zz is 1, or the elastic part's", creator);
    describe(energy, "J/m^3", "elastic, over the volume at the start", creator);
    describe(plastic, "1", "equivalent, all that has flowed added up; 0 of walls that do not yield", creator);
    for (vtkDoubleArray* const array :
      std::initializer_list<vtkDoubleArray*>{ displacement, velocity, stress, gradient, energy, plastic })
      if (array->GetNumberOfTuples() > 0)
        data->AddArray(array);
    data->SetActiveVectors(asked.displacement ? "displacement" : asked.velocity ? "velocity" : nullptr);
  }

  PointArrays asked;
  vtkSmartPointer<vtkDoubleArray> displacement;
  vtkSmartPointer<vtkDoubleArray> velocity;
  vtkSmartPointer<vtkDoubleArray> stress;
  vtkSmartPointer<vtkDoubleArray> gradient;
  vtkSmartPointer<vtkDoubleArray> energy;
  vtkSmartPointer<vtkDoubleArray> plastic;
};

} // namespace

template <int Dim>
PointShare<Dim> shareAtStart(
  const mpm::MaterialPoints<Dim>& points, const std::vector<std::int64_t>& firsts, const Communicator& comm)
{
  using Points = mpm::MaterialPoints<Dim>;
  const Points moved = comm.parallel() ? mpm::PointRanks<Dim>(comm).byNumber(points, firsts) : Points();
  const Points& mine = comm.parallel() ? moved : points;
  PointShare<Dim> share{ firsts, firsts[static_cast<std::size_t>(comm.rank())], {} };
  share.places.resize(mine.count());
  for (std::size_t p = 0; p < mine.count(); ++p)
    share.places[static_cast<std::size_t>(mine.id()[p] - share.first)] = mine.vector(Points::positions, p);
  return share;
}

template <int Dim>
void setPointState(vtkPolyData* output, const mpm::PointCompression<Dim>& run, const mpm::PointLaw<Dim>& law,
  const PointShare<Dim>& share, const PointArrays& arrays, double depth, const char* creator)
{
  using Points = mpm::MaterialPoints<Dim>;
  const bool several = share.firsts.size() > 2;
  const Points moved = several ? run.body().byNumber(share.firsts) : Points();
  const Points& p = several ? moved : run.body().points();
  const std::size_t count = p.count();
  const auto places = newPoints(count);
  const auto id = newArray<vtkTypeUInt32Array>("id", 1, count);
  const auto phase = newArray<vtkUnsignedCharArray>("phase", 1, count);
  StateColumns state(arrays, count);
  std::array<double, Dim> period{};
  for (int a = 0; a < Dim; ++a)
  {
    period[static_cast<std::size_t>(a)] = run.body().grid().axis(a).edge[0] == mpm::Edge::Periodic
      ? run.body().position(a, 1) - run.body().position(a, 0)
      : 0;
  }
  for (std::size_t i = 0; i < count; ++i)
  {
    const std::uint32_t number = p.id()[i];
    const auto to = static_cast<vtkIdType>(number - share.first);
    const mpm::Vector<Dim> x = p.vector(Points::positions, i);
    places->SetPoint(to, x[0], x[1], Dim == 3 ? x[Dim - 1] : depth);
    id->SetValue(to, number);
    phase->SetValue(to, p.phase()[i]);
    const mpm::Vector<Dim>& start = share.places[static_cast<std::size_t>(to)];
    state.setMotion<Dim>(to, x, start, p.vector(Points::velocities, i), period);
    state.setDeformation<Dim>(to, p, i, law);
  }
  describe(id, "1", "number of the point, the same in all states", creator);
  describe(phase, "1", "phase of the point", creator);
  setVertices(output, places);
  vtkPointData* const data = output->GetPointData();
  addArrays(data, { id, phase });
  state.addTo(data, creator);
  data->SetActiveScalars("phase");
  setFieldNumber(output, "strain", run.strain(), "1", "of the height, positive in compression", creator);
  output->GetInformation()->Set(vtkDataObject::DATA_TIME_STEP(), run.strain());
}

void setCompressionCurve(vtkTable* output, const std::vector<mpm::CompressionRow>& rows, const char* creator)
{
  output->Initialize();
  for (const Column& column : curveColumns)
    Columns{ output->GetRowData(), rows, creator }.numbers(column.name, column.unit, column.text, column.value);
}

double stressAt(const std::vector<mpm::CompressionRow>& rows, double strain)
{
  const auto next = std::lower_bound(
    rows.begin(), rows.end(), strain, [](const mpm::CompressionRow& row, double e) { return row.strain < e; });
  if (next == rows.begin() || next == rows.end())
    return rows.empty() ? 0 : (next == rows.end() ? rows.back() : rows.front()).stress;
  const auto before = next - 1;
  const double share = (strain - before->strain) / (next->strain - before->strain);
  return before->stress + share * (next->stress - before->stress);
}

template PointShare<2> shareAtStart<2>(
  const mpm::MaterialPoints<2>&, const std::vector<std::int64_t>&, const Communicator&);
template PointShare<3> shareAtStart<3>(
  const mpm::MaterialPoints<3>&, const std::vector<std::int64_t>&, const Communicator&);
template void setPointState<2>(vtkPolyData*, const mpm::PointCompression<2>&, const mpm::PointLaw<2>&,
  const PointShare<2>&, const PointArrays&, double, const char*);
template void setPointState<3>(vtkPolyData*, const mpm::PointCompression<3>&, const mpm::PointLaw<3>&,
  const PointShare<3>&, const PointArrays&, double, const char*);

} // namespace lamella
