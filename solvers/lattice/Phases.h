#pragma once

#include "lattice/Lattice.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lamella
{

/// Names of the phases; the position in the table is the value of the `phase` array.
class PhaseTable
{
public:
  PhaseTable() = default;
  explicit PhaseTable(const std::vector<std::string>& names);

  /// Id of a name, added at the end if it is new.
  /// @throws ParameterError when the name is empty or 256 phases exist already
  std::uint8_t add(const std::string& name);
  /// Id of a name, or nothing.
  [[nodiscard]] std::optional<std::uint8_t> find(const std::string& name) const;
  [[nodiscard]] const std::string& name(std::uint8_t id) const { return names_.at(id); }
  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return names_; }
  [[nodiscard]] std::size_t size() const noexcept { return names_.size(); }

private:
  std::vector<std::string> names_;
};

/// A lattice of phases: what every generator and every reader returns and every solver takes.
struct PhaseImage
{
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< lattice.count() ids into `phases`
  PhaseTable phases;

  /// Share of the nodes in each phase; phases.size() values that sum to 1.
  [[nodiscard]] std::vector<double> fractions() const;
};

/// Which grey value is which phase.
struct GreyMap
{
  std::map<int, std::string> phaseOfGrey;
  std::optional<std::string> other; ///< phase of all greys not listed; none: such a grey is an error

  /// Turns grey values (8 or 16 bit, in lattice order) into phases. Phase ids follow the order of first mention:
  /// phaseOfGrey by rising grey, then `other`; a phase called "void" always gets id 0.
  /// @throws InputError for a grey in no phase: names it, how many nodes have it and the first such node
  [[nodiscard]] PhaseImage apply(const Lattice& lattice, std::span<const std::uint16_t> grey) const;
};

/// A box of nodes cut out of a picture or volume. In 2D y counts from the *top* row of the picture, in volumes every
/// axis counts from the first node in the file.
struct Window
{
  std::array<std::int64_t, 3> start{ 0, 0, 0 };
  std::array<std::int64_t, 3> size{ 0, 0, 0 }; ///< size[2] = 0 in 2D
  [[nodiscard]] bool operator==(const Window&) const = default;
};

/// The first node of a window as memory counts (in 2D from the bottom row).
/// @throws ParameterError for a window that is empty or reaches outside (says the picture's size)
[[nodiscard]] std::array<std::int64_t, 3> firstNode(const Lattice& lattice, const Window& window);

/// @throws ParameterError as firstNode()
[[nodiscard]] PhaseImage crop(const PhaseImage& image, const Window& window);

/// Splits every pixel into n × n (voxel into n × n × n): the same geometry on a finer lattice, spacing/n.
/// @throws ParameterError for n < 1; MemoryError (how much it would need) when the result cannot be held
[[nodiscard]] PhaseImage refine(const PhaseImage& image, int n);

} // namespace lamella
