#pragma once

#include <cstdint>
#include <string>

namespace lamella::micrograph
{

/// From which of a picture's colours the grey is made that tells walls from lumens.
enum class Channel
{
  Auto, ///< the one whose two classes are farthest apart (Otsu's separability)
  Grey,
  Red,
  Green,
  Blue,
  Stain ///< the combination of red, green and blue that separates the two classes best (Fisher's discriminant)
};

/// Something in a picture that is worth pointing at. Nodes x0 … x1 - 1, y0 … y1 - 1, y up.
struct Mark
{
  enum class Kind
  {
    Margin, ///< blank rows or columns at the picture's side, data bars among them
    Bar,    ///< a scale bar
    Text,   ///< one line of it
    Ray,    ///< a gap in a ray, taken for wall
    Gap     ///< a tear, or slide beside the tissue; counted as lumen
  };
  Kind kind = Kind::Bar;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// "margin", "scale bar", "text", "ray gap", "gap".
[[nodiscard]] std::string name(Mark::Kind kind);

/// From which solidity on a lumen is compact as a cell is: its area over that of its convex hull.
constexpr double compactSolidity = 0.85;

/// Why a segmentation may be wrong.
enum class Doubt
{
  Side,       ///< what was taken for lumens does not look like cells
  Greys,      ///< there are more than two classes of greys
  Filled,     ///< places in the walls are as thick as cells are wide
  Resolution, ///< lumens, walls or edges are too few pixels wide
  Gaps,       ///< tears, or slide beside the tissue, are among the lumens
  Contrast,   ///< the two classes are hard to tell apart
  Share       ///< hardly any lumen, or hardly any wall
};

/// How far a surface may lie from where it was put [pixels]: as far as it moves where the grey that parts two phases is
/// wrong by 5 % of their contrast, at an edge that a Gaussian blurs, 0.05 √(2π) s; and as far as that blur moves one
/// that is curved, s²/2r, of which what is corrected is not known to better than itself. The root of the squares.
/// @param blur   s of the edge [pixels]; 0 where it is not known, which counts as 1.5
/// @param radius r of lumens [pixels]
[[nodiscard]] double surfaceDoubt(double blur, double radius);

/// "side", "greys", "filled", "resolution", "gaps", "contrast", "share".
[[nodiscard]] std::string name(Doubt doubt);

/// A doubt, in words.
struct Remark
{
  Doubt doubt{};
  std::string text; ///< one line
};

/// A lumen as the ellipse with its second moments shows it; lengths in pixels, x to the right, y up the rows in memory.
struct LumenShape
{
  std::int64_t area = 0;        ///< [pixels]
  double x = 0, y = 0;          ///< centre
  double length = 0, width = 0; ///< axes of the ellipse
  double cosine = 1, sine = 0;  ///< direction of its long axis
  bool cut = false;             ///< touches the picture's border

  /// Extent of the ellipse along a direction of length 1.
  [[nodiscard]] double along(double dx, double dy) const;
};

} // namespace lamella::micrograph
