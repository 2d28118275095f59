#pragma once

#include "PhasePicture.h"

#include "lattice/GreyRanges.h"
#include "pictures/Picture.h"

#include <CLI/App.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// What the user says about a picture, volume or `.vti`: the words that all commands share.
struct PictureOptions
{
  std::string file;
  std::vector<std::string> phase; ///< --phase GREY=NAME, or a range of greys
  std::string other;              ///< --other NAME
  std::string window;             ///< --window X,Y,WIDTH,HEIGHT
  std::string pixelSize;          ///< --pixel-size METRES
  std::string rawSize;            ///< --raw-size NX,NY,NZ
  int rawBits = 0;                ///< --raw-bits 8|16; 0: from the name, else 8
  std::uint64_t rawHeader = 0;    ///< --raw-header BYTES
  std::string array;              ///< --array NAME
  bool segment = false;           ///< --segment
  std::string lumen = "auto";     ///< --lumen auto|bright|dark
  std::string threshold;          ///< --threshold GREY
};

/// Declares FILE; the options that name phases; those of raw volumes and pixel sizes; FILE and all of the options
/// above.
void addFileOption(CLI::App& command, PictureOptions& options);
void addPhaseOptions(CLI::App& command, PictureOptions& options);
void addRawOptions(CLI::App& command, PictureOptions& options);
void addPictureOptions(CLI::App& command, PictureOptions& options);

/// The options in numbers. @throws ParameterError
[[nodiscard]] std::optional<Window> parseWindow(const std::string& text);
/// Four numbers for a picture, six for a volume. @throws ParameterError
void requireWindowFits(const Lattice& lattice, const std::optional<Window>& window);
[[nodiscard]] micrograph::ReadOptions readOptions(const PictureOptions& options);
[[nodiscard]] std::optional<GreyRanges> greyRanges(const PictureOptions& options);

/// Told by the ending of the name.
[[nodiscard]] bool isVtkImage(const std::string& path);

/// A sample as the solvers take it: window cut out, greys named, not refined.
using Sample = PhasePicture;

/// Told the lattice of the sample, which comes from the file's header, before the pixels are read; throws to refuse it,
/// so that a volume too large to be worked on is not read first. Not told where only the whole file tells the size.
using SampleCheck = std::function<void(const Lattice& sample)>;

/// @throws ParameterError, InputError, MemoryError; what `check` throws
[[nodiscard]] Sample loadSample(const PictureOptions& options, const SampleCheck& check = {});

/// The grey values of a picture or volume, with what lamella recorded in it, if lamella wrote it.
/// @param read readOptions() of them, and more
/// @throws InputError
[[nodiscard]] PictureFile readPictureFile(const PictureOptions& options, micrograph::ReadOptions read);

/// A --pixel-size, as given, without a unit and certainly no microscope's: micrometres were meant. Empty where there is
/// nothing to say.
[[nodiscard]] std::string pixelSizeDoubt(const std::string& given);

} // namespace lamella::cli
