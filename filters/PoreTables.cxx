#include "PoreTables.h"

#include "lattice/AxisNames.h"
#include "vtkLatticeConversion.h"

#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <array>
#include <cmath>
#include <string>

namespace lamella
{
namespace
{

constexpr const char* poreCreator = "vtkPoreFloodFill";

/// A column of `rows` values value(row).
template <typename Array, typename Value>
void addColumn(vtkTable* table, const std::string& name, const std::string& unit, const std::string& description,
  std::size_t rows, const Value& value)
{
  vtkNew<Array> column;
  column->SetName(name.c_str());
  column->SetNumberOfTuples(static_cast<vtkIdType>(rows));
  auto* const out = column->GetPointer(0);
  for (std::size_t row = 0; row < rows; ++row)
    out[row] = static_cast<std::remove_reference_t<decltype(*out)>>(value(row));
  describe(column, unit, description, poreCreator);
  table->AddColumn(column);
}

} // namespace

const char* nodesOf(const Lattice& lattice)
{
  return lattice.dimension == 3 ? "voxels" : "pixels";
}

void fillPores(vtkTable* table, std::span<const pores::Pore> pores, const WholeImage& whole)
{
  const Lattice& lattice = whole.lattice;
  const int dimension = lattice.dimension;
  const std::size_t rows = pores.size();
  const char* const unit = nodesOf(lattice);
  const double node = std::pow(lattice.spacing, dimension);
  addColumn<vtkIntArray>(
    table, "pore", "1", "label of the pore", rows, [](std::size_t i) { return static_cast<int>(i) + 1; });
  addColumn<vtkIdTypeArray>(
    table, "size", unit, "nodes of the pore", rows, [&](std::size_t i) { return pores[i].size; });
  addColumn<vtkDoubleArray>(
    table, dimension == 3 ? "volume" : "area", dimension == 3 ? "m^3" : "m^2", "size of the pore", rows,
    [&](std::size_t i) { return node * static_cast<double>(pores[i].size); });
  addColumn<vtkDoubleArray>(table, "equivalent_diameter", "m",
    dimension == 3 ? "diameter of the sphere of this volume" : "diameter of the circle of this area", rows,
    [&](std::size_t i)
    { return pores::equivalentDiameter(static_cast<double>(pores[i].size), lattice.spacing, dimension); });
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    addColumn<vtkDoubleArray>(
      table, std::string("centre_") + axisNames[axis], "m", "mean place of the pore's nodes", rows,
      [&](std::size_t i) { return whole.physical(pores[i].centre)[axis]; });
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::string name = axisNames[axis];
    addColumn<vtkIdTypeArray>(
      table, name + "_first", unit, "lower end of the box, counted from the image's first", rows,
      [&](std::size_t i) { return pores[i].low[axis]; });
    addColumn<vtkIdTypeArray>(table, name + "_last", unit, "upper end of the box, included", rows,
      [&](std::size_t i) { return pores[i].high[axis]; });
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (std::size_t end = 0; end < 2; ++end)
    {
      addColumn<vtkUnsignedCharArray>(
        table, std::string("touches_") + axisNames[axis] + (end == 0 ? "_min" : "_max"), "1",
        end == 0 ? "1 where it has a node in the first layer" : "1 where it has a node in the last layer", rows,
        [&](std::size_t i) { return pores[i].touches >> (2 * axis + end) & 1; });
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    addColumn<vtkUnsignedCharArray>(
      table, std::string("percolates_") + axisNames[axis], "1",
      "1 where it leads from the first layer to the last; if periodic, where it meets itself again", rows,
      [&](std::size_t i) { return pores[i].percolates >> axis & 1; });
  }
}

void fillSizeDistribution(vtkTable* table, std::span<const pores::Pore> pores, const Lattice& lattice)
{
  const std::vector<pores::SizeClass> classes = pores::sizeDistribution(pores);
  const std::size_t rows = classes.size();
  const char* const unit = nodesOf(lattice);
  std::int64_t nodes = 0;
  for (const pores::SizeClass& c : classes)
    nodes += c.nodes;
  const auto ids = [&](const char* name, const char* counted, const char* description, auto member)
  {
    addColumn<vtkIdTypeArray>(
      table, name, counted, description, rows, [&](std::size_t i) { return classes[i].*member; });
  };
  const auto diameters = [&](const char* name, const char* description, auto member)
  {
    addColumn<vtkDoubleArray>(
      table, name, "m", description, rows,
      [&](std::size_t i) {
        return pores::equivalentDiameter(static_cast<double>(classes[i].*member), lattice.spacing, lattice.dimension);
      });
  };
  const auto shares = [&](const std::string& name, const char* description, auto member, std::int64_t all)
  {
    const auto share = [&, member, all](std::size_t i)
    { return static_cast<double>(classes[i].*member) / static_cast<double>(all); };
    addColumn<vtkDoubleArray>(table, name, "1", description, rows, share);
    double sum = 0;
    addColumn<vtkDoubleArray>(table, "cumulative_" + name, "1", "sum from the smallest class on", rows,
      [&](std::size_t i) { return sum += share(i); });
  };
  using Class = pores::SizeClass;
  ids("size_from", unit, "smallest size of the class", &Class::low);
  ids("size_to", unit, "largest size of the class, included", &Class::high);
  diameters("diameter_from", "equivalent diameter of the smallest size", &Class::low);
  diameters("diameter_to", "equivalent diameter of the largest size", &Class::high);
  ids("pores", "1", "pores of the class", &Class::count);
  ids("nodes", unit, "nodes of these pores", &Class::nodes);
  shares("share_of_pores", "share of the pores' number", &Class::count, static_cast<std::int64_t>(pores.size()));
  shares("share_of_nodes", "share of the pores' nodes: weighted by area or volume", &Class::nodes, nodes);
}

} // namespace lamella
