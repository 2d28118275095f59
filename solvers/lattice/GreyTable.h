#pragma once

#include "lattice/GreyBins.h"

#include <map>
#include <string>
#include <vector>

namespace lamella
{

/// A property of a material by its grey: given at some greys, linear between them, and constant beyond the outermost.
class GreyTable
{
public:
  /// @param given by grey as text  @param quantity what messages call it
  /// @throws ParameterError for what is no grey, fewer than two, values that are negative or not finite, or all 0
  GreyTable(const std::map<std::string, double>& given, const std::string& quantity);

  [[nodiscard]] double value(double grey) const noexcept;
  /// The outermost greys that were given.
  [[nodiscard]] double lowest() const noexcept { return grey_.front(); }
  [[nodiscard]] double highest() const noexcept { return grey_.back(); }
  /// Bins of greys, narrow where the value changes by much of itself: what is below a millionth of the largest counts
  /// as 0.
  [[nodiscard]] GreyBins bins() const;
  /// The largest part of itself by which a value changes when its grey's bin stands for it.
  [[nodiscard]] double rounding() const;

private:
  struct Piece
  {
    double from;
    double to;     ///< grey
    double change; ///< |ln| of the ratio of the values at both ends
    bool none;     ///< all of it is 0
  };
  [[nodiscard]] std::vector<Piece> pieces() const;
  /// By how much ln of a value changes over a bin, at most.
  [[nodiscard]] double step() const;

  std::vector<double> grey_;
  std::vector<double> value_;
  double least_ = 0; ///< smaller ones are 0
};

} // namespace lamella
