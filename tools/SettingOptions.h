#pragma once

#include <CLI/App.hpp>

#include <map>
#include <memory>
#include <string>
#include <vector>

class vtkObject;

namespace lamella
{
struct Setting;
}

namespace lamella::cli
{

/// The settings of a VTK class as options of a command: what the header of the class declares, and nothing else.
///
/// Numbers may have a unit where the setting has one (0.5um, 7.2GPa), and be per cent where it has none (1%).
class SettingOptions
{
public:
  /// Declares them, in the groups of the header.
  /// @param leave words of settings that the command has no use for, or sees to itself
  void declare(CLI::App& command, const std::string& className, const std::vector<std::string>& leave = {});
  /// Hands what was given to an object of the class.
  /// @throws ParameterError where it is no number, no choice, or out of its range: in the words of every front end
  void give(vtkObject* object) const;
  /// Whether the command line has it.
  [[nodiscard]] bool given(const std::string& word) const;

private:
  struct Option
  {
    const Setting* setting;
    std::vector<std::string> texts;
    bool on = false;
    bool off = false;
  };
  std::map<std::string, std::unique_ptr<Option>> options_;
};

} // namespace lamella::cli
