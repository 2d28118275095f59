#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

namespace lamella
{

/// What is known about the error of an effective value that was computed from pixels. All are relative to the
/// value, none is negative, NaN: could not be had.
///
/// A picture errs twice. Its lattice solves the steps of its pixels with one node a pixel; splitting the pixels mends
/// that. And the steps are not the material; only smaller pixels mend that, and splitting does not see it. The two may
/// have opposite signs, so that `relative` can be below either.
struct ErrorEstimate
{
  double relative = std::numeric_limits<double>::quiet_NaN(); ///< of the value against the material's: the total
  double lattice = std::numeric_limits<double>::quiet_NaN();  ///< of the value against the same pixels on a lattice
                                                              ///< without end
  double picture = std::numeric_limits<double>::quiet_NaN();  ///< of these against the material
  /// What the material is expected to have, in the unit of the value: only where it is nearer than the value, as far
  /// as can be told; else NaN.
  double extrapolated = std::numeric_limits<double>::quiet_NaN();
};

/// Values of the pictures that every `stride`-th pixel of a picture gives; 0 where nothing conducts or carries.
struct SubsampleValues
{
  /// Of pictures that repeat it need not be a whole number (PeriodicThinning); the nearest one says which it is.
  double stride = 2;
  std::vector<double> values;
};

/// How an effective value changes with the pixel, from subsamples of one picture (lattice/Subsample.h).
///
/// Pixels of size h displace a boundary at random by a part of h, which gives an error of two parts: a mean one, which
/// falls like h (necks that close, walls that break up into steps), and one by chance, which falls like h^(3/2), as the
/// mean over as many boundary pixels as h allows does. So with m_k and s_k the mean and the standard deviation of the
/// values of the pictures that every k-th pixel gives, and v the picture's own, the material's value is expected to be
/// v + (v − m₂), and the bar is
///
///   max(|v − m₂|, |v − m₃|/2, |m₂ − m₄|/2) + max(s₂, s₃ (2/3)^(3/2), s₄ (2/4)^(3/2)).
///
/// All terms of a maximum are expected to be alike. Where two pictures agree by chance, or all of a kind are mirror
/// images of each other as those of a symmetric picture are, the others tell. Where the k-th pixels lie q spacings
/// apart in the mean, the differences are over q less 1 (of m₂ and m₄ over that of their q), chance over that power of
/// q/2. On which cases it was found and on which others it held: docs/benchmarks/diffusion.md, and
/// docs/benchmarks/stiffness.md for bonds, whose soft layer at a boundary, as thick as the horizon of so many pixels,
/// falls like h as well.
class PictureError
{
public:
  /// @param value       of the picture, above 0
  /// @param subsamples  of every second pixel first, then of every third, of every fourth, as far as there are any
  PictureError(double value, std::span<const SubsampleValues> subsamples)
    : PictureError(value, subsamples, value)
  {
  }
  /// The same relative to another value than the picture's, which may then have any sign: with `unit` 1 all is in the
  /// unit of the value.
  PictureError(double value, std::span<const SubsampleValues> subsamples, double unit);

  /// Bar of another solve of the same picture, relative to `value`, which differs from that by `change` times it: of
  /// split pixels. 0: of the value itself.
  [[nodiscard]] double bar(double change = 0) const noexcept;

  /// The material's value over the picture's own less one, as expected.
  [[nodiscard]] double bias() const noexcept { return bias_; }
  /// What chance may add.
  [[nodiscard]] double scatter() const noexcept { return scatter_; }

  /// The whole estimate of a solve whose value is `change` above the picture's and which a lattice without end would
  /// raise by `lattice`, both relative to the picture's.
  [[nodiscard]] ErrorEstimate estimate(double change, double lattice) const noexcept;

private:
  double value_ = 0;
  double bias_ = 0;
  std::array<double, 3> biases_{ 0, 0, 0 }; ///< the bias, and what it is expected to be from larger pixels
  double scatter_ = 0;
};

} // namespace lamella
