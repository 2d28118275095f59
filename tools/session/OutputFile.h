#pragma once

#include "core/Error.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lamella::cli
{

/// A file that cannot be written: it exists already, its folder cannot be written to, the disk is full.
class OutputError : public Error
{
  using Error::Error;
};

/// A file that appears whole or not at all.
///
/// Made before anything is computed, it finds out at once whether the result can be stored: it refuses a file that
/// exists (unless it may be replaced) and creates a temporary file in the same folder. What is written goes there;
/// commit() brings it to the disk and renames it, the only moment at which the name appears. Without commit() the
/// temporary file goes away, also when a signal ends the program (core/PartFile.h). The file that it replaces may be
/// the input: that was read before, and stays as it was unless the result is whole.
class OutputFile
{
public:
  /// @throws OutputError; ParameterError where another result of this program is about to get the same name: one of
  /// them would be lost
  OutputFile(const std::filesystem::path& path, bool overwrite);
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&& other) noexcept;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Where to write: in the same folder, with the same ending.
  [[nodiscard]] const std::filesystem::path& temporary() const noexcept { return temporary_; }

  /// "-" with the ending of what is written, such as "-.vti": standard output, in a program that allows it. What would
  /// lie beside it ("-.csv.json") is not written. It is made as a file, in the folder for temporary ones, and sent out
  /// by commit(), whole.
  [[nodiscard]] static bool isStandardOutput(const std::filesystem::path& path);
  static void allowStandardOutput() noexcept;
  /// Whether some result goes there.
  [[nodiscard]] static bool usesStandardOutput() noexcept;
  /// What TMPDIR names, or /tmp.
  [[nodiscard]] static std::filesystem::path temporaryFolder();

  /// Whether it stands for data of a scene (Workspace.h): then nothing touches the disk.
  [[nodiscard]] bool inMemory() const noexcept { return inMemory_; }

  /// Refuses when the disk has less room than the result will take.
  /// @throws OutputError
  void needs(std::uint64_t bytes) const;

  /// Writes all of the file. @throws OutputError when the disk is full or fails
  void write(std::string_view bytes) const;

  /// Says that writing failed: the temporary file is removed and the error names what stood in the way.
  [[noreturn]] void failed(const std::string& why) const;

  /// The same after a writer that does not tell why it failed: finds out by writing to the disk itself.
  [[noreturn]] void failed() const;
  /// What somebody else said about the temporary file, said about the file itself: an OutputError. Other errors, which
  /// do not name the temporary file, go on as they are.
  void rethrow(const Error& error) const;

  /// @throws OutputError; Cancelled after removeAll()
  void commit();

  /// Removes every temporary file that is open, and no OutputFile can be made or committed after it (Cancelled). Safe
  /// to call from a signal handler, where it must happen: mpirun kills its processes a second after it told them to
  /// end, and a solver may take longer than that to notice.
  static void removeAll() noexcept;

private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  bool overwrite_ = false;
  bool inMemory_ = false;
};

/// The path with a word before its ending: out.vti → out_x.vti; standard output stays what it is, so that the second of
/// several results is refused.
[[nodiscard]] std::filesystem::path withSuffix(const std::filesystem::path& path, const std::string& suffix);

} // namespace lamella::cli
