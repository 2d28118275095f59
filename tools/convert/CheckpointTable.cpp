#include "convert/CheckpointTable.h"

#include "session/Text.h"

#include "NewArray.h"
#include "core/Error.h"
#include "io/Checkpoint.h"
#include "vtkLatticeConversion.h"

#include <vtkDoubleArray.h>
#include <vtkLongLongArray.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <numeric>
#include <type_traits>

namespace lamella::cli
{

bool isCheckpoint(const std::string& path)
{
  constexpr std::string_view begin = "Lamella checkpoint\n";
  std::ifstream file(path, std::ios::binary);
  std::string text(begin.size(), '\0');
  return file && file.read(text.data(), static_cast<std::streamsize>(text.size())) && text == begin;
}

vtkSmartPointer<vtkTable> checkpointTable(const std::string& path, std::span<const std::string> arrays)
{
  const io::Checkpoint checkpoint = io::readFile(path);
  std::vector<std::string> names;
  for (const auto& [name, array] : checkpoint.arrays)
    names.push_back(name);
  if (arrays.size() != 1)
  {
    throw ParameterError(
      fmt::format("'{}' is the checkpoint of a run ({}) and holds {}", path, checkpoint.kind, quotedList(names, "and")),
      "choose one with --array NAME");
  }
  const auto found = checkpoint.arrays.find(arrays.front());
  if (found == checkpoint.arrays.end())
  {
    throw ParameterError(fmt::format("--array '{}': the checkpoint has none of that name", arrays.front()),
      suggestion(arrays.front(), names, "it holds " + quotedList(names, "and")));
  }
  const io::CheckpointArray& array = found->second;
  const std::size_t axes = array.shape.size();
  // All axes but the last one count places; a single one counts them too.
  const auto rows = static_cast<std::size_t>(
    std::accumulate(array.shape.begin(), array.shape.begin() + static_cast<std::ptrdiff_t>(axes > 1 ? axes - 1 : axes),
      std::int64_t{ 1 }, std::multiplies<>()));
  auto table = vtkSmartPointer<vtkTable>::New();
  std::visit(
    [&](const auto& values)
    {
      using Value = typename std::decay_t<decltype(values)>::value_type;
      using Column = std::conditional_t<std::is_same_v<Value, double>, vtkDoubleArray, vtkLongLongArray>;
      const std::size_t columns = rows == 0 ? 1 : values.size() / rows;
      for (std::size_t k = 0; k < columns; ++k)
      {
        const std::string name = columns == 1 ? arrays.front() : fmt::format("{}:{}", arrays.front(), k);
        const auto column = newArray<Column>(name.c_str(), 1, rows);
        for (std::size_t row = 0; row < rows; ++row)
          column->SetValue(static_cast<vtkIdType>(row), values[row * columns + k]);
        describe(column, array.unit, array.description, "lamella");
        table->AddColumn(column);
      }
    },
    array.values);
  setProvenance(table, checkpoint.provenance);
  return table;
}

} // namespace lamella::cli
