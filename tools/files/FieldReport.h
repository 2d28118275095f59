#pragma once

#include "files/JsonReport.h"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

class vtkDataObject;

/// What a result tells in its field data, as keys of a report and as words.
namespace lamella::cli
{

struct Fields
{
  vtkDataObject* data;
  int dimension = 3;

  double operator()(const std::string& name, std::size_t i = 0) const;
  [[nodiscard]] std::int64_t whole(const std::string& name, std::size_t i = 0) const;
  [[nodiscard]] std::string text(const std::string& name) const;
  [[nodiscard]] std::vector<double> numbers(const std::string& name) const;
  /// As many as there are axes.
  [[nodiscard]] Json vector(const std::string& name) const;
  /// A tensor of three by three, by rows, cut to the axes that there are; empty where there is none.
  [[nodiscard]] Json matrix(const std::string& name) const;
};

/// A key of a report, and the field that it shows.
struct Key
{
  enum class Kind
  {
    Number, ///< null where it is not known
    Whole,
    Text,
    Texts,
    Flag,
    Vector, ///< as many numbers as there are axes
    Matrix
  };
  const char* name;
  Kind kind = Kind::Number;
  const char* field = nullptr; ///< where it is called otherwise
  std::size_t at = 0;          ///< of a field of several numbers
};

/// @param prefix of the names of all fields
void addKeys(Json& json, const Fields& f, std::initializer_list<Key> keys, const std::string& prefix = "");
/// An object of them alone.
[[nodiscard]] Json keysOf(const Fields& f, std::initializer_list<Key> keys, const std::string& prefix = "");

/// A number of a report for people; "-" where it is null. @param form of fmt
[[nodiscard]] std::string shown(const Json& value, const char* form, double scale = 1);
/// The same of a number of things.
[[nodiscard]] std::string counted(const Json& value);
/// Numbers in rows of so many.
[[nodiscard]] Json rowsOf(const std::vector<double>& numbers, std::size_t columns);
/// The names of the axes whose flag is set.
[[nodiscard]] std::vector<std::string> axesOf(const std::vector<double>& flags);
/// The names and shares of phases.
[[nodiscard]] Json phasesJson(const std::vector<std::string>& names, const std::vector<double>& fractions);

} // namespace lamella::cli
