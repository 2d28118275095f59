#pragma once

#include <filesystem>
#include <span>

namespace lamella::cli
{

/// A film of pictures of one size, in order: Ogg Theora, ten a second. Nothing of no pictures.
/// @throws OutputError; InputError for a picture that cannot be read
void writeMovie(std::span<const std::filesystem::path> pictures, const std::filesystem::path& movie);

} // namespace lamella::cli
