#include "convert/Types.h"

#include "core/Error.h"
#include "vtkLatticeConversion.h"

#include <vtkArrayDispatch.h>
#include <vtkDataArray.h>
#include <vtkDataArrayRange.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace lamella::cli
{

namespace
{

const std::vector<std::pair<int, std::string>>& types()
{
  static const std::vector<std::pair<int, std::string>> list{ { VTK_UNSIGNED_CHAR, "u8" }, { VTK_SIGNED_CHAR, "i8" },
    { VTK_UNSIGNED_SHORT, "u16" }, { VTK_SHORT, "i16" }, { VTK_UNSIGNED_INT, "u32" }, { VTK_INT, "i32" },
    { VTK_UNSIGNED_LONG, "u64" }, { VTK_UNSIGNED_LONG_LONG, "u64" }, { VTK_LONG, "i64" }, { VTK_LONG_LONG, "i64" },
    { VTK_FLOAT, "f32" }, { VTK_DOUBLE, "f64" }, { VTK_ID_TYPE, "id" }, { VTK_CHAR, "char" }, { VTK_BIT, "bit" },
    { VTK_STRING, "text" } };
  return list;
}

/// `char` is no number for the standard library.
template <typename Value>
using Number = std::conditional_t<std::is_same_v<Value, char>, signed char, Value>;

/// Does a value survive in another type? NaN does among real numbers.
template <typename To, typename From>
bool fits(From value)
{
  if constexpr (std::is_integral_v<From> && std::is_integral_v<To>)
  {
    return std::in_range<Number<To>>(static_cast<Number<From>>(value));
  }
  else if constexpr (std::is_integral_v<To>)
  {
    // 2^63 and 2^64 are real numbers and no whole ones of these types.
    return value >= static_cast<From>(std::numeric_limits<To>::min()) &&
      value < std::ldexp(From{ 1 }, std::numeric_limits<To>::digits) && value == std::floor(value);
  }
  else if constexpr (std::is_integral_v<From>)
  {
    return static_cast<long double>(static_cast<To>(value)) == static_cast<long double>(value);
  }
  else
  {
    return std::isnan(value) || static_cast<From>(static_cast<To>(value)) == value;
  }
}

/// The nearest value that the other type has.
template <typename To, typename From>
To nearest(From value)
{
  if constexpr (std::is_integral_v<To>)
  {
    const auto number = static_cast<long double>(value);
    constexpr auto low = static_cast<long double>(std::numeric_limits<To>::min());
    constexpr auto high = static_cast<long double>(std::numeric_limits<To>::max());
    return std::isnan(number) ? To{ 0 } : static_cast<To>(std::clamp(std::round(number), low, high));
  }
  else
  {
    return static_cast<To>(value);
  }
}

struct Cast
{
  bool exact;

  template <typename Source, typename Target>
  void operator()(Source* source, Target* target) const
  {
    using From = vtk::GetAPIType<Source>;
    using To = vtk::GetAPIType<Target>;
    const auto from = vtk::DataArrayValueRange(source);
    auto to = vtk::DataArrayValueRange(target);
    for (vtkIdType i = 0; i < from.size(); ++i)
    {
      const From value = from[i];
      if (fits<To, From>(value))
      {
        to[i] = static_cast<To>(value);
        continue;
      }
      if (exact)
      {
        throw InputError(
          fmt::format("'{}' holds {}, which is no {}", source->GetName() == nullptr ? "" : source->GetName(),
            static_cast<Number<From>>(value), typeName(target->GetDataType())),
          "keep the type, map values with --range LOW,HIGH, or take the nearest values with --lossy");
      }
      to[i] = nearest<To, From>(value);
    }
  }
};

struct Spread
{
  double low;
  double high;

  template <typename Source, typename Target>
  void operator()(Source* source, Target* target) const
  {
    using To = vtk::GetAPIType<Target>;
    const auto from = vtk::DataArrayValueRange(source);
    auto to = vtk::DataArrayValueRange(target);
    const double top = static_cast<double>(std::numeric_limits<To>::max());
    for (vtkIdType i = 0; i < from.size(); ++i)
    {
      const double share = (static_cast<double>(from[i]) - low) / (high - low);
      to[i] = std::isnan(share) ? To{ 0 } : static_cast<To>(std::lround(std::clamp(share, 0.0, 1.0) * top));
    }
  }
};

using Small = vtkTypeList::Create<unsigned char, unsigned short>;

vtkSmartPointer<vtkDataArray> likeThis(vtkDataArray* array, int type)
{
  vtkSmartPointer<vtkDataArray> result;
  result.TakeReference(vtkDataArray::CreateDataArray(type));
  result->SetName(array->GetName());
  result->SetNumberOfComponents(array->GetNumberOfComponents());
  result->SetNumberOfTuples(array->GetNumberOfTuples());
  if (const auto [unit, text, creator] = description(array); !unit.empty() || !text.empty() || !creator.empty())
    describe(result, unit, text, creator);
  return result;
}

} // namespace

std::string typeName(int vtkType)
{
  const auto found = std::ranges::find(types(), vtkType, &std::pair<int, std::string>::first);
  return found == types().end() ? "" : found->second;
}

std::optional<int> typeNamed(const std::string& name)
{
  const auto found = std::ranges::find(types(), name, &std::pair<int, std::string>::second);
  return found == types().end() ? std::nullopt : std::optional(found->first);
}

const std::vector<std::string>& numberTypes()
{
  static const std::vector<std::string> names{ "u8", "i8", "u16", "i16", "u32", "i32", "u64", "i64", "f32", "f64" };
  return names;
}

bool isReal(int vtkType)
{
  return vtkType == VTK_FLOAT || vtkType == VTK_DOUBLE;
}

vtkSmartPointer<vtkDataArray> cast(vtkDataArray* array, int type, bool exact)
{
  if (array->GetDataType() == type)
    return array;
  auto result = likeThis(array, type);
  using Dispatch = vtkArrayDispatch::Dispatch2;
  const Cast worker{ exact };
  if (!Dispatch::Execute(array, result.Get(), worker))
    throw InputError(fmt::format("'{}' is of a type that cannot be changed", array->GetName()), "leave --type out");
  return result;
}

vtkSmartPointer<vtkDataArray> spread(vtkDataArray* array, int type, double low, double high)
{
  auto result = likeThis(array, type);
  using Dispatch = vtkArrayDispatch::Dispatch2ByValueType<vtkArrayDispatch::AllTypes, Small>;
  const Spread worker{ low, high };
  if (!Dispatch::Execute(array, result.Get(), worker))
    throw ParameterError("--range needs a type of u8 or u16", "add --type u8 or --type u16");
  return result;
}

} // namespace lamella::cli
