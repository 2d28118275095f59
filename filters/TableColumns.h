#pragma once

#include "vtkLatticeConversion.h"

#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkTable.h"

#include <cstddef>
#include <string>

/// Helper of the filters that make tables; not installed.
namespace lamella
{

/// Adds columns of a fixed number of rows, each row's value from a rule.
struct Columns
{
  vtkTable* table;
  std::size_t rows;
  const char* creator; ///< class that makes the table

  template <typename Array, typename Value>
  void add(const std::string& name, const char* unit, const char* description, const Value& value) const
  {
    vtkNew<Array> column;
    column->SetName(name.c_str());
    column->SetNumberOfTuples(static_cast<vtkIdType>(this->rows));
    for (std::size_t row = 0; row < this->rows; ++row)
      column->SetValue(static_cast<vtkIdType>(row), value(row));
    describe(column, unit, description, this->creator);
    this->table->AddColumn(column);
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
};

} // namespace lamella
