#pragma once

#include "lattice/GreyLevels.h"
#include "lattice/Phases.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamella
{

/// One end of a range of grey values: a number, or a level that is found in the picture.
struct GreyBound
{
  int grey = 0;
  int level = 0;   ///< 0: `grey`; 1: the first level found; 2: the second
  int classes = 0; ///< of those levels: 2 (`otsu`) or 3 (`otsu1`, `otsu2`)
};

/// Grey values from `first` to `last`, both included. A level lies between two greys: a range that ends at it ends
/// below it, and one that begins at it begins above.
struct GreyRange
{
  GreyBound first;
  GreyBound last{ 65535 };
  std::string text;     ///< as it was written
  bool single = false;  ///< one grey value, written as such
  bool openEnd = false; ///< "90..": as far as greys go
};

/// Reads a grey value or a range of them: `7`, `0..89`, `90..`, `..89`, and with levels for numbers: `..otsu`, `otsu..`
/// (two classes), `..otsu1`, `otsu1..otsu2`, `otsu2..` (three). The one reader of them for commands, Python, ParaView
/// and scenes.
/// @throws ParameterError for text that is none, for greys outside 0 … 65535 and for ranges that run backwards
[[nodiscard]] GreyRange parseGreyRange(std::string_view text);

/// What is known of the values that ranges are applied to.
struct GreyScale
{
  int bits = 16;                    ///< 8: a number beyond 255 is an error
  int scale = 1;                    ///< values are so many times the greys that ranges speak of
  std::optional<GreyLevels> levels; ///< in values; else found in them
};

/// Which grey values are which phase.
class GreyRanges
{
public:
  /// Names a grey value or a range, as parseGreyRange() reads it.
  /// @throws ParameterError also for an empty name and for a grey value that is given two names
  void add(std::string_view range, const std::string& name);

  std::optional<std::string> other; ///< phase of all greys that are not listed; none: such a grey is an error

  [[nodiscard]] bool empty() const noexcept { return ranges_.empty() && !other; }
  /// Into how many classes the greys have to be parted: 0 where all bounds are numbers, 2 or 3.
  [[nodiscard]] int classes() const noexcept { return classes_; }
  /// Number bounds that part two ranges: the last grey of each range but those that reach the brightest, rising.
  [[nodiscard]] std::vector<int> cuts() const;

  struct Applied
  {
    PhaseImage image;
    std::optional<GreyLevels> levels;  ///< that were needed, in values
    std::vector<std::string> warnings; ///< where levels are doubtful
  };
  /// Turns grey values (8 or 16 bit, in lattice order) into phases, with ids as GreyMap::apply() gives them.
  /// @throws ParameterError where ranges overlap or speak of greys that the picture cannot have; InputError for greys
  ///         in no phase: names the range that is missing, how many nodes have it and one of them
  [[nodiscard]] Applied apply(
    const Lattice& lattice, std::span<const std::uint16_t> values, const GreyScale& scale = {}) const;

private:
  struct Named
  {
    GreyRange range;
    std::string name;
  };
  std::vector<Named> ranges_;
  int classes_ = 0;
};

} // namespace lamella
