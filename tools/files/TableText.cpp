#include "files/TableText.h"

#include "files/CsvField.h"
#include "files/JsonReport.h"

#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkStringArray.h>
#include <vtkTable.h>

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <iterator>

namespace lamella::cli
{

std::string toCsv(vtkTable* table)
{
  std::string text;
  for (vtkIdType i = 0; i < table->GetNumberOfColumns(); ++i)
    text += std::string(i > 0 ? "," : "") + csvField(table->GetColumnName(i));
  text += "\n";
  auto out = std::back_inserter(text);
  for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
  {
    for (vtkIdType i = 0; i < table->GetNumberOfColumns(); ++i)
    {
      text += i > 0 ? "," : "";
      if (auto* const words = vtkStringArray::SafeDownCast(table->GetColumn(i)))
      {
        text += csvField(words->GetValue(row));
        continue;
      }
      auto* const numbers = vtkDataArray::SafeDownCast(table->GetColumn(i));
      const double value = numbers->GetTuple1(row);
      if (numbers->GetDataType() == VTK_DOUBLE)
        fmt::format_to(out, "{}", value);
      else
        fmt::format_to(out, "{}", static_cast<std::int64_t>(value));
    }
    text += '\n';
  }
  return text;
}

nlohmann::ordered_json unitsOf(vtkTable* table, bool metres)
{
  nlohmann::ordered_json units = nlohmann::ordered_json::object();
  for (vtkIdType i = 0; i < table->GetNumberOfColumns(); ++i)
  {
    auto* const column = vtkDataArray::SafeDownCast(table->GetColumn(i));
    if (column == nullptr)
      continue;
    const auto [unit, words, creator] = description(column);
    const bool length = unit == "m" || unit == "m^2" || unit == "m^3";
    units[column->GetName()] = { { "unit",
                                   !length || metres ? unit
                                     : unit == "m^3" ? "voxels"
                                                     : "pixels" },
      { "meaning", words } };
  }
  return units;
}

nlohmann::ordered_json jsonRows(vtkTable* table)
{
  auto rows = nlohmann::ordered_json::array();
  for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
  {
    auto json = nlohmann::ordered_json::object();
    for (vtkIdType i = 0; i < table->GetNumberOfColumns(); ++i)
    {
      const char* const name = table->GetColumnName(i);
      if (auto* const words = vtkStringArray::SafeDownCast(table->GetColumn(i)))
      {
        json[name] = words->GetValue(row);
        continue;
      }
      auto* const numbers = vtkDataArray::SafeDownCast(table->GetColumn(i));
      const double value = numbers->GetTuple1(row);
      if (numbers->GetDataType() == VTK_DOUBLE)
        json[name] = jsonNumber(value);
      else
        json[name] = std::llround(value);
    }
    rows.push_back(std::move(json));
  }
  return rows;
}

} // namespace lamella::cli
