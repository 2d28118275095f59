#pragma once

namespace lamella::peridynamics
{

/// The loading rate that gives way to what breaks: the second paper's equations A1 and A2,
/// ω̇ = −ω/τ + the energy of the bonds that break,  Γ̇ = −(Γ − Γ₀ exp(−ω/ω₀))/τ.
/// Both are linear between breaks but for the exponential, which is held over a step of τ/100 at most.
class RegulatedRate
{
public:
  /// @param relaxation τ [s]
  /// @param reference ω₀: the energy that opens a crack of Δℓ in mode I in the weakest phase, Gc Δℓ in the plane [J/m],
  /// Gc Δℓ² in space [J]; Δℓ below 1 % of the sample
  /// @param start Γ at the start over Γ₀
  /// @throws ParameterError: values that are not positive and finite; a start outside 0 … 1
  RegulatedRate(double relaxation, double reference, double start = 0);

  /// Goes on by a step in which bonds broke that held so much energy [J], [J/m].
  void advance(double step, double brokenEnergy);
  [[nodiscard]] double rate() const noexcept { return rate_; }     ///< Γ/Γ₀
  [[nodiscard]] double damage() const noexcept { return damage_; } ///< ω [J], [J/m]
  [[nodiscard]] double relaxation() const noexcept { return relaxation_; }
  [[nodiscard]] double reference() const noexcept { return reference_; } ///< ω₀ [J], [J/m]
  /// Goes on from what another one reached.
  void set(double rate, double damage) noexcept
  {
    rate_ = rate;
    damage_ = damage;
  }

private:
  double relaxation_;
  double reference_;
  double rate_;
  double damage_ = 0;
};

} // namespace lamella::peridynamics
