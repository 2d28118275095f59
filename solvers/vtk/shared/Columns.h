#pragma once

#include "NewArray.h"
#include "vtkLatticeConversion.h"

#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkStringArray.h"

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <type_traits>

/// Helper of all that make tables; not installed.
namespace lamella
{

/// Adds arrays with a value for each of some rows: a member of the row, or what a rule makes of it or of its number.
template <typename Row>
struct Columns
{
  vtkFieldData* data;
  std::span<const Row> rows;
  std::string creator; ///< class that makes them

  template <typename Array, typename Value>
  void add(const std::string& name, const char* unit, const char* description, const Value& value) const
  {
    const auto column = newArray<Array>(name.c_str(), 1, this->rows.size());
    using Number = std::remove_reference_t<decltype(*column->GetPointer(0))>;
    for (std::size_t i = 0; i < this->rows.size(); ++i)
      if constexpr (std::is_invocable_v<const Value&, std::size_t>)
        column->SetValue(static_cast<vtkIdType>(i), static_cast<Number>(value(i)));
      else
        column->SetValue(static_cast<vtkIdType>(i), static_cast<Number>(std::invoke(value, this->rows[i])));
    if constexpr (std::is_base_of_v<vtkDataArray, Array>)
      describe(column, unit, description, this->creator);
    this->data->AddArray(column);
  }
  template <typename Value>
  void numbers(const std::string& name, const char* unit, const char* description, const Value& value) const
  {
    this->add<vtkDoubleArray>(name, unit, description, value);
  }
  template <typename Value>
  void counts(const std::string& name, const char* description, const Value& value) const
  {
    this->add<vtkIdTypeArray>(name, "1", description, value);
  }
  template <typename Value>
  void words(const std::string& name, const Value& value) const
  {
    this->add<vtkStringArray>(name, "", "", value);
  }
};
template <typename Rows>
Columns(vtkFieldData*, const Rows&, const char*) -> Columns<typename Rows::value_type>;
template <typename Rows>
Columns(vtkFieldData*, const Rows&, const std::string&) -> Columns<typename Rows::value_type>;

} // namespace lamella
