#pragma once

#include <string>
#include <vector>

/// Curves as SVG in the page: lines of text, with the page's own colours in light and dark.
namespace lamella::reports
{

struct Curve
{
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> error; ///< half the length of the error bars; empty: none
};

struct Chart
{
  std::string xLabel;
  std::string yLabel;
  bool logX = false;
  bool logY = false;
  bool points = false; ///< marks beside the lines; few points get them in any case
  std::string words;   ///< what is to be seen, for those who do not see it
  std::vector<Curve> curves;
  /// Words along x, where x of the curves is their number, from 0. Then there are marks and no lines.
  std::vector<std::string> kinds{};
  bool apart = false; ///< curves stand a few pixels apart, so that bars do not hide each other
};

/// A number beside a tick or in a name: 0.25, 8 × 10⁷.
[[nodiscard]] std::string numberText(double value);

/// Round numbers between low and high, about `count` of them: steps of 1, 2 or 5 times a power of ten.
/// @pre low < high, both finite
[[nodiscard]] std::vector<double> linearTicks(double low, double high, int count);

/// Powers of ten, with 2 and 5 times them, and more of them, where there are few. @pre 0 < low < high
[[nodiscard]] std::vector<double> logTicks(double low, double high);

/// Fewer points for a picture a few hundred pixels wide: in each of `bins` stretches of the curve, in the order of its
/// points, the first, lowest, highest and last one, so that no peak is lost.
/// @pre x and y are equally long
[[nodiscard]] Curve thinned(const Curve& curve, std::size_t bins);

/// @returns an <svg> element; points that are not finite, or not above 0 on a logarithmic axis, part a line. Empty when
///          there is nothing to draw.
[[nodiscard]] std::string svg(const Chart& chart);

} // namespace lamella::reports
