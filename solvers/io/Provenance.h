#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Where a result comes from: written into every output as one JSON object, shown by `lamella info`.
///
/// Keys: program, version, commit, command (the command line, or what stands for it), date (ISO 8601, UTC), seed (only
/// where numbers were drawn), parameters (an object, only where there are any), inputs (a list of name, bytes, sha256;
/// of a file above wholeHashLimit sha256_of_ends instead).
namespace lamella::io
{

/// A file that a result was made from.
struct InputFile
{
  std::string name;        ///< as the user gave it
  std::uint64_t bytes = 0; ///< size; of a folder: of all files in it
  std::string sha256; ///< 64 hexadecimal digits, what sha256sum prints; of a folder: of its files one after the other
  bool ends = false;  ///< only of the first and the last `hashedEnd` bytes, one after the other
};

/// Larger files, of which a window may be all that is read, are told apart by their size and their two ends.
inline constexpr std::uint64_t wholeHashLimit = std::uint64_t{ 4 } << 30;
inline constexpr std::uint64_t hashedEnd = std::uint64_t{ 16 } << 20;

struct Provenance
{
  std::string program = "lamella";
  std::string version;
  std::string commit;
  std::string command;
  std::string date;
  std::optional<std::uint64_t> seed;
  std::string parameters; ///< text of a JSON object, or empty
  std::vector<InputFile> inputs;
};

/// A record with version, commit and date filled in.
[[nodiscard]] Provenance makeProvenance(std::string command);

/// Size and hash of a file, or of all regular files of a folder in the order of their names.
/// @throws InputError when it cannot be read
[[nodiscard]] InputFile describeInput(const std::filesystem::path& path);

/// One JSON object; on one line, or indented by `indent` spaces.
[[nodiscard]] std::string toJson(const Provenance& provenance, int indent = -1);

/// Reads what toJson() wrote. Keys that are missing stay empty, others are ignored.
/// @throws InputError for text that is not a JSON object
[[nodiscard]] Provenance provenanceFromJson(std::string_view text);

/// Now in UTC as 2026-11-21T10:03:00Z; the time in the environment variable SOURCE_DATE_EPOCH where that is set, so
/// that a build or a data set can be made again byte for byte.
[[nodiscard]] std::string timestamp();

/// A command line as one string that a POSIX shell reads back as the same words.
[[nodiscard]] std::string quoteCommand(std::span<const std::string> words);

/// SHA-256 (FIPS 180-4) of bytes that arrive in pieces, by libcrypto.
class Sha256
{
public:
  /// @throws Error where libcrypto may not or cannot do it
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  void update(std::span<const std::byte> bytes);
  /// The hash of all bytes so far as 64 hexadecimal digits; ends the stream.
  [[nodiscard]] std::string finish();

private:
  void* context_; ///< EVP_MD_CTX
};

} // namespace lamella::io
