#pragma once

#include "lattice/Phases.h"
#include "pictures/Picture.h"

#include <cstdint>
#include <string>

/// Phases made to look like a micrograph of them, so that what finds the phases again can be judged: the truth is
/// known.
namespace lamella::generators
{

enum class Stain
{
  Magenta, ///< safranin: magenta walls, bright lumens (transmitted light)
  Blue,    ///< astra blue: blue walls, bright lumens (transmitted light)
  Grey     ///< ESEM: bright walls with brighter edges, dark lumens
};

struct LookOptions
{
  Stain stain = Stain::Magenta;
  double strength = 1;         ///< of the stain, 0.2 pale … 2 deep
  double cellVariation = 0.12; ///< relative standard deviation of the stain from cell to cell
  double wallVariation = 0.15; ///< of the stain along the walls, over some ten micrometres
  double lamella = 0.35;       ///< how much deeper the compound middle lamella is stained; 0: as the wall
  double lamellaWidth = 1e-6;  ///< its thickness [m]
  double rim = 0;              ///< fringe of upright walls out of focus: dark (grey: bright) line on the edge; 0: none
  double rimWidth = 0.6e-6;    ///< its width [m]
  double tint = 0.03;          ///< stain in the lumens
  double blur = 0.5e-6;        ///< standard deviation of the optics' Gaussian point spread [m]; 0: none
  double noise = 0.02;         ///< standard deviation in a bright place over full scale: half of it light, half camera
  double unevenLight = 0.2;    ///< how much darker the darkest corner is than the brightest place
  double dirt = 4;             ///< specks a square millimetre, 3 to 12 µm wide
  double tears = 0;            ///< torn places a square millimetre: short cracks through walls; the truth stays whole
  double scaleBar = 0; ///< length of a bar drawn into the lower right corner, with its length as text [m]; 0: none
  std::uint64_t seed = 1;
};

/// A picture (8 bits, `colour` filled unless grey) of a cross-section, n times coarser than it: what a pixel shows is
/// the mean of n × n nodes, so that edges are smooth. Phases that isVoidName() knows are open, all others wall.
///
/// In transmitted light a pixel has, before blur and noise, exp(−ε s) of the light with s the stain and ε its
/// absorption of red, green and blue (Beer and Lambert's law), averaged over its nodes. Cells are told apart by the
/// nearest lumen; the middle lamella is where the nearest lumen changes.
///
/// The same picture on every machine: IEEE +, −, ×, / and √ alone, no library's exp or filter, and one order of sums;
/// only the digits of a scale bar are OpenCV's.
/// @param truth 2D; sizes are multiples of n
/// @throws ParameterError for a volume, n outside 1 … 16 or no divisor of the size, options outside their range, a bar
///         longer than the picture; MemoryError
/// Time: about 0.25 µs a node of the truth and 0.5 µs a pixel; memory: 35 bytes a node.
[[nodiscard]] micrograph::Picture makeLook(const PhaseImage& truth, int n, const LookOptions& options = {});

} // namespace lamella::generators
