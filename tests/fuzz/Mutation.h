#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace lamella::fuzz
{

using Random = std::mt19937_64;

inline std::size_t below(Random& random, std::size_t count)
{
  return count == 0 ? 0 : random() % count;
}

template <typename List>
auto& oneOf(List& list, Random& random)
{
  return list[below(random, list.size())];
}

/// Alters some bytes, numbers, words or lines of a file, or mixes it with another one.
[[nodiscard]] std::string altered(const std::string& file, const std::vector<std::string>& others, Random& random);

/// A file that says one thing in one place and another elsewhere: whatever reads it has to say so. Nothing for a file
/// in which there is no such place, and for kinds that have none: XML of VTK, PNG, TIFF, PGM, PPM, BMP, NRRD,
/// MetaImage, VTKHDF, TOML and tables can contradict themselves.
[[nodiscard]] std::optional<std::string> contradicting(
  const std::string& file, const std::string& ending, Random& random);

/// A checkpoint whose content was altered, and whose header is that of a good one.
[[nodiscard]] std::string mended(const std::string& checkpoint, Random& random);

} // namespace lamella::fuzz
