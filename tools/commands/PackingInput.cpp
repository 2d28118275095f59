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

namespace lamella::cli
{

void addTableOptions(CLI::App& command, SettingOptions& table)
{
  table.declareSome(command, "vtkPackingReader", { "unit", "box" }, "Table");
}

bool isParticleFile(const std::string& path)
{
  return endingOf(path) == ".vtp";
}

Grains readPacking(Session& session, const std::string& path, const SettingOptions& table)
{
  if (const std::string given = table.firstGiven({ "unit", "box" }); isParticleFile(path) && !given.empty())
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
  table.give(reader);
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
