#pragma once

#include "vtkPieces.h"

#include "lattice/GreyBins.h"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;
class vtkImageData;
class vtkInformation;

/// Helpers of the solvers and filters; not installed.
namespace lamella
{

/// A piece's array of whole numbers as phase ids 0 … 255 that mean the same on every rank.
struct PhaseIds
{
  std::string array;                 ///< its name
  std::span<const std::uint8_t> ids; ///< one a node of the piece; in place where the array is unsigned char
  std::vector<std::uint8_t> own;     ///< holds the ids where they had to be converted
  std::vector<std::int64_t> values;  ///< by id: the value in the array
  std::vector<std::string> names;    ///< by id: the phase's name, or its value as text
  std::vector<std::string> known;    ///< the same, and behind them the named phases that the array does not hold
};

/// Collective. The array that `choice` (vtkAlgorithm::GetInputArrayInformation) names, checked in the order present,
/// at points, one component, whole numbers.
/// @param levels any numbers do then: where they are more than 256, or not whole ones, ids are levels, named by their
/// greys
/// @throws Error on every rank
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhaseIds phaseIds(
  vtkImageData* piece, vtkInformation* choice, const Team& team, const std::optional<GreyBins>& levels = {});

/// Collective. The same of any array of a data set's points or cells: `find` gives it, and may throw; it is not called
/// where the piece is empty.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT PhaseIds phaseIds(vtkDataSet* piece,
  const std::function<vtkDataArray*()>& find, const Team& team, const std::optional<GreyBins>& levels = {});

/// The id of the phase of this name or value; of none, that of the first that is called void, pore, lumen or air.
/// @param what says in the message what the phase is wanted for: "pores"
/// @throws ParameterError for a phase that the image does not know; where none has such a name
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::uint8_t findVoid(
  const PhaseIds& phases, const std::string& wanted, const std::string& what);

/// @throws ParameterError with this message, and a hint that says what was probably meant, where there is no such phase
void requirePhase(const PhaseIds& phases, const std::string& name, const std::string& message);

/// @throws ParameterError for a phase that is to be void and that the image does not know
void requireVoids(const PhaseIds& phases, const std::vector<std::string>& voids);

/// What a table by name or value has of a phase; none where it has nothing.
[[nodiscard]] std::optional<double> numberOf(
  const PhaseIds& phases, const std::map<std::string, double>& table, std::size_t id);

/// Conductivity, or another number that is not negative, by id from a table by name or value.
/// @param nodes by id, how many nodes have it in the whole image; phases without nodes need no conductivity
/// @param quantity what messages call it
/// @throws ParameterError for a missing, negative or non-finite one
[[nodiscard]] std::vector<double> conductivityById(const PhaseIds& phases, const std::map<std::string, double>& table,
  std::span<const std::int64_t> nodes, const std::string& quantity = "conductivity");

} // namespace lamella
