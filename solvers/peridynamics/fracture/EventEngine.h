#pragma once

#include "peridynamics/fracture/FractureEngine.h"
#include "peridynamics/fracture/LoosePieces.h"
#include "peridynamics/fracture/StretchTiles.h"

namespace lamella::peridynamics
{

/// A break disturbs little but its surroundings: bond by bond, corrections on nested windows, and the whole lattice
/// only before the load rises and now and then in an avalanche.
///
/// On several ranks each holds all the bonds and breaks them alike; they share out global corrections and the search
/// that follows these, and come to the same to the last bit as one rank.
class EventEngine final : public FractureEngine
{
public:
  /// Solves the first equilibrium.
  /// @param bonds the whole lattice
  /// @param parts of the ranks of its communicator, who call all this together: loses the same bonds; or, on one rank,
  /// null
  /// @param progress of it, as EquilibriumOptions::progress; may be empty
  EventEngine(BondLattice& bonds, BondLattice* parts, const LoadedSample& sample, const PlatenForce& platens,
    const EventOptions& options, double tolerance, const std::function<bool(double)>& progress);
  /// @param resumed of another one with these bonds
  EventEngine(BondLattice& bonds, BondLattice* parts, const LoadedSample& sample, const PlatenForce& platens,
    const EventOptions& options, double tolerance, const EngineState& resumed);

  StretchMaximum mostCritical() override;
  std::vector<Bond> critical(double ratio) override;
  void breakBonds(std::span<const Bond> bonds) override;
  void turn() override; ///< @throws std::logic_error
  bool settle(Nearness nearness) override;
  NodeField<double> displacement() override;
  void renew() override;
  [[nodiscard]] EngineState state() const override;
  [[nodiscard]] double force() const override { return force_; }
  [[nodiscard]] bool holds() const override { return pieces_.holds(); }

private:
  void breakBond(const Bond& bond);
  double takeOut(std::int64_t index, int offset); ///< @return k/|ξ|
  /// Unless that is what the state is already.
  bool correct(double tolerance);
  [[nodiscard]] double toleranceOf(Nearness nearness) const noexcept;
  [[nodiscard]] std::int64_t indexOf(const Bond& bond) const;
  [[nodiscard]] Box boxOf(const Bond& bond) const;
  void takeOut(const std::vector<std::int64_t>& nodes);
  /// In the plane: relaxes a wide window around all that has broken since the last correction.
  void correctAround();
  [[nodiscard]] bool rivals(const StretchMaximum& most, double margin) const;
  void afterGlobal(int iterations, double start);
  void refine(); ///< the first equilibrium, where the tolerance may leave too much of the force
  [[nodiscard]] double carried(const LoadedSample& sample) const; ///< as FractureRecord::carried
  void measure();                                                 ///< what follows from the state in one go

  BondLattice& bonds_;
  BondLattice* parts_;
  PlatenForce platens_;
  EventOptions options_;
  double tolerance_;
  EventHierarchy state_;
  StretchTiles tiles_;
  LoosePieces pieces_;
  int radius_;
  int coarseRadius_;
  bool wide_; ///< are wide windows corrected in between?
  double force_ = 0;
  double workOverForce_ = 0; ///< at unit load, of twice the elastic energy: both are in proportion to the stiffness
  int sinceGlobal_ = 0;      ///< events
  int sinceWide_ = 0;        ///< events since the last correction of a wide window or of the whole lattice
  Box broken_;               ///< around these
  double target_ = 0;        ///< of the last local correction
  int littles_ = 0;          ///< corrections that changed little since all bonds were looked at
  double reached_ = 1;       ///< tolerance of the last global correction
  double rise_ = 0;          ///< tolerance before a rise
  std::int64_t searchesBefore_ = 0; ///< that another engine made
};

} // namespace lamella::peridynamics
