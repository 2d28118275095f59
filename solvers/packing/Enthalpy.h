#pragma once

#include "packing/BlockCholesky.h"
#include "packing/Relaxation.h"

#include <cstddef>
#include <cstdint>
#include <vector>

/// Internal: the enthalpy U + pV of frictionless grains, its slope and its second derivatives.
namespace lamella::packing
{

/// Normal force by overlap, in units of the stiffness: the overlap or 0; or, smoothed, that branch of the hyperbola
/// f (f − overlap) = smoothing which is never negative, less what it is at the end of its reach. A force then fades
/// over gaps of about √smoothing, or smoothing over the force, as that of a logarithmic barrier.
struct ContactLaw
{
  static constexpr double reach = 0.05; ///< gap at which a smoothed force ends [diameters]
  double smoothing = 0;
  double atReach = 0;

  explicit ContactLaw(double smoothed)
    : smoothing(smoothed)
    , atReach(smoothed > 0 ? hyperbola(-reach) : 0)
  {
  }
  [[nodiscard]] double hyperbola(double overlap) const
  {
    const double root = std::sqrt(overlap * overlap + 4 * smoothing);
    return overlap > 0 ? 0.5 * (overlap + root) : 2 * smoothing / (root - overlap);
  }
  [[nodiscard]] bool acts(double overlap) const { return overlap > (smoothing > 0 ? -reach : 0); }
  /// Where it acts.
  [[nodiscard]] double force(double overlap) const { return smoothing > 0 ? hyperbola(overlap) - atReach : overlap; }
  [[nodiscard]] double slope(double overlap) const
  {
    return smoothing > 0 ? hyperbola(overlap) / std::sqrt(overlap * overlap + 4 * smoothing) : 1;
  }
};

/// Unknowns: Dim a grain, then the logarithms of the box's edges (one for all with BoxMotion::Volume).
template <int Dim>
class Enthalpy
{
public:
  using Vec = typename GrainSystem<Dim>::Vec;

  /// Both have to outlive it. The list of pairs is kept long enough for the law's reach.
  Enthalpy(GrainSystem<Dim>& grains, const RelaxationOptions& options);
  ~Enthalpy();
  Enthalpy(const Enthalpy&) = delete;
  Enthalpy& operator=(const Enthalpy&) = delete;

  [[nodiscard]] Eigen::Index size() const { return firstOfBox() + boxUnknowns_; }
  /// Forces of the state as it is.
  void evaluate();
  /// Downhill, by the last evaluate().
  [[nodiscard]] const Eigen::VectorXd& force() const { return force_; }
  /// As GrainSystem::unbalanced(), by the last evaluate().
  [[nodiscard]] double unbalanced() const;
  [[nodiscard]] double pressureError() const;
  void move(const Eigen::VectorXd& step);

  /// Second derivatives, by the last evaluate(), as they are at rest: without the net force that a grain and the box
  /// have in common. Which grains are linked changes seldom, see linksChanged().
  const BlockMatrix<Dim>& hessian();
  /// By the last call of hessian().
  [[nodiscard]] bool linksChanged() const { return linksChanged_; }
  [[nodiscard]] Eigen::Index boxUnknowns() const { return boxUnknowns_; }

private:
  using Square = Eigen::Matrix<double, Dim, Dim>;
  static constexpr double nearby = 0.02; ///< gap at which grains are linked although they do not touch [diameters]

  [[nodiscard]] Eigen::Index firstOfBox() const { return Dim * static_cast<Eigen::Index>(g_.count()); }
  [[nodiscard]] double widest() const { return law_.smoothing > 0 ? ContactLaw::reach : 0; }
  [[nodiscard]] Square onBox(const Vec& r, const Square& k) const;
  void makeLinks();
  bool addGrains();
  void addWalls();
  void addToCorner(const Vec& r, const Square& g);
  void addBox();

  GrainSystem<Dim>& g_;
  const RelaxationOptions& options_;
  ContactLaw law_;
  int boxUnknowns_;
  Eigen::VectorXd force_;
  Vec virial_ = Vec::Zero();
  double forceSum_ = 0;
  std::int64_t contacts_ = 0;
  BlockMatrix<Dim> matrix_;
  std::vector<std::int32_t> linkOf_; ///< by pair; −1: none
  std::int64_t version_ = -1;        ///< of the list of pairs
  bool linksChanged_ = false;
};

extern template class Enthalpy<2>;
extern template class Enthalpy<3>;

} // namespace lamella::packing
