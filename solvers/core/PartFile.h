#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <span>

namespace lamella
{

/// Where a file is to be: "." of a name alone.
[[nodiscard]] inline std::filesystem::path folderOf(const std::filesystem::path& path)
{
  return path.parent_path().empty() ? std::filesystem::path(".") : path.parent_path();
}

/// A file that is being written beside the place that it is for, under a name that nobody else can have made or can
/// foresee to put a link there: it is made anew (O_EXCL) and no link is followed (O_NOFOLLOW). It goes away with this
/// object unless it took its place; when a signal ends the program (removeAll()); and, when the program is killed, as
/// soon as the next one makes a file in that folder: the name tells the process and the machine that it belongs to.
class PartFile
{
public:
  enum class OnSignal
  {
    goes,
    stays, ///< a checkpoint, which is written when a signal came
  };

  PartFile() = default;
  /// In the folder of `place`, with its ending. Look at error().
  explicit PartFile(const std::filesystem::path& place, OnSignal onSignal = OnSignal::goes);
  ~PartFile();
  PartFile(PartFile&& other) noexcept;
  PartFile& operator=(PartFile&& other) noexcept;
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// Why it could not be made: a number as in errno; 0 when it was. ECANCELED after removeAll().
  [[nodiscard]] int error() const noexcept { return error_; }
  /// Empty once it took its place.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  /// Writes all of the file. @returns 0, or the number of what stood in the way, as in errno
  [[nodiscard]] int write(std::span<const std::byte> bytes) const { return write({ bytes }); }
  /// The same of parts that follow each other.
  [[nodiscard]] int write(std::initializer_list<std::span<const std::byte>> parts) const;

  /// What has the name already.
  enum class Existing
  {
    goes,
    stays ///< also one that somebody made a moment ago: EEXIST
  };
  /// Brings the file to the disk, then gives it the name, in one step that cannot be seen half done, and brings that to
  /// the disk. @returns 0, or the number of what stood in the way, as in errno
  [[nodiscard]] int take(const std::filesystem::path& place, Existing existing = Existing::goes);
  /// Somebody else gave it its name.
  void release() noexcept;

  /// Removes every such file that goes on a signal; none can be made after it. Safe to call from a signal handler.
  static void removeAll() noexcept;
  [[nodiscard]] static bool removedAll() noexcept;

  /// While one lives removeAll() waits for its end: several files take their places together, or none does.
  class Hold
  {
  public:
    Hold() noexcept;
    ~Hold();
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;
  };

  /// Whether a name is one of these; of any process.
  [[nodiscard]] static bool isPart(const std::filesystem::path& path);

private:
  struct Name;
  std::filesystem::path path_;
  Name* name_ = nullptr;
  int error_ = 0;
};

} // namespace lamella
