#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro

#include <map>
#include <string>
#include <variant>
#include <vector>

class vtkObject;

/// The settings of classes as tables, which the build makes of their headers (tools/settings). Not installed.
namespace lamella
{

struct SettingChoice
{
  const char* word; ///< as people write it
  int value;
};

/// What a call of a setter takes.
using SettingValue = std::variant<double, std::string>;

struct Setting
{
  enum class Kind
  {
    Switch,
    Whole,
    Number,
    Choice,
    Text,
    File,
    Vector,
    Axes, ///< three switches
    List  ///< the setter adds
  };
  enum class Type
  {
    Switch,
    Whole,
    Number,
    Text
  };

  const char* word;    ///< "max-iterations": what it is called in a command
  const char* off;     ///< of a switch that is on by itself: what switches it off in a command
  const char* offText; ///< and what that does
  Kind kind;
  std::vector<Type> types; ///< of what one call of the setter takes
  double low;
  double high;
  bool lowOpen; ///< the end does not belong to the range
  bool highOpen;
  double unset;                       ///< out of the range, and stands for a number that is not given; NaN: none does
  double rest;                        ///< of a vector: its last number where it is left out; NaN: it may not be
  std::vector<std::size_t> flat;      ///< of a vector: those of its numbers that are 0 where all of them are left out
  std::vector<SettingChoice> choices; ///< what it can be; empty: every number in the range
  std::vector<SettingChoice> names;   ///< words for some of its numbers
  bool colour;                        ///< its last three numbers are one, and written as such
  std::vector<const char*> parts;     ///< names of what it takes, where that is several
  const char* unit;
  const char* group;
  const char* text;
  const char* standard;        ///< the default, as it is written in a command
  const char* with;            ///< word of another setting that decides whether this one counts; empty: it does
  std::vector<int> withValues; ///< those of it with which it does
  const char* withText;        ///< how people say so: "load biaxial"
  const char* uncertaintyOf;   ///< word of the list whose numbers may be off by this one's; empty: of none
  /// Its numbers; null where it holds none.
  std::vector<double> (*values)(vtkObject* object);
  void (*set)(vtkObject* object, const std::vector<SettingValue>& values);
};

/// Makes the tables of a module known, for as long as the program runs.
class VTKLAMELLASOLVERSVTK_EXPORT SettingTables
{
public:
  using Table = const std::vector<Setting>& (*)();
  explicit SettingTables(const std::map<std::string, Table>& byClass);
};

/// Those of a class and of its bases; empty for a class that is not known.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT const std::vector<Setting>& settingsOf(const std::string& className);

/// The unit of one of its parts: "Young's modulus [Pa]".
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::string unitOf(const Setting& setting, std::size_t part);

/// The unit of the last part of all settings of that word; empty where none has one, or two differ.
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::string unitOfWord(const std::string& word);

/// What people call it: "max iterations".
[[nodiscard]] VTKLAMELLASOLVERSVTK_EXPORT std::string nameOf(const Setting& setting);

/// Refuses numbers of a setting that were given. @throws ParameterError
VTKLAMELLASOLVERSVTK_EXPORT void checkSetting(const Setting& setting, const std::vector<double>& values);

/// Refuses a whole number that no setting can hold. @throws ParameterError
[[noreturn]] VTKLAMELLASOLVERSVTK_EXPORT void refuseSize(double value);

/// Refuses a setting that was given and does not count. @throws ParameterError
[[noreturn]] VTKLAMELLASOLVERSVTK_EXPORT void refuseIdle(const Setting& setting);

/// Refuses a word that is none of its choices, in the words of every front end. @throws ParameterError
[[noreturn]] VTKLAMELLASOLVERSVTK_EXPORT void refuseWord(const Setting& setting, const std::string& word);

} // namespace lamella
