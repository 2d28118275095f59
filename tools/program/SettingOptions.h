#pragma once

#include <CLI/App.hpp>

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

class vtkObject;

namespace lamella
{
struct Setting;
}

namespace lamella::cli
{

class Session;

/// The settings of a VTK class as options of a command: what the header of the class declares, and nothing else.
///
/// A number of all phases may be one of each, PHASE=VALUE, where the class has a setting for that. Numbers may have a
/// unit where the setting has one (0.5um, 7.2GPa), and be per cent where it has none (1%). Behind what is listed by
/// name stands how far it may be off, NAME=VALUE±HALF, where the class has a list for that.
class SettingOptions
{
public:
  /// Declares them, in the groups of the header, but for words that are declared already.
  /// @param leave words of settings that the command has no use for, or sees to itself
  /// @param defaults by word, where this command's are not the class's
  void declare(CLI::App& command, const std::string& className, const std::vector<std::string>& leave = {},
    const std::map<std::string, std::string>& defaults = {});
  /// The same of these words alone, in one group.
  /// @param early what is wrong with a value is told when the words are read, by a scene before its first sample
  void declareSome(CLI::App& command, const std::string& className, const std::vector<std::string>& words,
    const std::string& group, bool early = true);
  /// The same of one kind of what a class makes: settings that do not count with it are left out.
  /// @param choice which of the class's choices is taken; it is no option then
  /// @param defaults by word, where this kind's are not the class's
  void declareKind(CLI::App& command, const std::string& className, const std::pair<std::string, int>& choice,
    const std::map<std::string, std::string>& defaults);
  /// Lets a setting be called as in the version before, too; the next one does not know the word any more.
  /// @param on of a switch that took a word: the word that switches it on
  /// @param part of a vector: which of its numbers it was; below 0: all of them
  void formerly(
    CLI::App& command, const std::string& old, const std::string& word, const std::string& on = "", int part = -1);
  /// Hands what was given to an object of the class.
  /// @throws ParameterError where it is no number, no choice, out of its range, or does not count with what else was
  /// given: in the words of every front end
  void give(vtkObject* object) const;
  /// Whether the command line has it.
  [[nodiscard]] bool given(const std::string& word) const;
  /// The first of these that the command line has, as it is written there; empty where it has none.
  [[nodiscard]] std::string firstGiven(const std::vector<std::string>& words) const;
  /// As it was written, last; empty where it was not.
  [[nodiscard]] std::string text(const std::string& word) const;
  /// How many things are listed.
  [[nodiscard]] std::size_t count(const std::string& word) const;
  /// Words that were given and that another class does not know.
  [[nodiscard]] std::vector<std::string> idle(const std::string& className) const;
  /// Warns of words of the version before that were used: what they are now.
  void tellFormer(Session& session) const;
  /// Refuses what is told of phases, or pairs of them, that the sample does not have: slips, which the class would
  /// ignore. @throws ParameterError
  void checkNames(const std::vector<std::string>& phases) const;

private:
  void standards(CLI::App& command, const std::map<std::string, std::string>& defaults);
  struct Option
  {
    const Setting* setting;
    std::vector<std::string> texts;
    bool on = false;
    bool off = false;
    std::string standard;                 ///< of this command; empty: the class's own
    const Setting* uncertainty = nullptr; ///< the list of how far its numbers may be off
  };
  struct Former
  {
    std::string old;
    Option* option;
    std::string on;
    std::vector<std::string> texts;
    bool used = false;
    int part = -1;
  };
  void add(CLI::App& command, const std::vector<Setting>& settings, const Setting& setting, std::string group = "",
    bool early = true, const std::vector<std::string>& leave = {});

  std::map<std::string, std::unique_ptr<Option>> options_;
  std::pair<std::string, int> kind_; ///< word of the choice that a command has taken; empty: none
  std::vector<std::unique_ptr<Former>> former_;
};

} // namespace lamella::cli
