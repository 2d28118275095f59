#pragma once

#include "mpm/Tensor.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace lamella::mpm
{

/// Which law: what the kernels are compiled for.
enum class LawKind : std::uint8_t
{
  NeoHookean,
  Isotropic,
  Orthotropic,
  Hencky, ///< yield, and have kernels in double precision only, as all below
  Hill
};

/// What a law that yields makes of a step.
template <int Dim, class Real>
struct Flow
{
  Matrix<Dim, Real> stress; ///< Kirchhoff's, after it [Pa]
  bool any;                 ///< whether the point has flowed, or a lane's
};

/// What a plane takes the third direction for. Space has no choice.
enum class PlaneState
{
  Stress, ///< free: no stress along it
  Strain  ///< held: no strain along it
};

/// The law of every phase, seen one point at a time. F by rows, `axis` the wall's direction at the start (unit vector).
template <int Dim>
class PointLaw
{
public:
  virtual ~PointLaw() = default;
  [[nodiscard]] virtual LawKind kind() const noexcept = 0;
  [[nodiscard]] virtual int history() const noexcept = 0; ///< numbers a point remembers beside F
  [[nodiscard]] virtual std::size_t phases() const noexcept = 0;
  /// Constants of a phase: what the law's templates take.
  [[nodiscard]] virtual const double* constants(std::size_t phase) const noexcept = 0;
  [[nodiscard]] virtual int constantsCount() const noexcept = 0;
  /// Kirchhoff stress τ [Pa].
  /// @param history what the point remembers: history() numbers, here and below
  [[nodiscard]] virtual Matrix<Dim> kirchhoff(
    std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history = nullptr) const = 0;
  /// Kirchhoff stress along a plane's third direction [Pa]; 0 in plane stress, and in space, where kirchhoff() has it.
  [[nodiscard]] virtual double thirdStress(
    std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history = nullptr) const = 0;
  /// Stretch along a plane's third direction that belongs to F: det F times it is the volume over that at the start. 1
  /// of elastic laws, and in space.
  [[nodiscard]] virtual double thirdStretch(const double* history = nullptr) const = 0;
  /// Equivalent plastic strain, all that has flowed added up; 0 of elastic laws.
  [[nodiscard]] virtual double plasticStrain(const double* history = nullptr) const = 0;
  /// Work that flow has taken, over initial volume [J/m³]; 0 of elastic laws.
  [[nodiscard]] virtual double plasticWork(const double* history = nullptr) const = 0;
  /// Elastic energy over initial volume [J/m³].
  [[nodiscard]] virtual double energy(
    std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history = nullptr) const = 0;
  /// What bounds the time step [Pa]; see NeoHookean.h.
  [[nodiscard]] virtual double stiffness(
    std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history = nullptr) const = 0;
  /// After F was updated, before the stress: what flows; nothing for elastic laws.
  virtual void flow(std::size_t phase, Matrix<Dim>& F, const Vector<Dim>& axis, double* history) const = 0;
};

/// A law of templates, as described in NeoHookean.h, with its constants by phase.
template <int Dim, class Law>
class PointLawOf final : public PointLaw<Dim>
{
public:
  using Constants = std::array<double, Law::constants>;
  PointLawOf(std::vector<Constants> byPhase, PlaneState plane)
    : byPhase_(std::move(byPhase))
    , plane_(plane)
  {
  }
  [[nodiscard]] LawKind kind() const noexcept override { return Law::kind; }
  [[nodiscard]] int history() const noexcept override { return Law::history; }
  [[nodiscard]] std::size_t phases() const noexcept override { return byPhase_.size(); }
  [[nodiscard]] const double* constants(std::size_t phase) const noexcept override
  {
    return byPhase_[byPhase_.size() == 1 ? 0 : phase].data();
  }
  [[nodiscard]] int constantsCount() const noexcept override { return Law::constants; }
  [[nodiscard]] Matrix<Dim> kirchhoff(std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis,
    [[maybe_unused]] const double* history) const override
  {
    if constexpr (Law::history > 0)
      return Law::kirchhoff(constants(phase), F, axis, history);
    else
      return Law::template kirchhoff<Dim, double>(constants(phase), F, axis);
  }
  [[nodiscard]] double thirdStress(
    std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis, const double* history) const override
  {
    if constexpr (Dim == 3)
      return 0;
    else if constexpr (Law::history > 0)
      return Law::thirdStress(constants(phase), F, axis, history);
    else
      return plane_ == PlaneState::Strain ? Law::thirdStress(constants(phase), F, axis) : 0;
  }
  [[nodiscard]] double thirdStretch(const double* history) const override
  {
    if constexpr (Dim == 2 && Law::history > 0)
      return Law::thirdStretch(history);
    else
      return 1;
  }
  [[nodiscard]] double plasticStrain([[maybe_unused]] const double* history) const override
  {
    if constexpr (Law::history > 0)
      return history[Law::plasticStrain];
    else
      return 0;
  }
  [[nodiscard]] double plasticWork([[maybe_unused]] const double* history) const override
  {
    if constexpr (Law::history > 0)
      return history[Law::plasticWork];
    else
      return 0;
  }
  [[nodiscard]] double energy(std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis,
    [[maybe_unused]] const double* history) const override
  {
    if constexpr (Law::history > 0)
      return Law::energy(constants(phase), F, axis, history);
    else
      return Law::template energy<Dim, double>(constants(phase), F, axis);
  }
  [[nodiscard]] double stiffness(std::size_t phase, const Matrix<Dim>& F, const Vector<Dim>& axis,
    [[maybe_unused]] const double* history) const override
  {
    if constexpr (Law::history > 0)
      return Law::stiffness(constants(phase), F, axis, history);
    else
      return Law::template stiffness<Dim>(constants(phase), F, axis);
  }
  void flow(std::size_t phase, Matrix<Dim>& F, const Vector<Dim>& axis, double* history) const override
  {
    if constexpr (Law::history > 0)
      Law::flow(constants(phase), F, axis, history);
    else
      (void)phase, (void)F, (void)axis, (void)history;
  }

private:
  std::vector<Constants> byPhase_;
  PlaneState plane_;
};

/// @param byPhase constants of each phase, of phase 0 (even if it is empty) first; a single set is that of all phases
/// @param plane that the constants are of: it tells the third stress of elastic laws. Laws with a history have plane
/// strain only
template <int Dim, class Law>
[[nodiscard]] std::shared_ptr<const PointLaw<Dim>> makeLaw(
  std::vector<std::array<double, Law::constants>> byPhase, PlaneState plane = PlaneState::Stress)
{
  return std::make_shared<PointLawOf<Dim, Law>>(std::move(byPhase), plane);
}

} // namespace lamella::mpm
