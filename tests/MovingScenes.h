#pragma once

#include "lattice/Lattice.h"
#include "peridynamics/fracture/Dynamics.h"
#include "peridynamics/fracture/SideLoads.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

/// Samples in motion as published experiments have them.
namespace lamella::peridynamics
{

/// All that a run of BondDynamics starts from; at rest but for what is moved.
struct MovingScene
{
  Lattice lattice;
  std::vector<std::uint8_t> phase; ///< of the whole lattice
  BondModel model;
  double density = 1000; ///< [kg/m³]
  std::vector<SideTraction> tractions;
  std::vector<MovedNodes> moved;
  double duration = 0;                     ///< [s]
  double horizon = 0;                      ///< h [m]
  std::vector<std::array<double, 2>> tips; ///< of the notches: x, y [m]
};

/// A notched glass plate, pulled at once by its long sides: the crack starts, and branches. Plane stress. Phase 2,
/// three horizons along the loaded sides, never breaks. Bobaru and Zhang, Int. J. Fract. 196 (2015) 59; the numbers are
/// those of Ha and Bobaru, Int. J. Fract. 162 (2010) 229, and of CabanaPD and PDMATLAB2D.
struct BranchingPlate
{
  double horizon = 1e-3; ///< h [m]
  double ratio = 4;      ///< h/δx
  double traction = 2e6; ///< σ on both long sides [Pa]
  double length = 0.1;   ///< [m]
  double height = 0.04;  ///< [m]
  double notch = 0.05;   ///< from the left side, at mid-height [m]
  double duration = 43e-6;
};
/// An even number of layers: the notch runs between two of them.
/// @throws ParameterError: lengths that are not positive, a plate thinner than what is loaded and cannot break
[[nodiscard]] MovingScene branchingPlate(const BranchingPlate& plate);

/// A steel plate with two notches, struck on the edge between them: Kalthoff and Winkler, 1987. Cracks leave the
/// notches at about 70°. Plane strain. The struck nodes keep their velocity along the notches and are free across: a
/// projectile of the same steel at twice the speed.
struct KalthoffWinkler
{
  double horizon = 2e-3; ///< h [m]
  double ratio = 4;      ///< h/δx
  double speed = 16;     ///< of the struck edge [m/s]
  double duration = 90e-6;
};
[[nodiscard]] MovingScene kalthoffWinkler(const KalthoffWinkler& plate);

/// The bonds of a scene and their motion.
class SceneInMotion
{
public:
  /// @param options its density is the scene's
  /// @param comm must outlive this
  /// @throws as BondLattice, BondDynamics, tractionLoad() and imposeMotion()
  SceneInMotion(const MovingScene& scene, DynamicsOptions options, const Communicator& comm);
  SceneInMotion(const SceneInMotion&) = delete;
  SceneInMotion& operator=(const SceneInMotion&) = delete;

  [[nodiscard]] const BondLattice& bonds() const noexcept { return bonds_; }
  [[nodiscard]] BondDynamics& motion() noexcept { return *motion_; }

private:
  BondLattice bonds_;
  std::unique_ptr<BondDynamics> motion_;
};

} // namespace lamella::peridynamics
