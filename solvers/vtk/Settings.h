#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <map>
#include <string>
#include <vector>

class vtkObject;

/// What the headers of the classes declare of their settings, in tables that the build makes (tools/settings). Not
/// installed.
namespace lamella
{

struct SettingChoice
{
  const char* word; ///< as people write it
  int value;
};

/// A setting that holds numbers.
struct Setting
{
  const char* name; ///< "max iterations": what people call it
  double low;
  double high;
  bool lowOpen; ///< the end does not belong to the range
  bool highOpen;
  std::vector<SettingChoice> choices; ///< what it can be; empty: every number in the range
  std::vector<const char*> parts;     ///< names of its numbers, where it has several
  std::vector<double> (*values)(vtkObject* object);
};

/// Makes the tables of a module known, for as long as the program runs.
class VTKLAMELLASOLVERSVTK_EXPORT SettingTables
{
public:
  using Table = const std::vector<Setting>& (*)();
  explicit SettingTables(const std::map<std::string, Table>& byClass);
};

/// Looks at all numbers that were set. Nothing is silently made to fit: what is out of its range is refused, in the
/// same words whatever the numbers came through.
/// @throws ParameterError with the setting, its value, and what it can be; also where it is not finite
VTKLAMELLASOLVERSVTK_EXPORT void checkSettings(vtkObject* object);

} // namespace lamella
