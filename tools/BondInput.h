#pragma once

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
  std::vector<std::string> like; ///< PAIR=PAIR
  std::string relativeTo;
  std::string mixing = "none";
  std::vector<std::string> voids;
  double horizon = 3;
  std::string continuum;
  std::string micromodulus = "continuum";
  std::string voidBonds = "keep";
  bool surfaceCorrection = false;
  bool largeStrains = false;
  std::vector<std::string> notches;
  std::string periodic;
  int refine = 1;
  int threads = 1;
};

/// Declares all of the options above.
void addBondOptions(CLI::App& command, BondOptions& options);

/// Gives the filter what the options say. @throws ParameterError for what can be said without the sample
void applyBonds(const BondOptions& options, vtkBondAlgorithm* filter);

/// A sample for such a filter, its grains with it where a .vti has them.
struct BondSample
{
  vtkSmartPointer<vtkImageData> image; ///< window cut out, refined
  std::string pixelSizeSource;         ///< as Sample
  std::string provenance;
  std::vector<std::string> warnings;
  std::array<int, 6> extent{ 0, -1, 0, -1, 0, -1 };
};

/// @throws as loadSample(); ParameterError for a pair or a void that the sample does not have, and for a fracture
/// energy or a toughness where the pixel size is not known
[[nodiscard]] BondSample loadBondSample(const PictureOptions& picture, const BondOptions& options);

/// Runs the filter on the sample that rank 0 holds, on all ranks, with a progress bar; rank 0 then holds its output.
/// @throws the kind of Error that the filter met; Cancelled
void runBonds(Session& session, vtkBondAlgorithm* filter, const BondSample& sample, const char* what);

} // namespace lamella::cli
