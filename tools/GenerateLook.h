#pragma once

#include "generators/MicrographLook.h"
#include "lattice/Phases.h"

#include <CLI/App.hpp>
#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

/// The options with which `lamella generate` draws a tissue as a micrograph.
namespace lamella::cli
{

struct LookChoice
{
  std::string look; ///< --look; empty: labels are written
  std::string truth;
  std::string blur;
  std::string scaleBar = "0";
  double noise = 0, unevenLight = 0, dirt = 0, tears = 0, rim = 0;
};

void addLookOptions(CLI::App& command, LookChoice& choice);

/// A micrograph to be drawn.
struct Look
{
  generators::LookOptions options;
  std::string stain; ///< as the option says it
  std::string truth; ///< file for the labels, or empty
  /// The tissue on a lattice so many times finer than the picture.
  std::function<PhaseImage(int finer)> tissue;

  [[nodiscard]] micrograph::Picture draw() const;
  [[nodiscard]] nlohmann::ordered_json toJson() const;
};

/// Nothing where no look is asked for.
/// @throws ParameterError for words and numbers that make no sense, a volume, a name that does not end in .png
[[nodiscard]] std::optional<Look> parseLook(const CLI::App& command, const LookChoice& choice,
  const std::string& output, int dimension, std::uint64_t seed, std::function<PhaseImage(int finer)> tissue);

} // namespace lamella::cli
