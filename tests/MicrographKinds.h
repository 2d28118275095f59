// Pictures whose truth is known, of what a microscope or a tomograph may see: tissue that must be found without a
// warning, and what a threshold gets wrong, of which the user must be warned.
#pragma once

#include "lattice/Phases.h"
#include "pictures/Picture.h"

#include <cstdint>
#include <string>
#include <vector>

namespace lamella::kinds
{

enum class Kind
{
  Good,      ///< whole tissue and foams in every look, lumens six pixels wide and more
  Pith,      ///< thin-walled cells, half of them filled with stain
  Rock,      ///< thin section: bright and cloudy grains, pores full of coloured resin
  RockGrey,  ///< the same by electrons: grains of several greys, dark pores
  Tomogram,  ///< void, fibres and matrix, noisy and blurred
  Coarse,    ///< lumens two to four pixels wide
  Torn,      ///< good tissue with tears as bright as its lumens
  Background ///< good tissue that ends within the picture
};

[[nodiscard]] std::string name(Kind kind);
[[nodiscard]] const std::vector<Kind>& faulty(); ///< all but Good

struct Sample
{
  Kind kind{};
  micrograph::Picture picture;
  std::vector<bool> open; ///< the truth: lumen, pore or void, by node
  std::string what;       ///< what it was drawn from
};

/// One picture, 150 to 600 pixels wide.
/// @param other draws with the shapes of a second family, which share no geometry with those of the first: for a
///        judgement that tuning did not see
[[nodiscard]] Sample draw(Kind kind, std::uint64_t seed, bool other = false);

/// What is there of a result: intersection over union of the lumens, and its share less the true share.
struct Agreement
{
  double overlap = 0;
  double excess = 0;
  [[nodiscard]] bool right() const; ///< at least 0.9, and at most three points of share away
};
[[nodiscard]] Agreement compare(const PhaseImage& found, const std::vector<bool>& open);

} // namespace lamella::kinds
