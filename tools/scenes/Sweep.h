#pragma once

#include "scenes/Scene.h"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// "1..10", "0.25..1 step 0.25": from one number to another, both included where the step leads there. Whole numbers
/// where both ends and the step are. Nothing for a text of another kind.
/// @throws ParameterError for a step that does not lead from one to the other, and for more than a million numbers
[[nodiscard]] std::optional<std::vector<Json>> range(const std::string& text, const std::string& where);

/// A key of several values.
struct SweepAxis
{
  std::string path; ///< "sample.seed"; of an entry of a table "material.young.wall"
  std::vector<Json> values;
  std::string where;
  std::string unit; ///< of its numbers; empty: none
};

/// Values of the swept keys of one sample, by path.
using Setting = std::map<std::string, Json>;

/// All samples of a scene: each value of each swept key with each of the others. Keys in the order of the file, the
/// last one fastest.
class Sweep
{
public:
  /// @throws ParameterError for a list that is empty
  explicit Sweep(const Scene& scene);

  [[nodiscard]] const std::vector<SweepAxis>& axes() const noexcept { return axes_; }
  /// How many there are; as a double, for it may be more than can be counted.
  [[nodiscard]] double count() const noexcept;
  /// @param sample from 0, below count()
  [[nodiscard]] Setting setting(std::size_t sample) const;

private:
  std::vector<SweepAxis> axes_;
};

/// The words of a command line for an option in a sample.
/// @throws ParameterError for a value of the wrong kind
[[nodiscard]] std::vector<std::string> wordsFor(const SceneOption& option, const Setting& setting);

} // namespace lamella::cli
