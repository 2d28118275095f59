#pragma once

#include "BondLoad.h"
#include "BondReport.h"
#include "Input.h"
#include "Session.h"

#include <vtkSmartPointer.h>

#include <array>
#include <string>
#include <vector>

class vtkBondAlgorithm;
class vtkImageData;

/// What the commands share that bond the nodes of a sample.
namespace lamella::cli
{

struct BondOptions
{
  std::vector<std::string> young; ///< PAIR=VALUE, likewise the next three
  std::vector<std::string> fractureEnergy;
  std::vector<std::string> toughness;
  std::vector<std::string> criticalStretch;
  std::vector<std::string> like;    ///< PAIR=PAIR
  std::vector<std::string> density; ///< VALUE of all, or PHASE=VALUE
  std::string relativeTo;
  std::string mixing = "none";
  std::vector<std::string> voids;
  double horizon = 3;
  std::string continuum;
  std::string micromodulus; ///< empty: by dimension and command
  std::string voidBonds = "keep";
  bool surfaceCorrection = false;
  bool largeStrains = false;
  std::vector<std::string> notches;
  std::string periodic;
  int refine = 1;
  int threads = 1;
};

/// A coordinate [m]: a number, or one with a unit. 0 and negative ones are coordinates too. @throws ParameterError
[[nodiscard]] double coordinate(const std::string& option, const std::string& text);

/// What a command does with the bonds: some options make no sense for some.
enum class BondUse
{
  Load,      ///< a sample between platens
  Fracture,  ///< likewise, in small strains: no --large-strains
  Motion,    ///< forces are exact for large strains: no --large-strains; --density
  Stiffness, ///< a cell that repeats, in small strains: no --periodic, no --large-strains, nothing about breaking
};

/// Declares the options above.
void addBondOptions(CLI::App& command, BondOptions& options, BondUse use);

/// Gives the filter what the options say. @throws ParameterError for what can be said without the sample
void applyBonds(const BondOptions& options, vtkBondAlgorithm* filter);

/// A sample for such a filter, its grains with it where a .vti has them. What is doubtful about it has been said.
struct BondSample
{
  vtkSmartPointer<vtkImageData> image; ///< window cut out, refined
  std::string pixelSizeSource;         ///< as Sample
  std::string provenance;
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
};

/// @throws as loadSample(); ParameterError for a pair or a void that the sample does not have, and for a fracture
/// energy or a toughness where the pixel size is not known
[[nodiscard]] BondSample loadBondSample(Session& session, const PictureOptions& picture, const BondOptions& options);

/// Runs the filter on the sample that rank 0 holds, on all ranks, with a progress bar of the filter's words, or `what`;
/// rank 0 then holds its output.
/// @throws the kind of Error that the filter met; Cancelled
void runBonds(Session& session, vtkBondAlgorithm* filter, const BondSample& sample, const char* what);

/// What a report needs of a run on rank 0, whose filter's warnings are said with it.
[[nodiscard]] BondRun bondRun(Session& session, vtkBondAlgorithm* filter, const PictureOptions& picture,
  const BondOptions& options, const BondSample& sample, const std::string& commandLine);

} // namespace lamella::cli
