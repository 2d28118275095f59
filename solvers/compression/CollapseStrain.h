#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace lamella::compression
{

/// At which strain each lumen collapses: where its area over that at the start first falls below a share, linear
/// between states. Before the first state all lumens are whole, at strain 0.
class CollapseStrain
{
public:
  /// @throws ParameterError: a share outside 0 to 1
  explicit CollapseStrain(std::size_t lumens, double share = 0.5);

  /// One state more. @param ratio area over that at the start, by lumen; NaN: not known
  /// @throws InputError: a strain that is not finite or not above that of the state before
  void add(double strain, std::span<const double> ratio);

  /// By lumen; NaN: it did not collapse.
  [[nodiscard]] std::span<const double> strain() const noexcept { return strain_; }
  /// Area over that at the start in the last state, by lumen.
  [[nodiscard]] std::span<const double> ratio() const noexcept { return ratio_; }
  [[nodiscard]] std::size_t collapsed() const noexcept { return collapsed_; } ///< lumens so far

private:
  double share_;
  double last_ = 0;
  std::size_t states_ = 0;
  std::size_t collapsed_ = 0;
  std::vector<double> strain_;
  std::vector<double> ratio_;
};

} // namespace lamella::compression
