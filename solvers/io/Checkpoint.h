#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// What a long run keeps on disk to go on from. A checkpoint is an HDF5 file (h5dump and the like read it) behind 512
/// bytes of text, which HDF5 passes over: format and version, and the number of bytes that follow and their SHA-256. So
/// a file that is cut off, damaged or newer is told from a good one before anything of it is interpreted.
namespace lamella::io
{

/// Numbers of any shape, the last index fastest.
struct CheckpointArray
{
  std::vector<std::int64_t> shape;
  std::variant<std::vector<double>, std::vector<std::int64_t>> values; ///< as many as the shape has
  std::string unit;
  std::string description;
  /// In place of the values of a large table of reals: gives all rows of the columns begin ≤ i < end, row by row, as
  /// the file is put together, so that there is no copy beside it. What it looks at must stay as it is until then.
  std::function<void(std::int64_t begin, std::int64_t end, std::span<double> values)> columns{};
};

struct Checkpoint
{
  std::string kind;                      ///< of the run: "quasi-static fracture"
  std::string scene;                     ///< all that the run depends on, in lines "what: value"
  std::string provenance;                ///< toJson(Provenance)
  std::map<std::string, double> numbers; ///< to the last bit
  std::map<std::string, CheckpointArray> arrays;

  /// A number or an array that a good file of this kind has.
  /// @throws InputError when it has not
  [[nodiscard]] double number(const std::string& name) const;
  /// A number that counts: whole, from 0 to 2^53. @throws InputError
  [[nodiscard]] std::int64_t count(const std::string& name) const;
  /// Refuses a number or an array that holds what is not finite. @throws InputError
  void expectFinite(const std::string& name) const;
  [[nodiscard]] const std::vector<double>& reals(const std::string& name) const;
  [[nodiscard]] const std::vector<std::int64_t>& integers(const std::string& name) const;
  /// Asks for all that arrays have not asked for yet.
  void hold();
};

/// Puts a checkpoint in the place of a file: it is written to a file beside it (core/PartFile.h) and brought to the
/// disk, and then that takes the name. Whatever happens the name stands for the old file or the new one, whole.
/// @param checkpoint given away: its arrays go as the file is put together in memory, so that there is one copy of all
/// @throws Error: HDF5 fails; the disk is full, or another reason; the old file is as it was
void replaceFile(const std::filesystem::path& path, Checkpoint checkpoint);

/// A file's. Its arrays are read one after the other: of none is there a second copy.
/// @throws InputError: cannot be read; not a checkpoint, cut off, damaged, newer than this program
[[nodiscard]] Checkpoint readFile(const std::filesystem::path& path);

/// @throws InputError: a checkpoint of another kind or scene; says what differs
void expectScene(const Checkpoint& checkpoint, std::string_view kind, std::string_view scene, std::string_view name);

/// Refuses a place where no checkpoint can be written: no such folder, a folder, a file of another sort.
/// @throws InputError
void checkPlace(const std::filesystem::path& path);

/// Do two names stand for one file, whether it is there or not?
[[nodiscard]] bool sameFile(const std::filesystem::path& a, const std::filesystem::path& b);

} // namespace lamella::io
