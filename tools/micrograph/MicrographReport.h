#pragma once

#include "files/JsonReport.h"
#include "micrograph/MicrographInput.h"

#include "OutlineFindings.h"
#include "io/Provenance.h"
#include "outlines/ContourMeasures.h"
#include "outlines/LumenClasses.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace lamella::cli
{

/// What became of the middle lamella.
struct LamellaReport
{
  std::string method;        ///< "growth", "constant" or "labels"
  double thickness = 0;      ///< [m]; 0 of labels
  double radius = 0;         ///< [m]; of growth
  double horizon = 0;        ///< asked for [nodes]; 0: none
  double mean = 0, low = 0;  ///< nodes across it; 5 % of it has fewer than `low`
  double wallShare = 0;      ///< of the wall's nodes
  std::int64_t networks = 0; ///< of growth and constant
  double largestNetwork = 0; ///< share of it
  std::int64_t cells = 0, cellsTouched = 0, cellsCutOff = 0;
};

/// Everything that is told at the end.
struct MicrographReport
{
  std::string file;
  const Micrograph* micrograph = nullptr;
  std::vector<micrograph::LumenMeasures> measures;
  micrograph::LumenClasses classes; ///< by lumen as `measures`; those that the border cuts are classed by what is seen
  bool cells = true;                ///< lumens look like a tissue's: words of wood are in place
  double wallFraction = 0;
  micrograph::WallThickness thickness;
  double spacing = 0; ///< of the lattice [m]
  std::array<std::int64_t, 3> size{ 0, 0, 1 };
  double cropped = 0; ///< [m]
  double wallFractionOnLattice = 0;
  std::int64_t wallNodes = 0;
  std::vector<std::string> phases;
  std::vector<double> fractions;
  std::optional<LamellaReport> lamella;
  OutlineFindings found; ///< of diffusion
  std::vector<std::string> written;
  std::vector<std::string> warnings;
  double seconds = 0;
  double latticeSeconds = 0; ///< from the file to the lattice with directions and lamella
  io::Provenance provenance;
};

/// Vessels and fibres by the longest diameters of lumens that are whole; one that the border cuts is a vessel where
/// what is seen of it is larger than the threshold.
[[nodiscard]] micrograph::LumenClasses classify(const std::vector<micrograph::LumenMeasures>& measures);

/// Whether most of the lumens' area is in compact ones, and the segmentation found no reason to doubt that they are
/// cells.
[[nodiscard]] bool lookLikeCells(const Micrograph& micrograph, const std::vector<micrograph::LumenMeasures>& measures);

/// How a scan was segmented, lengths in pixels.
[[nodiscard]] Json segmentationJson(const micrograph::SegmentReport& report);
[[nodiscard]] std::string toJson(const MicrographReport& report);
[[nodiscard]] std::string toTable(const MicrographReport& report);

} // namespace lamella::cli
