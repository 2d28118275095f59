#pragma once

#include "files/JsonReport.h"
#include "reports/Plan.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// A folder of results, as commands and scenes leave it.
namespace lamella::reports
{

inline constexpr std::size_t shownRows = 50;   ///< of a table that nobody ordered
inline constexpr std::size_t fewestPoints = 8; ///< of a table that is drawn as curves
inline constexpr std::size_t drawnColumns = 4; ///< of such a table, behind the first

/// What is missing or damaged, one line each.
using Problems = std::vector<std::string>;

/// The JSON object that a command printed, or that stands beside its results.
struct JsonFile
{
  std::string name;
  cli::Json json;
};

struct Found
{
  bool scene = false; ///< lamella run wrote it
  std::vector<std::string> pictures;
  std::vector<std::string> tables;
  std::vector<std::pair<std::string, std::string>> scenes; ///< name and text of .toml files
  std::vector<JsonFile> reports;
  std::vector<JsonFile> besides;                              ///< NAME.csv.json and the like: provenance, units
  std::vector<std::pair<std::string, std::uintmax_t>> others; ///< names and bytes
  std::vector<std::string> notes;                             ///< what was left out, one line each
};

/// The file, when it lies in the folder, or what it is a link to does: a page must not show what somebody who made a
/// link there could read and whoever reads the page could not. @throws InputError
[[nodiscard]] std::filesystem::path requireWithin(
  const std::filesystem::path& folder, const std::filesystem::path& file);

/// Looks through the folder and three levels below it, in the order of the names. Names that begin with a dot are left
/// out, and so are `own`, the page itself, and links out of the folder.
/// @throws InputError when it is no folder, cannot be read, or is empty
[[nodiscard]] Found look(const std::filesystem::path& folder, const std::filesystem::path& own, Problems& problems);

/// A page of all of it where nobody ordered it: a section for each folder within, tables whose first column rises drawn
/// as curves.
/// @param path the folder, to look into its tables
[[nodiscard]] Plan planOf(const std::filesystem::path& path, const Found& found);

} // namespace lamella::reports
