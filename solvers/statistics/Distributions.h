#pragma once

/// The distributions that small samples need.
namespace lamella::statistics
{

/// The regularised incomplete beta function I_x(a, b), to about 1e-14 (its continued fraction, DLMF 8.17.22).
/// @param a, b above 0
/// @param x    0 … 1
[[nodiscard]] double incompleteBeta(double a, double b, double x);

/// The x that Student's t with this freedom is within ±x of with this probability: 2.776 for 0.95 and 4.
/// @param probability 0 … 1, less than 1
/// @param freedom     above 0, need not be whole
/// @throws ParameterError outside these
[[nodiscard]] double studentQuantile(double probability, double freedom);

/// How likely Fisher's F with these freedoms is above f.
/// @throws ParameterError where a freedom is not above 0
[[nodiscard]] double fisherTail(double f, double freedom, double freedomBelow);

/// How likely χ² with this freedom is above x (series and continued fraction of the incomplete gamma function, DLMF
/// 8.11.4, 8.9.2), to about 1e-14.
/// @throws ParameterError where the freedom is not above 0, or more than 300
[[nodiscard]] double chiSquareTail(double x, double freedom);

} // namespace lamella::statistics
