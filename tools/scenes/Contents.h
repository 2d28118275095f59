#pragma once

#include <optional>
#include <string>
#include <vector>

/// What commands report and which arrays their data carry, known before anything runs: a misspelt measure must not cost
/// a solve. tests/cli/test_scene_words.py holds it against what the commands do.
namespace lamella::cli
{

/// Keys that a report of a command may have.
struct ReportKeys
{
  std::string name;              ///< "E_*": any that begins so; "*": any
  std::string unit;              ///< empty: none, or the input decides
  std::vector<ReportKeys> below; ///< none: nothing is said of what is below
};

/// Those of a command; nothing of what makes samples: it has run when this is asked.
[[nodiscard]] std::optional<std::vector<ReportKeys>> reportKeys(const std::string& command);

/// The one of that name, or null.
[[nodiscard]] const ReportKeys* keyOf(const std::vector<ReportKeys>& keys, const std::string& name);

/// The unit of the number at a path in a report of a command: "main.tip.x"; empty where it has none.
[[nodiscard]] std::string reportUnit(const std::string& command, const std::string& path);

/// Arrays that data of an output of a command may carry, besides what the sample brings along; empty: nothing is known.
[[nodiscard]] std::vector<std::string> arraysGiven(const std::string& command, const std::string& output);

} // namespace lamella::cli
