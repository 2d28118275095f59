#pragma once

#include "files/FieldReport.h"

#include "io/Provenance.h"

#include <initializer_list>
#include <span>
#include <string>
#include <vector>

class vtkDataObject;
class vtkImageData;

/// What the reports of commands share that bond the nodes of a sample.
namespace lamella::cli
{

/// One run of such a command.
struct BondRun
{
  std::string file;
  vtkImageData* image = nullptr; ///< output of the filter, with its numbers as field data
  std::string pixelSizeSource;
  io::Provenance provenance;
  std::vector<std::string> written;
  int refine = 1;
  int threads = 1;
  int ranks = 1;
  double seconds = 0;
};

/// "1.234e+09 Pa", or "-" for what is not known.
[[nodiscard]] std::string pascal(double value);

/// The field data of an image.
struct BondFields : Fields
{
  explicit BondFields(const BondRun& run);

  vtkImageData* image;
};

/// Of the states kept, one object each, with its file or null.
/// @param keys Number and Whole
[[nodiscard]] Json statesJson(
  std::span<vtkDataObject* const> states, const std::vector<std::string>& files, std::initializer_list<Key> keys);
/// The sample between its platens: length, section, and layers of the platens.
void addPlatens(Json& json, const BondFields& f);
/// Where a run went on, and its checkpoints: up to two lines. @param what it counts, as "steps"
[[nodiscard]] std::string checkpointsText(const BondFields& f, const char* what);

/// Keys of every report: pairs, model, thickness of phases, what was doubtful.
void addModel(Json& json, const BondFields& f);
/// How the stress of the first break changes with the materials: `sensitivity`, `relative_sensitivity`, `input_errors`.
void addBreakSensitivity(Json& json, const BondFields& f);
/// The same in words, behind the line of the first break; empty where it was not asked for.
[[nodiscard]] std::string breakSensitivityText(const BondFields& f);
/// Of the solve: residual, levels, products.
void addSolve(Json& json, const BondFields& f);
/// Sizes: nodes, bonds, strips, bytes.
void addSizes(Json& json, const BondFields& f);
/// The sample and the run: file, size, phases, threads, version, provenance.
void addRun(Json& json, const BondRun& run);

/// Whether lengths are in metres: without the pixel size they are in pixels, and energies mean nothing.
[[nodiscard]] bool sizeKnown(const BondRun& run);
/// Lengths of the result, one or several, with their unit: "1.2, 3 m", or in pixels of the file.
[[nodiscard]] std::string lengthsText(const BondRun& run, const std::vector<double>& lengths);
/// Last words of a table of a sample between platens: what strain and stress mean.
[[nodiscard]] std::string platensText(const BondRun& run);

/// First lines of a table: the sample, and the bonds by pair; with what breaks them, or without.
[[nodiscard]] std::string sampleText(const BondRun& run, bool fracture);
/// Nodes and bonds, in a line.
[[nodiscard]] std::string sizesText(const BondFields& f);

} // namespace lamella::cli
