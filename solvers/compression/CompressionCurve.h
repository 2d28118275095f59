#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// What a compression run tells: its curve, and which cells gave way.
namespace lamella::compression
{

/// Strains are fractions of the height at the start, compression positive.
struct CurveOptions
{
  /// Rows between these strains give the stiffness: 0 to 3 %, as in the paper.
  std::array<double, 2> stiffnessRange{ 0.0, 0.03 };
  /// Width of the steepest window within that range that is fitted instead, where a curve begins with a toe or bends
  /// early; 0: all of the range.
  double window = 0;
  double offset = 0.002; ///< plastic strain at the yield stress: 0.2 %, as in ISO 13314
  /// Where the plateau's mean is taken, such as 20 % to 40 % (ISO 13314); none: from collapse to densification.
  std::optional<std::array<double, 2>> plateauRange{};
  /// Width in strain over which stresses are smoothed (local straight lines) before a maximum or a crossing is looked
  /// for; 0: not at all. Stiffness, plateau and energy are sums, and take the stresses as they are.
  double smoothing = 0.01;
  /// A maximum counts where the curve falls below it by this share afterwards, before it is higher again.
  double prominence = 0.05;
};

/// σ ≈ slope · ε + intercept, by least squares.
struct LinearPart
{
  double slope = 0;         ///< E [Pa]
  double standardError = 0; ///< of the slope, of independent residuals [Pa]
  double intercept = 0;     ///< [Pa]
  double r2 = 0;            ///< share of the variance that the line explains
  double low = 0;           ///< strain of the first row that was fitted
  double high = 0;          ///< of the last one
  std::size_t rows = 0;

  /// Strain at which the line begins: how long the toe is, where there is one.
  [[nodiscard]] double toe() const noexcept { return -intercept / slope; }
};

struct CurvePoint
{
  double strain = 0;
  double stress = 0; ///< [Pa]
};

struct Plateau
{
  double stress = 0; ///< mean over the strain between low and high [Pa]
  double low = 0;
  double high = 0;
};

struct Densification
{
  double strain = 0;
  double stress = 0;     ///< smoothed [Pa]
  double energy = 0;     ///< W there [J/m³]
  double efficiency = 0; ///< η there, of the smoothed stress
};

/// What was not found is empty, and `missing` says why.
struct CompressionCurve
{
  std::vector<double> energy;     ///< by row: W = ∫ σ dε from the first row on, trapezia [J/m³]
  std::vector<double> smooth;     ///< by row: stress, smoothed [Pa]
  std::vector<double> efficiency; ///< by row: η = W/σ, of the smoothed stress; NaN where that is not above 0
  std::optional<LinearPart> linear;
  std::optional<CurvePoint> yield; ///< where the curve meets the line moved by the offset
  std::optional<CurvePoint> peak;  ///< first maximum of the smoothed stress
  std::optional<Plateau> plateau;
  std::optional<Densification> densification; ///< onset: where η is largest, or nearly so before
  std::optional<CurvePoint> plateauEnd;       ///< where the stress first is 1.3 times the plateau's, beyond its low end
  std::vector<std::string> missing;           ///< "densification: the efficiency still rises where the curve ends"

  /// Where cells begin to give way: the yield point or the first maximum, whichever comes first.
  [[nodiscard]] std::optional<CurvePoint> collapse() const
  {
    return peak && (!yield || peak->strain < yield->strain) ? peak : yield;
  }
};

/// Offset yield stress, first maximum, plateau stress and its end are those of ISO 13314:2011. Densification begins
/// where the efficiency of energy absorption η(ε) = 1/σ(ε) ∫₀^ε σ dε' is largest (Li, Magkiriadis and Harrigan, J.
/// Cell. Plast. 42 (2006) 371–392; Tan, Reid, Harrigan, Zou and Li, J. Mech. Phys. Solids 53 (2005) 2174–2205), from
/// the end of the linear part on, if it falls by `prominence` beyond: a curve that ends before has none. Of maxima
/// within `prominence` of the largest the first one counts.
///
/// Time: rows × rows a window, of fit and of smoothing.
/// @param strain at least 3, not falling, below 1
/// @param stress one a strain [Pa]
/// @throws ParameterError: ranges that are empty or not finite; offset, window, smoothing or prominence out of range
/// @throws InputError: columns of unequal length or fewer than 3 rows; what is not finite; strain that falls, stays the
/// same or is 1 or more; a stress that does no work, as where compression is negative
[[nodiscard]] CompressionCurve compressionCurve(
  std::span<const double> strain, std::span<const double> stress, const CurveOptions& options);

} // namespace lamella::compression
