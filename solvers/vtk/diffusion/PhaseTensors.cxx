#include "PhaseTensors.h"

#include "BoxExchange.h"

#include "core/Error.h"
#include "core/Parse.h"

#include "vtkDataArray.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella
{
namespace
{

constexpr double unlike = 1e-5; ///< what two entries that should be equal may differ by, over the largest

using Tensor = lbm::SymmetricTensor<double>;

/// Of all entries by rows; the two that differ most, where they should not.
struct Rows
{
  Tensor tensor{};
  std::string asymmetry;
};
Rows ofRows(const double* rows, std::size_t size)
{
  Rows found;
  double largest = 0;
  for (std::size_t i = 0; i < size * size; ++i)
    largest = std::max(largest, std::abs(rows[i]));
  for (std::size_t a = 0; a < size; ++a)
    for (std::size_t b = a; b < size; ++b)
    {
      const double upper = rows[size * a + b];
      const double lower = rows[size * b + a];
      found.tensor[lbm::tensorPlace(a, b)] = 0.5 * (upper + lower);
      if (std::abs(upper - lower) > unlike * largest)
        found.asymmetry = fmt::format("{0}{1} {2:g} and {1}{0} {3:g}", "xyz"[a], "xyz"[b], upper, lower);
    }
  if (size == 2)
    found.tensor[2] = 0.5 * (found.tensor[0] + found.tensor[1]);
  return found;
}

Tensor tensorOf(const std::string& text, int dimension, const std::string& phase)
{
  const auto [numbers, wrong] = toNumbers(text);
  const char* const remedy = dimension == 3
    ? "give xx yy zz, or xx yy zz xy yz xz, or 9 numbers by rows, with spaces between them"
    : "give xx yy, or 4 numbers by rows, or those of space: xx yy zz, xx yy zz xy yz xz, or 9 by rows";
  if (wrong)
    throw ParameterError(fmt::format("'{}' of the conductivity of '{}' is no number", *wrong, phase), remedy);
  const std::size_t count = numbers.size();
  Tensor tensor{};
  if (count == 3 || count == 6)
    std::ranges::copy(numbers, tensor.begin());
  else if (dimension == 2 && count == 2)
    tensor = { numbers[0], numbers[1], 0.5 * (numbers[0] + numbers[1]), 0, 0, 0 };
  else if (count == 9 || (dimension == 2 && count == 4))
  {
    Rows rows = ofRows(numbers.data(), count == 9 ? 3 : 2);
    if (!rows.asymmetry.empty())
      throw ParameterError(
        fmt::format("the conductivity of '{}' is not symmetric: {}", phase, rows.asymmetry), "give a symmetric tensor");
    tensor = rows.tensor;
  }
  else
    throw ParameterError(fmt::format("{} numbers for the conductivity of '{}'", count, phase), remedy);
  return tensor;
}

} // namespace

PhaseTensors phaseTensors(const PhaseIds& phases, const std::map<std::string, double>& conductivity,
  const std::map<std::string, std::string>& tensors, std::span<const std::int64_t> nodes, bool byVoxel, int dimension)
{
  using Source = lbm::DirectedDiffusivity::Source;
  PhaseTensors found{ {}, {}, conductivity };
  const std::size_t ids = phases.names.size();
  std::vector<Source> source(ids, Source::Axial);
  std::vector<Tensor> ofPhase(ids);
  for (const auto& [word, text] : tensors)
  {
    const Tensor tensor = tensorOf(text, dimension, word);
    for (std::size_t id = 0; id < ids; ++id)
    {
      if (!numberOf(phases, { { word, 1.0 } }, id))
        continue;
      if (numberOf(phases, conductivity, id))
        throw ParameterError("phase '" + phases.names[id] + "' has a conductivity and a tensor", "give one of them");
      (void)lbm::requireTensor(tensor, dimension, [&] { return "of phase '" + phases.names[id] + "'"; });
      source[id] = Source::Phase;
      ofPhase[id] = tensor;
    }
    found.conductivity[word] = 1;
  }
  for (std::size_t id = 0; byVoxel && id < ids; ++id)
    if (nodes[id] > 0 && !numberOf(phases, found.conductivity, id))
    {
      source[id] = Source::Node;
      found.conductivity[phases.names[id]] = 1;
    }
  for (std::size_t id = 0; id < ids; ++id)
    if (nodes[id] > 0 && source[id] != Source::Axial)
    {
      found.source = std::move(source);
      found.ofPhase = std::move(ofPhase);
      break;
    }
  return found;
}

std::vector<lbm::SymmetricTensor<float>> gatherTensors(
  const Lattice& lattice, const lbm::Block& held, vtkDataArray* array, const Team& team)
{
  using Single = lbm::SymmetricTensor<float>;
  std::vector<Single> own(static_cast<std::size_t>(held.count()));
  team.agree(
    [&]
    {
      if (array == nullptr)
        return;
      const int components = array->GetNumberOfComponents();
      if (components != 6 && components != 9)
        throw InputError(fmt::format("array '{}' has {} components", array->GetName(), components),
          "tensors have 6, xx, yy, zz, xy, yz, xz, or 9 by rows");
      std::array<double, 9> entries{};
      for (std::size_t i = 0; i < own.size(); ++i)
      {
        array->GetTuple(static_cast<vtkIdType>(i), entries.data());
        if (components == 9)
        {
          Rows rows = ofRows(entries.data(), 3);
          if (!rows.asymmetry.empty())
          {
            const auto at = static_cast<std::int64_t>(i);
            throw InputError(fmt::format("array '{}' is not symmetric at voxel ({}, {}, {}): {}", array->GetName(),
                               held.start[0] + at % held.size[0], held.start[1] + at / held.size[0] % held.size[1],
                               held.start[2] + at / (held.size[0] * held.size[1]), rows.asymmetry),
              "give symmetric tensors");
          }
          std::ranges::copy(rows.tensor, entries.begin());
        }
        for (std::size_t c = 0; c < 6; ++c)
          own[i][c] = static_cast<float>(entries[c]);
      }
    });
  std::vector<Single> all(static_cast<std::size_t>(lattice.count()));
  const lbm::Block everything{ { 0, 0, 0 }, lattice.size };
  BoxExchange(lattice, held, everything, { false, false, false }, team.comm(), team.size()).run<Single>(own, all);
  return all;
}

} // namespace lamella
