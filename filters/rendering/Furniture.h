#pragma once

#include "Canvas.h"
#include "Palette.h"

#include <optional>
#include <string>
#include <vector>

/// All that stands around the data in a picture: title, scale bar, colour bar, legend. It never overlaps the data.
namespace lamella::rendering
{

struct PixelPoint
{
  int x = 0;
  int y = 0;
};

/// A bar of colours with numbers, and what they mean.
struct ColorBar
{
  const ColorMap* map = nullptr;
  double low = 0;
  double high = 1;
  bool logarithmic = false; ///< low and high are powers of ten
  bool below = false;       ///< some data are below `low`: the bar ends in a point
  bool above = false;
  std::string title;
  std::string unit;
};

/// One line of the legend: a patch of colour, or a sample of a line that is drawn on the data.
struct LegendEntry
{
  enum class Kind
  {
    Patch,
    Line
  };
  std::string text;
  Color color;
  Kind kind = Kind::Patch;
  Color ground{}; ///< what a line lies on
};

/// What a data unit is on paper.
struct Scale
{
  double lengthPerUnit = 1; ///< metres (or pixels of the picture) for one unit of the drawing
  bool metres = true;       ///< false: the pixel size is not known, lengths are in pixels
};

struct Furniture
{
  std::string title;
  std::optional<ColorBar> bar;
  std::vector<LegendEntry> legend;
  std::optional<Scale> scale;
};

struct SizeRequest
{
  int width = 0; ///< of the whole picture; 0: follows from the data
  int height = 0;
  double fontScale = 1;
};

struct Layout
{
  int width = 0;
  int height = 0;
  PixelRect data;
  double scale = 1; ///< picture pixels a unit of the drawing
  double font = 0;  ///< height of the text
  PixelRect bar;
  bool barUpright = true;
  std::optional<PixelPoint> scaleBar; ///< lower left end
  int scaleBarLength = 0;
  std::string scaleBarText;
  std::vector<PixelPoint> legend; ///< lower left corner of each entry's patch
  PixelPoint title{};

  [[nodiscard]] int Rule() const;  ///< thickness of frames and ticks
  [[nodiscard]] int Patch() const; ///< side of a legend's patch
};

/// Finds room for everything around a drawing of unitsX × unitsY.
/// @param pixelated the drawing is made of square units of one pixel of data: prefer a whole number of picture pixels
/// each
/// @returns nothing when the size asked for leaves no room for the data; `smallest` then says what would
[[nodiscard]] std::optional<Layout> Arrange(const Furniture& furniture, double unitsX, double unitsY, bool pixelated,
  const SizeRequest& request, std::string& smallest);

/// Draws it. A frame goes round the data if `framed`.
void DrawFurniture(Canvas& canvas, const Furniture& furniture, const Layout& layout, Color ink, bool framed);

/// Numbers at which a reader expects marks: 4 to 7 of them, steps of 1, 2, 2.5 or 5 times a power of ten.
[[nodiscard]] std::vector<double> NiceTicks(double low, double high);

/// Marks between two powers of ten, as powers: 1, 10, 100 ..., with 2 and 5 between them where they are few.
[[nodiscard]] std::vector<double> LogarithmicTicks(double low, double high);

/// The numbers as text with as many decimals as they need; a common power of ten is taken out where numbers are large
/// or small, and returned as its exponent.
[[nodiscard]] std::vector<std::string> TickLabels(const std::vector<double>& ticks, int& exponent);

/// An integer as raised characters of Unicode: −3 gives "⁻³".
[[nodiscard]] std::string RaisedText(int number);

/// A length for the scale bar, at most `largest`, with its text: 1, 2 or 5 times a power of ten.
[[nodiscard]] double NiceLength(double largest, bool metres, std::string& text);

} // namespace lamella::rendering
