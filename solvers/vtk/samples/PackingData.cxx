#include "PackingData.h"

#include "Columns.h"
#include "FieldNumbers.h"

#include "core/Error.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lamella
{
namespace
{

void setNumbers(
  vtkDataObject* data, const packing::Packing& p, const packing::PackingStatistics& s, const std::string& creator)
{
  const std::array<double, 3> periodic{ p.periodic[0] ? 1.0 : 0.0, p.periodic[1] ? 1.0 : 0.0,
    p.periodic[2] ? 1.0 : 0.0 };
  setFieldNumbers(data, "box", p.size, "m", "edges of the box, from the origin; z is 0 in 2D", creator);
  setFieldNumbers(data, "periodic", periodic, "1", "1 for axes that are periodic", creator);
  setFieldNumbers(
    data, "fabric", s.fabric, "1", "mean of n n over the contacts between grains, by rows; its trace is 1", creator);
  setFieldNumbers(data, "stress", s.stress, "Pa", "mean stress, by rows; compression is positive", creator);
  const auto number = [&](const char* name, double value, const char* unit, const char* text)
  { setFieldNumber(data, name, value, unit, text, creator); };
  number("packing_fraction", s.packingFraction, "1", "share of the box that is grains");
  number("aspect", s.aspect, "1", "edge of the box along the last axis over the first");
  number("rattlers", static_cast<double>(s.rattlers), "1", "grains that nothing holds");
  number("contacts", static_cast<double>(s.grainContacts), "1", "contacts between grains that are no rattlers");
  number("wall_contacts", static_cast<double>(s.wallContacts), "1", "contacts with walls of grains, no rattlers");
  number("coordination", s.coordination, "1", "contacts of a grain that is no rattler");
  number("fabric_anisotropy", s.fabricAnisotropy, "1", "of the principal values, (largest - smallest)/sum");
  number("stress_anisotropy", s.stressAnisotropy, "1", "of the principal values, (largest - smallest)/sum");
  number("unbalanced_force", p.unbalanced, "1", "mean net force on a grain over the mean contact force");
  number("pressure", p.pressure, "Pa", "mean stress");
  setFieldTexts(data, "warnings", p.warnings);
}

double alongOf(const packing::Contact& c)
{
  return c.force[0] * c.normal[0] + c.force[1] * c.normal[1] + c.force[2] * c.normal[2];
}

/// Of each grain: the sum of its contacts' forces, and of their parts along the contacts.
void setForces(const packing::Packing& p, const std::string& creator, vtkPolyData* particles)
{
  const auto net = newArray<vtkDoubleArray>("net_force", 3, p.count());
  const auto normal = newArray<vtkDoubleArray>("normal_force", 1, p.count());
  net->FillValue(0);
  normal->FillValue(0);
  for (const packing::Contact& c : p.contacts)
  {
    const double along = alongOf(c);
    const auto add = [&](std::int32_t grain, double sign)
    {
      for (int axis = 0; axis < 3; ++axis)
        net->SetTypedComponent(
          grain, axis, net->GetTypedComponent(grain, axis) + sign * c.force[static_cast<std::size_t>(axis)]);
      normal->SetValue(grain, normal->GetValue(grain) + along);
    };
    add(c.first, -1);
    if (c.second >= 0)
      add(c.second, 1);
  }
  const char* const unit = p.dimension == 3 ? "N" : "N/m";
  describe(net, unit, "sum of the forces on the grain", creator);
  describe(normal, unit, "sum of its contacts' forces along them; compression is positive", creator);
  addArrays(particles->GetPointData(), { net, normal });
}

void setContacts(const packing::Packing& p, const std::string& creator, vtkPolyData* out)
{
  using packing::Contact;
  const std::size_t count = p.contacts.size();
  const auto points = newPoints(2 * count);
  vtkNew<vtkCellArray> lines;
  const auto force = newArray<vtkDoubleArray>("force", 3, count);
  const auto atPoints = newArray<vtkDoubleArray>("normal_force", 1, 2 * count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Contact& c = p.contacts[i];
    const auto id = static_cast<vtkIdType>(i);
    const std::array<double, 3>& from = p.centre[static_cast<std::size_t>(c.first)];
    points->SetPoint(2 * id, from.data());
    points->SetPoint(2 * id + 1, from[0] + c.branch[0], from[1] + c.branch[1], from[2] + c.branch[2]);
    lines->InsertNextCell({ 2 * id, 2 * id + 1 });
    force->SetTuple(id, c.force.data());
    atPoints->SetValue(2 * id, alongOf(c));
    atPoints->SetValue(2 * id + 1, alongOf(c));
  }
  const char* const unit = p.dimension == 3 ? "N" : "N/m";
  const char* const along = "part of the force along the line; compression is positive";
  describe(force, unit, "on the second grain (or wall) by the first", creator);
  describe(atPoints, unit, along, creator);
  out->Initialize();
  out->SetPoints(points);
  out->SetLines(lines);
  out->GetPointData()->SetScalars(atPoints);
  vtkCellData* const cells = out->GetCellData();
  const Columns columns{ cells, p.contacts, creator };
  columns.numbers("normal_force", unit, along, alongOf);
  cells->SetActiveScalars("normal_force");
  cells->SetVectors(force);
  columns.numbers("overlap", "m", "sum of the radii less the distance of the centres", &Contact::overlap);
  columns.add<vtkIntArray>(
    "first", "1", "number of the first grain, from 1", [](const Contact& c) { return c.first + 1; });
  columns.add<vtkIntArray>(
    "second", "1", "number of the second grain; -1 ... -6: wall at low x, high x, low y ... high z",
    [](const Contact& c) { return c.second < 0 ? c.second : c.second + 1; });
  columns.add<vtkUnsignedCharArray>(
    "wall", "1", "1 where the second is a wall", [](const Contact& c) { return c.second < 0; });
}

} // namespace

void setPacking(const packing::Packing& p, const packing::PackingStatistics& s, const std::string& creator,
  vtkPolyData* particles, vtkPolyData* contacts)
{
  const std::size_t count = p.count();
  const auto points = newPoints(count);
  std::vector<int> touching(count);
  for (std::size_t i = 0; i < count; ++i)
    points->SetPoint(static_cast<vtkIdType>(i), p.centre[i].data());
  for (const packing::Contact& c : p.contacts)
    for (const std::int32_t grain : { c.first, c.second })
      if (grain >= 0)
        ++touching[static_cast<std::size_t>(grain)];
  setVertices(particles, points);
  const Columns columns{ particles->GetPointData(), p.centre, creator };
  columns.numbers(
    "radius", "m", "radius of the grain", [&](std::size_t i) { return p.radius[i]; });
  columns.numbers(
    "diameter", "m", "diameter of the grain", [&](std::size_t i) { return 2 * p.radius[i]; });
  columns.add<vtkIntArray>(
    "grain", "1", "number of the grain, from 1", [](std::size_t i) { return i + 1; });
  columns.add<vtkIntArray>(
    "contacts", "1", "contacts of the grain, those with walls included", [&](std::size_t i) { return touching[i]; });
  columns.add<vtkUnsignedCharArray>(
    "rattler", "1", "1 for grains that nothing holds", [&](std::size_t i) { return s.rattler[i]; });
  particles->GetPointData()->SetActiveScalars("radius");
  setForces(p, creator, particles);
  setNumbers(particles, p, s, creator);
  if (contacts != nullptr)
  {
    setContacts(p, creator, contacts);
    contacts->GetFieldData()->ShallowCopy(particles->GetFieldData());
  }
}

std::size_t packingBytes(const packing::Packing& packing)
{
  return 150 * packing.count() + 240 * packing.contacts.size();
}

packing::Packing packingFrom(vtkPolyData* particles)
{
  vtkPointData* const data = particles->GetPointData();
  vtkDataArray* array = data->GetArray("radius");
  const double scale = array != nullptr ? 1 : 0.5;
  if (array == nullptr)
    array = data->GetArray("diameter");
  if (array == nullptr || array->GetNumberOfComponents() != 1)
  {
    throw InputError("the points have no array 'radius' (nor 'diameter')",
      "give the grains of a packing as lamella packing writes them, or a table x,z,r");
  }
  const auto count = static_cast<std::size_t>(particles->GetNumberOfPoints());
  std::vector<std::array<double, 3>> centre(count);
  std::vector<double> radius(count);
  bool flat = true;
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto id = static_cast<vtkIdType>(i);
    particles->GetPoint(id, centre[i].data());
    radius[i] = scale * array->GetTuple1(id);
    flat = flat && centre[i][2] == 0;
  }
  const std::vector<double> box = fieldNumbers(particles, "box");
  if (box.size() != 3)
    return packing::packingOf(flat ? 2 : 3, centre, radius);
  const int dimension = box[2] > 0 ? 3 : 2;
  const auto axes = static_cast<std::size_t>(dimension);
  packing::Packing p;
  p.dimension = dimension;
  std::copy(box.begin(), box.end(), p.size.begin());
  const std::vector<double> periodic = fieldNumbers(particles, "periodic");
  for (std::size_t i = 0; i < count; ++i)
  {
    bool inside = std::isfinite(radius[i]) && radius[i] > 0;
    for (std::size_t a = 0; a < axes; ++a)
      inside = inside && centre[i][a] >= 0 && centre[i][a] <= box[a];
    if (!inside)
    {
      // Says in packingOf()'s words what is wrong with this one.
      static_cast<void>(packing::packingOf(dimension, centre, radius, p.size));
    }
  }
  if (count == 0)
    throw InputError("there are no grains", "give a packing that has some");
  for (std::size_t a = 0; a < axes && periodic.size() == 3; ++a)
    p.periodic[a] = periodic[a] != 0;
  p.centre = std::move(centre);
  p.radius = std::move(radius);
  return p;
}

vtkSmartPointer<vtkImageData> cementedImage(const packing::Packing& packing, const packing::BridgeOptions& bridges,
  const packing::RasterOptions& raster, const std::string& creator)
{
  if (bridges.filled && bridges.saturation)
  {
    throw ParameterError("a saturation is given and all space is to be filled: these contradict each other",
      "leave one of them out; filled is a saturation of 1");
  }
  packing::CementedSample sample = packing::cement(packing, bridges, raster);
  const auto image = toImageData(std::move(sample.image));
  const auto grain = newArray<vtkIntArray>("grain", 1, sample.grain.size());
  std::copy(sample.grain.begin(), sample.grain.end(), grain->GetPointer(0));
  describe(grain, "1", "number of the grain, from 1; 0: none, -1: platen", creator);
  image->GetPointData()->AddArray(grain);
  const auto add = [&](const char* name, const std::vector<float>& values, const char* text)
  {
    if (values.empty())
      return;
    const auto share = newArray<vtkFloatArray>(name, 1, values.size());
    std::copy(values.begin(), values.end(), share->GetPointer(0));
    describe(share, "1", text, creator);
    image->GetPointData()->AddArray(share);
  };
  add("grain_share", sample.grainShare, "part of the voxel around the point that is grain");
  add("solid_share", sample.solidShare, "part of the voxel around the point that is grain or matrix");
  const auto number = [&](const char* name, double value, const char* text)
  { setFieldNumber(image, name, value, "1", text, creator); };
  number("width", sample.width, "width of a bridge at a grain's centre over the grain's diameter");
  number("reach", bridges.reach, "grains nearer than this times the sum of their radii have a bridge");
  number("bridges", static_cast<double>(sample.bridges), "pairs of grains with a bridge");
  number("grain_fraction", sample.fractions.grains, "share of the box that is grains, without platens");
  number("matrix_fraction", sample.fractions.matrix, "share of the box that is matrix, without platens");
  number("void_fraction", sample.fractions.voids, "share of the box that is void, without platens");
  number("saturation", sample.fractions.saturation, "share of the space between grains that is matrix");
  number("saturation_on_lattice", sample.onLattice.saturation, "the same of the nodes");
  setFieldText(image, "pixel_size_source", "packing");
  setFieldTexts(image, "warnings", sample.warnings);
  return image;
}

} // namespace lamella
