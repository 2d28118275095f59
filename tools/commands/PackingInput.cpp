#include "commands/PackingInput.h"

#include "commands/FilterRun.h"
#include "files/GridFile.h"
#include "program/Commands.h"
#include "session/Text.h"

#include "PackingData.h"
#include "core/Error.h"
#include "core/Lower.h"
#include "vtkPackingReader.h"

#include <vtkNew.h>
#include <vtkPolyData.h>

#include <fmt/format.h>

#include <algorithm>

namespace lamella::cli
{

void addTableOptions(CLI::App& command, TableOptions& options)
{
  options.declared = { addOption(command, "Table", "--unit", options.unit, "Unit of length in a table, as 1mm; metres",
                         "LENGTH"),
    addOption(command, "Table", "--box", options.box,
      "Edges of a table's box, as 20mm,40mm; when not given, that of the grains", "X,Y[,Z]") };
}

bool isParticleFile(const std::string& path)
{
  return endingOf(path) == ".vtp";
}

std::string firstGiven(const std::vector<CLI::Option*>& options)
{
  const auto found =
    std::find_if(options.begin(), options.end(), [](const CLI::Option* option) { return option->count() > 0; });
  return found == options.end() ? "" : (*found)->get_name();
}

Grains readPacking(Session& session, const std::string& path, const TableOptions& options)
{
  if (const std::string given = firstGiven(options.declared); isParticleFile(path) && !given.empty())
    throw ParameterError(given + " is for tables, and '" + path + "' knows its lengths", "leave it out");
  if (isParticleFile(path))
  {
    const auto data = readGrid(path);
    auto* const particles = vtkPolyData::SafeDownCast(data);
    if (particles == nullptr)
      throw InputError("'" + path + "' holds no particles", "give what lamella packing -o FILE.vtp wrote");
    try
    {
      (void)packingFrom(particles);
    }
    catch (const InputError& error)
    {
      throw InputError("'" + path + "': " + error.what(), error.hint());
    }
    return { particles, vtkSmartPointer<vtkPolyData>::New() };
  }
  vtkNew<vtkPackingReader> reader;
  reader->SetFileName(path.c_str());
  if (!options.unit.empty())
    reader->SetLengthUnit(lengthInMetres("--unit", options.unit));
  if (!options.box.empty())
  {
    const std::vector<std::string> parts = split(options.box, ',');
    if (parts.size() < 2 || parts.size() > 3)
      throw ParameterError("--box '" + options.box + "' has not 2 or 3 edges", "write it as --box 20mm,40mm");
    const auto edge = [&](std::size_t i) { return lengthInMetres("--box", parts[i]); };
    reader->SetBoxSize(edge(0), edge(1), parts.size() == 3 ? edge(2) : 0);
  }
  runFilter(session, reader, "grains");
  return { reader->GetOutput(), reader->GetContacts() };
}

std::string boxText(const std::array<double, 3>& size)
{
  const double edge = size[0];
  const double scale = edge >= 1 ? 1 : edge >= 1e-3 ? 1e3 : 1e6;
  const char* const unit = edge >= 1 ? "m" : edge >= 1e-3 ? "mm" : "µm";
  std::string text = fmt::format("{:.5g} {}", edge * scale, unit);
  for (std::size_t axis = 1; axis < (size[2] > 0 ? 3U : 2U); ++axis)
    text += fmt::format(" × {:.5g} {}", size[axis] * scale, unit);
  return text;
}

} // namespace lamella::cli
