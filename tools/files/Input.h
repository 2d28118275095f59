#pragma once

#include "program/SettingOptions.h"

#include "PhasePicture.h"
#include "pictures/Picture.h"

#include <CLI/App.hpp>

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
  SettingOptions settings; ///< of vtkPictureReader
};

/// Declares the options that name phases; those of raw volumes and pixel sizes; FILE and all of them.
void addPhaseOptions(CLI::App& command, PictureOptions& options);
void addRawOptions(CLI::App& command, PictureOptions& options);
void addPictureOptions(CLI::App& command, PictureOptions& options);
/// Of volumes whose voxels are not cubes, for commands that take them.
void addSliceDistance(CLI::App& command, PictureOptions& options);
/// How scans are segmented, but for their lumens, and the words that say so.
[[nodiscard]] const std::vector<std::string>& scanWords();

/// Those of raw volumes and pixel sizes, of all that convert() reads.
[[nodiscard]] const std::vector<std::string>& rawWords();

/// What was said, as readPhases() takes it. @throws ParameterError
[[nodiscard]] lamella::PictureOptions readerOptions(const PictureOptions& options);
/// Four numbers for a picture, six for a volume. @throws ParameterError
void requireWindowFits(const Lattice& lattice, const std::optional<Window>& window);

/// Told by the ending of the name.
[[nodiscard]] bool isVtkImage(const std::string& path);

/// A sample as the solvers take it: window cut out, greys named, not refined.
using Sample = PhasePicture;

/// Told the lattice of the sample, which comes from the file's header, before the pixels are read; throws to refuse it,
/// so that a volume too large to be worked on is not read first. Not told where only the whole file tells the size.
using SampleCheck = std::function<void(const Lattice& sample)>;

/// @param greys those that nobody named are wanted as they are, each a phase
/// @throws ParameterError, InputError, MemoryError; what `check` throws
[[nodiscard]] Sample loadSample(
  const PictureOptions& options, const SampleCheck& check = {}, const std::optional<GreyBins>& greys = {});

/// The grey values of a picture or volume, with what lamella recorded in it, if lamella wrote it.
/// @throws InputError
[[nodiscard]] PictureFile readPictureFile(
  const std::string& file, micrograph::ReadOptions read, const std::string& array = {});

/// A --pixel-size, as given, without a unit and certainly no microscope's: micrometres were meant. Empty where there is
/// nothing to say.
[[nodiscard]] std::string pixelSizeDoubt(const std::string& given);

} // namespace lamella::cli
