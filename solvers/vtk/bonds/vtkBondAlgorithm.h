/**
 * @class   vtkBondAlgorithm
 * @brief   what bonds a sample has: the settings that peridynamic solvers and filters share
 *
 * Bonds join every node to all nodes within the horizon. What a bond is made of depends on the phases of its two ends.
 *
 * **Pairs** are written as "grain" (bonds within that phase), "matrix-grain" (between two phases; the order does not
 * matter) and "grain-grain" (between two *different grains* of one phase; the image then needs the point array `grain`
 * with the number of each node's grain, 0 for none). Phases go by the image's `phase_names`, or by number where it has
 * none. Pairs that the image does not have are ignored, so that one list serves many images.
 *
 * **Materials**: each pair needs Young's modulus, and may have one of fracture energy Gc, toughness K or critical
 * stretch s0; without, its bonds never break. Phases that touch need a material for the pair of them: of its own, like
 * another pair's (SetLike), or by a rule (SetMixing); else the update fails and names the pair.
 *
 * **Voids** carry no bonds: the phases of AddVoid(), or without any those called void, pore, lumen, air or 0 that no
 * table names.
 *
 * Poisson's ratio is that of bonds: 1/3 in plane stress, 1/4 in plane strain and in space.
 *
 * @sa vtkBondEquilibrium, vtkBondStiffness, vtkBondStress
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSampleAlgorithm.h"

#include <memory> // for std::unique_ptr
#include <string> // for members

class vtkImageData;

namespace lamella
{
struct BondSettings;
class Team;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkBondAlgorithm : public vtkSampleAlgorithm
{
public:
  vtkTypeMacro(vtkBondAlgorithm, vtkSampleAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Young's modulus, one pair of phases a row. grain: bonds within that phase. matrix-grain: bonds between the two.
   * grain-grain: bonds between two different grains. In Pa, positive. Names that the image does not know do no harm,
   * nor does an empty row.
   * @word young
   * @title Young's modulus of bonds [Pa]
   * @group Materials
   * @columns Bonds, Young's modulus [Pa]
   */
  void SetYoungsModulus(const char* pair, double value);
  void RemoveAllYoungsModuli();
  ///@}

  ///@{
  /**
   * Fracture energy of the bonds of a pair [J/m^2], positive. Give one of fracture energy, toughness and critical
   * stretch, or none: they then never break.
   * @title Fracture energy of bonds [J/m²]
   * @group Materials
   * @columns Bonds, Fracture energy [J/m²]
   * @advanced
   */
  void SetFractureEnergy(const char* pair, double value);
  void RemoveAllFractureEnergies();
  ///@}
  ///@{
  /**
   * Toughness of the bonds of a pair [Pa m^(1/2)], instead of the fracture energy.
   * @title Toughness of bonds [Pa √m]
   * @group Materials
   * @columns Bonds, Toughness [Pa √m]
   */
  void SetToughness(const char* pair, double value);
  void RemoveAllToughnesses();
  ///@}
  ///@{
  /**
   * Elongation over length at which bonds of a pair break, instead of the fracture energy.
   * @title Critical stretch of bonds
   * @group Materials
   * @columns Bonds, Critical stretch
   */
  void SetCriticalStretch(const char* pair, double value);
  void RemoveAllCriticalStretches();
  ///@}

  ///@{
  /**
   * Bonds of the first pair are like those of the second, in stiffness and in fracture, but for what they have of their
   * own.
   * @title Bonds that are like others
   * @group Materials
   * @columns Bonds, Like
   * @advanced
   */
  void SetLike(const char* pair, const char* other);
  void RemoveAllLikes();
  ///@}

  /**
   * A pair whose values are in SI units while all others are multiples of its: grain 4 relative to matrix is four
   * times the matrix's. Empty: all are in SI units.
   * @group Materials
   * @advanced
   */
  vtkSettingMacro(RelativeTo, std::string, "");

  enum Mixings
  {
    NO_MIXING = 0, ///< "None: an error"
    HARMONIC = 1,  ///< two half bonds in series; it breaks when the first half does
    MINIMUM = 2    ///< "Minimum: the lesser of both": the lesser E and the lesser s0
  };
  /**
   * Material of bonds between two phases that have none of their own.
   * @group Materials
   * @choice Mixings
   */
  vtkSettingMacro(Mixing, int, NO_MIXING);

  enum Continua
  {
    AUTO_CONTINUUM = 0, ///< "Automatic: plane stress or space": plane stress for pictures, space for volumes
    PLANE_STRESS = 1,
    PLANE_STRAIN = 2,
    SPACE = 3
  };
  /**
   * Automatic: plane stress for pictures, space for volumes.
   * @group Bonds
   * @choice Continua
   */
  vtkSettingMacro(Continuum, int, AUTO_CONTINUUM);

  /**
   * Length of the longest bonds, in spacings. 3 is usual; cost grows with its square. Below 3 the lattice is markedly
   * stiffer along its axes, unless its micromodulus is isotropic; below √2 that cannot be.
   * @group Bonds
   * @range [1, 8]
   */
  vtkSettingMacro(Horizon, double, 3);

  enum Micromoduli
  {
    AUTO_MICROMODULUS = -1, ///< "Automatic": isotropic in volumes and for an effective stiffness, else continuum
    CONTINUUM_MICROMODULUS =
      0, ///< "Continuum, as in the literature": from the integral over the horizon, as in the literature
    LATTICE_MICROMODULUS = 1, ///< "Lattice: exact along the axes": such that Young's modulus along the axes is exact in
                              ///< the bulk of this lattice
    ISOTROPIC_MICROMODULUS = 2 ///< "Isotropic: exact in every direction": by direction, such that the bulk has E and
                               ///< Poisson's ratio in every direction
  };
  /**
   * How the stiffness of bonds follows from Young's modulus. Automatic: isotropic in volumes, as in the literature in
   * pictures.
   * @group Bonds
   * @choice Micromoduli
   * @advanced
   */
  vtkSettingMacro(Micromodulus, int, AUTO_MICROMODULUS);

  /**
   * Take out bonds that cross a thin void. Off: they stay.
   * @group Bonds
   * @advanced
   */
  vtkSwitchMacro(CutVoidBonds, false);

  /**
   * Stiffer bonds near free surfaces, where nodes have fewer of them.
   * @group Bonds
   * @advanced
   */
  vtkSwitchMacro(SurfaceCorrection, false);

  /**
   * Newton's method on forces that are exact for large rotations, instead of one linear system.
   * @group Bonds
   * @advanced
   */
  vtkSwitchMacro(LargeStrains, false);

  ///@{
  /**
   * Cuts made before loading, of pictures: from a point to a point, in metres. They must touch the sample.
   *
   * In space a parallelogram, from a corner and two edges [m].
   * @word notch, notches
   * @title Notches: x1, y1, x2, y2 [m]
   * @group Bonds
   * @columns x1 [m], y1 [m], x2 [m], y2 [m]
   * @advanced
   */
  void AddNotch(double x1, double y1, double x2, double y2);
  void AddNotchInSpace(const double corner[3], const double along[3], const double across[3]);
  void RemoveAllNotches();
  ///@}

  /**
   * 1 for axes at whose end the sample begins again: x, y, z. Not the axis of loading.
   * @group Bonds
   * @columns x, y, z
   * @range [0, 1]
   * @advanced
   */
  vtkSettingVector3Macro(Periodic, int, 0, 0, 0);

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

  ///@{
  /** Output 0, or another where it is an image; else null. */
  vtkImageData* GetOutput();
  vtkImageData* GetOutput(int port);
  ///@}

protected:
  vtkBondAlgorithm();
  ~vtkBondAlgorithm() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  /// Fills the output; RequestData() makes errors of VTK of what it throws. Collective over the team.
  virtual void Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team) = 0;

  /// All of the settings above.
  lamella::BondSettings Settings() const;

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};
