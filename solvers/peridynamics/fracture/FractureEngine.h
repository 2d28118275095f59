#pragma once

#include "peridynamics/BondForces.h"
#include "peridynamics/fracture/Fracture.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace lamella::peridynamics
{

/// All that FractureEngine::renew() leaves, beside the bonds.
struct EngineState
{
  NodeField<double> displacement; ///< at unit load [m]
  std::map<std::string, double> numbers;
  FractureStatistics statistics;
};

/// How near an equilibrium is to be.
enum class Nearness
{
  Avalanche, ///< as good as the method has it while bonds break by themselves
  Softening, ///< before the load rises where the stress cannot be the largest so far
  Exact      ///< as good as the method has it at all
};

/// The state at unit load, and how it follows the breaks. All members are collective.
class FractureEngine
{
public:
  virtual ~FractureEngine() = default;

  /// The bond that is nearest to its critical elongation.
  virtual StretchMaximum mostCritical() = 0;
  /// All bonds with s/s₀ of at least this, in order; the same on every rank.
  virtual std::vector<Bond> critical(double ratio) = 0;
  /// Takes bonds out, and pieces that come loose with them; then equilibrium, as near as the method goes by itself.
  virtual void breakBonds(std::span<const Bond> bonds) = 0;
  /// The same load the other way round: equilibrium under it. AccurateEngine only.
  virtual void turn() = 0;
  /// @return whether anything was left to do
  virtual bool settle(Nearness nearness) = 0;
  /// To a tolerance, then displacements at unit load.
  virtual NodeField<double> displacement() = 0;
  /// Drops all that is only there to save work, so that what follows depends on the bonds and on state() alone.
  virtual void renew() = 0;
  /// After renew().
  [[nodiscard]] virtual EngineState state() const = 0;

  /// Force on the platens [N], [N/m] in the plane, positive along the loading.
  [[nodiscard]] virtual double force() const = 0;
  /// Does a piece still reach from platen to platen?
  [[nodiscard]] virtual bool holds() const = 0;

  [[nodiscard]] const FractureStatistics& statistics() const noexcept { return statistics_; }

protected:
  FractureStatistics statistics_;
};

} // namespace lamella::peridynamics
