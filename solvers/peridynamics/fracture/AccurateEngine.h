#pragma once

#include "peridynamics/Equilibrium.h"
#include "peridynamics/fracture/BondGraph.h"
#include "peridynamics/fracture/CrackContact.h"
#include "peridynamics/fracture/FractureEngine.h"
#include "peridynamics/fracture/PlatenForce.h"

#include <memory>

namespace lamella::peridynamics
{

/// One equilibrium to the tolerance after every break. Under a pressure it is found at the pressure of the load, and
/// scaled to that at which the pores have grown by the unit strain. Where cracks close, it is found anew until the
/// bonds that are closed are those that it presses.
class AccurateEngine final : public FractureEngine
{
public:
  /// Solves the first equilibrium.
  /// @param sample must outlive this; under a pressure pieces that come loose change its load
  /// @param contact of the bonds that break, which it is told of, and of those that were broken before; null: none,
  /// and pieces that come loose are taken out. Must outlive this
  /// @param unitStrain of the unit load
  /// @param progress of it, as EquilibriumOptions::progress; may be empty
  /// @throws DivergenceError also where contact does not come to an end
  AccurateEngine(BondLattice& bonds, LoadedSample& sample, const PlatenForce& platens, CrackContact* contact,
    double unitStrain, double tolerance, std::function<bool(double)> progress);
  /// @param resumed of another one with these bonds
  AccurateEngine(BondLattice& bonds, LoadedSample& sample, const PlatenForce& platens, CrackContact* contact,
    double unitStrain, double tolerance, const EngineState& resumed);
  ~AccurateEngine() override;

  StretchMaximum mostCritical() override;
  std::vector<Bond> critical(double ratio) override;
  void breakBonds(std::span<const Bond> bonds) override;
  void turn() override;
  bool settle(Nearness) override { return false; }
  NodeField<double> displacement() override;
  void renew() override { equilibrium_.reset(); }
  [[nodiscard]] EngineState state() const override;
  [[nodiscard]] double force() const override { return force_; }
  [[nodiscard]] bool holds() const override { return holds_; }

private:
  void prepare();
  void solve();
  void solveOnce();
  /// Likewise, with the bonds closed that it presses.
  void solveContact();
  /// Does a piece, with what is pressed to it, reach from platen to platen?
  [[nodiscard]] bool reaches() const;
  /// What follows from displacements at equilibrium.
  void measure();
  /// Do the ends of all these (broken) bonds still have a neighbour in common?
  [[nodiscard]] bool joined(std::span<const Bond> bonds) const;
  void takeOutLoosePieces();

  BondLattice& bonds_;
  LoadedSample& sample_;
  PlatenForce platens_;
  CrackContact* contact_;
  double unitStrain_;
  double tolerance_;
  BondGraph graph_;
  NodeField<double> u_;
  double scale_ = 1; ///< of u to what it is at unit load; not 1 under a pressure
  double force_ = 0;
  double largestForce_ = 0; ///< so far, where there is contact
  double evenForce_ = 0;    ///< likewise, of the sample as it was first, under even strain
  bool holds_ = true;
  std::int64_t loose_ = 0;     ///< nodes, at the last search
  std::int64_t usual_ = 0;     ///< iterations of a break with a fresh preconditioner
  bool fresh_ = true;          ///< no break yet that the preconditioner does not know of
  EquilibriumOptions first_{}; ///< of the first equilibrium
  std::unique_ptr<Equilibrium> equilibrium_;
};

} // namespace lamella::peridynamics
