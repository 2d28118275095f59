#include "PoreTables.h"

#include "Columns.h"

#include "lattice/AxisNames.h"

#include "vtkDataSetAttributes.h"
#include "vtkIntArray.h"
#include "vtkTable.h"
#include "vtkUnsignedCharArray.h"

#include <cmath>
#include <string>

namespace lamella
{
namespace
{

constexpr const char* poreCreator = "vtkPoreFloodFill";

} // namespace

const char* nodesOf(const Lattice& lattice)
{
  return lattice.dimension == 3 ? "voxels" : "pixels";
}

void fillPores(vtkTable* table, std::span<const pores::Pore> pores, const WholeImage& whole)
{
  const Lattice& lattice = whole.lattice;
  const int dimension = lattice.dimension;
  using pores::Pore;
  const Columns columns{ table->GetRowData(), pores, poreCreator };
  const char* const unit = nodesOf(lattice);
  const double node = std::pow(lattice.spacing, dimension);
  columns.add<vtkIntArray>("pore", "1", "label of the pore", [](std::size_t i) { return i + 1; });
  columns.add<vtkIdTypeArray>("size", unit, "nodes of the pore", &Pore::size);
  columns.numbers(
    dimension == 3 ? "volume" : "area", dimension == 3 ? "m^3" : "m^2", "size of the pore",
    [&](const Pore& pore) { return node * static_cast<double>(pore.size); });
  columns.numbers("equivalent_diameter", "m",
    dimension == 3 ? "diameter of the sphere of this volume" : "diameter of the circle of this area",
    [&](const Pore& pore)
    { return pores::equivalentDiameter(static_cast<double>(pore.size), lattice.spacing, dimension); });
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    columns.numbers(
      std::string("centre_") + axisNames[axis], "m", "mean place of the pore's nodes",
      [&](const Pore& pore) { return whole.physical(pore.centre)[axis]; });
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const std::string name = axisNames[axis];
    columns.add<vtkIdTypeArray>(
      name + "_first", unit, "lower end of the box, counted from the image's first",
      [&](const Pore& pore) { return pore.low[axis]; });
    columns.add<vtkIdTypeArray>(
      name + "_last", unit, "upper end of the box, included", [&](const Pore& pore) { return pore.high[axis]; });
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    for (std::size_t end = 0; end < 2; ++end)
    {
      columns.add<vtkUnsignedCharArray>(
        std::string("touches_") + axisNames[axis] + (end == 0 ? "_min" : "_max"), "1",
        end == 0 ? "1 where it has a node in the first layer" : "1 where it has a node in the last layer",
        [&](const Pore& pore) { return pore.touches >> (2 * axis + end) & 1; });
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    columns.add<vtkUnsignedCharArray>(
      std::string("percolates_") + axisNames[axis], "1",
      "1 where it leads from the first layer to the last; if periodic, where it meets itself again",
      [&](const Pore& pore) { return pore.percolates >> axis & 1; });
  }
}

void fillSizeDistribution(vtkTable* table, std::span<const pores::Pore> pores, const Lattice& lattice)
{
  const std::vector<pores::SizeClass> classes = pores::sizeDistribution(pores);
  const Columns columns{ table->GetRowData(), classes, poreCreator };
  const char* const unit = nodesOf(lattice);
  std::int64_t nodes = 0;
  for (const pores::SizeClass& c : classes)
    nodes += c.nodes;
  using Class = pores::SizeClass;
  const auto diameters = [&](const char* name, const char* description, auto member)
  {
    columns.numbers(
      name, "m", description,
      [&](const Class& c)
      { return pores::equivalentDiameter(static_cast<double>(c.*member), lattice.spacing, lattice.dimension); });
  };
  const auto shares = [&](const std::string& name, const char* description, auto member, std::int64_t all)
  {
    const auto share = [&, member, all](const Class& c)
    { return static_cast<double>(c.*member) / static_cast<double>(all); };
    columns.numbers(name, "1", description, share);
    double sum = 0;
    columns.numbers(
      "cumulative_" + name, "1", "sum from the smallest class on", [&](const Class& c) { return sum += share(c); });
  };
  columns.add<vtkIdTypeArray>("size_from", unit, "smallest size of the class", &Class::low);
  columns.add<vtkIdTypeArray>("size_to", unit, "largest size of the class, included", &Class::high);
  diameters("diameter_from", "equivalent diameter of the smallest size", &Class::low);
  diameters("diameter_to", "equivalent diameter of the largest size", &Class::high);
  columns.add<vtkIdTypeArray>("pores", "1", "pores of the class", &Class::count);
  columns.add<vtkIdTypeArray>("nodes", unit, "nodes of these pores", &Class::nodes);
  shares("share_of_pores", "share of the pores' number", &Class::count, static_cast<std::int64_t>(pores.size()));
  shares("share_of_nodes", "share of the pores' nodes: weighted by area or volume", &Class::nodes, nodes);
}

} // namespace lamella
