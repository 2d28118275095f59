/**
 * @class   vtkVoxelStiffness
 * @brief   effective stiffness of an image of phases by elements, with its error; stresses under a mean load
 *
 * Each point of the image becomes one bilinear (of volumes trilinear) element of its phase's material, as large as the
 * spacing; the fields are found by conjugate gradients preconditioned by geometric multigrid without any matrix
 * (elasticity/ElasticSystem.h, elasticity/VoxelStiffness.h).
 *
 * **Voigt's notation**: stresses and strains xx, yy, xy of a picture; xx, yy, zz, yz, xz, xy of a volume; shear strains
 * are angles, 2ε, but in the output's array `strain`.
 *
 * **Input**: vtkImageData with phases at its points, or greys as Shares has them; for phases that are stiffer along an
 * axis also its direction (array `axis`, index 1, 2 or 3 components of any length). With a ChangeArray that point
 * array.
 *
 * **Output 0**: the input, with the numbers as field data; of a load also, as floats,
 * - `displacement` [m], 3 components, from the image's middle; `stress` [Pa] and `strain` (tensor components) with six,
 *   XX, YY, ZZ, XY, YZ, XZ; all are means over the point's element, 0 in voids. Across a picture's plane ZZ of the
 *   strain in plane stress, of the stress in plane strain: NaN of a tensor of the plane alone and of points that two
 *   solids share
 * **Output 1**, tensor: one row a stress: `stress` (its name), then for each strain `xx` … [Pa], `extrapolated_xx` …,
 * `error_xx` … (NaN where they are not known).
 * **Output 2**, constants: one row each: `constant` (E_x, …, nu_xy, …, G_xy: those under stress along one direction,
 * from the inverse), `value`, `extrapolated`, `error`, `unit` (Pa or 1).
 * **Output 3**, directions: vtkPolyData, of volumes a closed surface and of pictures a closed line whose distance from
 * the origin is Young's modulus in that direction over the largest, with point arrays `direction`, `youngs_modulus`
 * [Pa] and, of all directions across it, `shear_modulus_least`, `shear_modulus_most` [Pa], `poissons_ratio_least` and
 * `poissons_ratio_most`; of pictures, where there is one across, `shear_modulus` and `poissons_ratio`.
 *
 * **Field data** of all outputs:
 * - `stiffness`, `stiffness_extrapolated`, `stiffness_error`, `stiffness_voigt`, `stiffness_reuss`: 9 or 36 numbers by
 *   rows [Pa], empty where the tensor was not wanted; the last two are the bounds by uniform strain and uniform stress
 * - `stiffness_components`; `stiffness_asymmetry`: of the tensor as solved, relative
 * - `estimated_error`: the largest relative error on the diagonal; NaN when not known
 * - `constant_names`, `constants`, `constants_extrapolated`, `constants_error`, `eigenvalues`, `resisting`: as
 *   vtkBondStiffness
 * - `isotropic_part`: bulk and shear modulus, Young's modulus [Pa], Poisson's ratio, and the share of the tensor's norm
 *   that is left; `orthotropic_part`: the same tensor's part in the axes in which it leaves least, by rows,
 *   `orthotropic_axes`: these, 9 numbers, one axis after the other, `orthotropic_rest`: the share left
 * - `extremes`: Young's modulus, shear modulus [Pa] and Poisson's ratio over all directions, of each the least and the
 *   most; `extreme_directions`, `extreme_across`: where, three numbers of each
 * - where EstimateWindowError is on and the box can be cut: `window_of`, names of components of the diagonal and of
 *   constants, and in their order `window_errors`, how far the material's value may be from the box's (95 %), relative;
 *   `window_value`, `window_low`, `window_high`, `window_deviation`, `window_bias` in the value's unit,
 * `window_freedom`, `window_gradient` (axis along which the box changes, NaN: none) and `window_layered`
 * (statistics/WindowError.h)
 * - with ComputeSensitivity `material_numbers`: names PROPERTY:PHASE of the phases' constants ("young:wall"; as the
 *   words of their settings), `material_values`, `material_uncertainty` (0: none), and by these in turn
 *   `stiffness_sensitivity`, ∂C/∂p, 9 or 36 numbers each, and `constants_sensitivity`, the same of `constants`; of a
 * mean strain alone `load_energy_sensitivity` [J/m³]. Of rigid phases and of given tensors nothing is told
 * - with uncertainties `constants_input_error`: what they leave of each constant, in its unit
 * - with EstimateSegmentationError `surface_doubt` [pixels], `surface_pairs`: names A:B of phases that meet, and by
 * these in turn `stiffness_surface_sensitivity`, 9 or 36 numbers each, and `constants_surface_sensitivity`: the change
 * where A grows into B by a pixel; `constants_segmentation_error`: what the doubt leaves of each constant, in its unit,
 *   levels between phases being independent
 * - with one of these or of EstimateWindowError `constants_total_error`: the root of the squares of both, of
 *   `constants_error` and of the window's, where two are known
 * - `hashin_shtrikman`: bulk modulus, lower and upper, shear modulus, lower and upper [Pa], of isotropic mixtures;
 * where all phases are isotropic
 * - `expansion`: mean strain of the free box for a change of 1, Voigt's order; where some phase expands
 * - of a load `load_strain`, `load_stress` (means), `load_energy` [J/m³], `load_iterations`
 * - `crosses`, `pieces`, `loose_pieces`, `loose_nodes`, `solid_nodes`, `skipped_nodes`, `seam_mismatch`,
 *   `layer_mismatch`, `step_every`, `step_pictures`, `step_nodes`, `step_iterations`, `step_seconds`, `iterations`: as
 *   vtkBondStiffness
 * - `solver_error`: of energies, relative; `levels`, `bytes`, `seconds` (set-up, solve, the load, the error,
 *   the sensitivity)
 * - `phase_names`, `phase_fraction`, `phase_array`, `sides`, `continuum`, `element_model`, `warnings`, `provenance`.
 *
 * **Parallel**: ranks share the planes of nodes across the last axis, threads those of a rank; any number of both gives
 * the same bits. Every rank holds the picture. The first one has the numbers; arrays come in pieces.
 *
 * @sa vtkBondStiffness, vtkPointStiffness, vtkStressPDF
 */

#pragma once

#include "vtkLamellaSolversVTKModule.h" // for export macro
#include "vtkSampleAlgorithm.h"

#include <memory> // for std::unique_ptr

class vtkImageData;
class vtkPolyData;
class vtkTable;

namespace lamella
{
class Team;
}

class VTKLAMELLASOLVERSVTK_EXPORT vtkVoxelStiffness : public vtkSampleAlgorithm
{
public:
  static vtkVoxelStiffness* New();
  vtkTypeMacro(vtkVoxelStiffness, vtkSampleAlgorithm);

  ///@{
  /**
   * Young's modulus, one phase a row; of a phase that has one across its axis too, the one along. In Pa, positive.
   * Names that the image does not know do no harm, nor does an empty row.
   * @word young
   * @title Young's modulus of phases [Pa]
   * @group Materials
   * @columns Phase, Young's modulus [Pa]
   */
  void SetYoungsModulus(const char* phase, double value);
  void RemoveAllYoungsModuli();
  ///@}
  ///@{
  /**
   * Poisson's ratio, above -1 and below 1/2 (in plane stress 1), 0.3 for phases without; with an axis contraction
   * across it, pulled along it.
   * @word poisson
   * @title Poisson's ratio of phases
   * @group Materials
   * @columns Phase, Poisson's ratio
   */
  void SetPoissonsRatio(const char* phase, double value);
  void RemoveAllPoissonsRatios();
  ///@}
  ///@{
  /**
   * Of phases that are stiffer or softer along an axis (the wall, the grain): Young's modulus across it [Pa]. The image
   * says at every point where the axis leads, as Micrograph Lattice does.
   * @word young-across
   * @title Young's modulus of phases across their axis [Pa]
   * @group Materials
   * @columns Phase, Young's modulus [Pa]
   * @advanced
   */
  void SetYoungsModulusAcross(const char* phase, double value);
  void RemoveAllYoungsModuliAcross();
  ///@}
  ///@{
  /**
   * Of such phases: Poisson's ratio among the directions across the axis; 0.3 for those without.
   * @word poisson-across
   * @title Poisson's ratio of phases across their axis
   * @group Materials
   * @columns Phase, Poisson's ratio
   * @advanced
   */
  void SetPoissonsRatioAcross(const char* phase, double value);
  void RemoveAllPoissonsRatiosAcross();
  ///@}
  ///@{
  /**
   * Of such phases: shear modulus in planes that hold the axis [Pa]; for those without 1/G = 1/E along + 1/E across +
   * 2 ν/E along.
   * @word shear
   * @title Shear modulus of phases along their axis [Pa]
   * @group Materials
   * @columns Phase, Shear modulus [Pa]
   * @advanced
   */
  void SetShearModulus(const char* phase, double value);
  void RemoveAllShearModuli();
  ///@}
  ///@{
  /**
   * How far a Young's modulus may be off, one phase a row [Pa]: half of the interval that holds it 19 times out of 20.
   * The output then tells what that leaves of the moduli of the box, and ComputeSensitivity is on. Independent of each
   * other.
   *
   * `phase` is the word that SetYoungsModulus() was given.
   * @word young-uncertainty
   * @uncertainty young
   * @title Uncertainty of Young's moduli [Pa]
   * @group Materials
   * @columns Phase, Plus or minus [Pa]
   * @advanced
   */
  void SetYoungsModulusUncertainty(const char* phase, double value);
  void RemoveAllYoungsModulusUncertainties();
  ///@}
  ///@{
  /**
   * The same of Poisson's ratios, of phases that were given one.
   * @word poisson-uncertainty
   * @uncertainty poisson
   * @title Uncertainty of Poisson's ratios
   * @group Materials
   * @columns Phase, Plus or minus
   * @advanced
   */
  void SetPoissonsRatioUncertainty(const char* phase, double value);
  void RemoveAllPoissonsRatioUncertainties();
  ///@}
  ///@{
  /**
   * The same of Young's moduli across an axis [Pa].
   * @word young-across-uncertainty
   * @uncertainty young-across
   * @title Uncertainty of Young's moduli across axes [Pa]
   * @group Materials
   * @columns Phase, Plus or minus [Pa]
   * @advanced
   */
  void SetYoungsModulusAcrossUncertainty(const char* phase, double value);
  void RemoveAllYoungsModulusAcrossUncertainties();
  ///@}
  ///@{
  /**
   * The same of Poisson's ratios across an axis, of phases that were given one.
   * @word poisson-across-uncertainty
   * @uncertainty poisson-across
   * @title Uncertainty of Poisson's ratios across axes
   * @group Materials
   * @columns Phase, Plus or minus
   * @advanced
   */
  void SetPoissonsRatioAcrossUncertainty(const char* phase, double value);
  void RemoveAllPoissonsRatioAcrossUncertainties();
  ///@}
  ///@{
  /**
   * The same of shear moduli along an axis [Pa], of phases that were given one.
   * @word shear-uncertainty
   * @uncertainty shear
   * @title Uncertainty of shear moduli [Pa]
   * @group Materials
   * @columns Phase, Plus or minus [Pa]
   * @advanced
   */
  void SetShearModulusUncertainty(const char* phase, double value);
  void RemoveAllShearModulusUncertainties();
  ///@}
  ///@{
  /**
   * Of phases with any tensor: its numbers [Pa], with spaces between them, along the image's axes, in Voigt's order xx,
   * yy, zz, yz, xz, xy: the 21 of the upper triangle by rows, or of an orthotropic one C11 C12 C13 C22 C23 C33 C44 C55
   * C66, or of a cubic one C11 C12 C44. Of pictures these too, or 6 of the plane itself, or C11 C12 C22
   * C66.
   * @title Stiffness of phases by its numbers [Pa]
   * @group Materials
   * @columns Phase, Numbers
   * @advanced
   */
  void SetStiffness(const char* phase, const char* numbers);
  void RemoveAllStiffnesses();
  ///@}
  ///@{
  /**
   * Phases whose pieces move as rigid bodies. Voxels that touch at a corner are one piece.
   *
   * The update fails for a phase that the image does not know.
   * @title Phases that are rigid
   * @group Materials
   * @advanced
   */
  void AddRigid(const char* phase);
  void RemoveAllRigids();
  ///@}
  ///@{
  /**
   * Strain that a phase takes by itself for a change of 1 (a kelvin, a per cent of moisture), one phase a row; with an
   * axis, that along it.
   * @title Expansion of phases
   * @group Materials
   * @columns Phase, Expansion
   * @advanced
   */
  void SetExpansion(const char* phase, double value);
  void RemoveAllExpansions();
  ///@}
  ///@{
  /**
   * Of phases with an axis: the same across it.
   * @title Expansion of phases across their axis
   * @group Materials
   * @columns Phase, Expansion
   * @advanced
   */
  void SetExpansionAcross(const char* phase, double value);
  void RemoveAllExpansionsAcross();
  ///@}

  /**
   * The image is grey, not labels: the greys of nodes that hold nothing of the phase `high`, and that are all of it;
   * what is between holds a part: the stiffness of a solid beside a void counts by its share, two isotropic solids make
   * layers across the surface. Materials are then those of `low` and `high`. Not given (both 0): the image holds
   * phases. More than 256 greys count as the nearest of 255 from none to all.
   * @title Greys of none and of all
   * @group Materials
   * @columns none, all
   */
  vtkSettingVector2Macro(Shares, double, 0, 0);

  enum Planes
  {
    PLANE_STRESS = 1,
    PLANE_STRAIN = 2
  };
  /**
   * What a picture takes the third direction for. Volumes are solved in space.
   * @group Materials
   * @choice Planes
   */
  vtkSettingMacro(Plane, int, PLANE_STRESS);

  enum SideKinds
  {
    PERIODIC = 0,       ///< opposite sides go on into each other
    UNIFORM_STRAIN = 1, ///< "Uniform strain: an upper bound": all sides follow the mean strain: an upper bound
    UNIFORM_STRESS = 2, ///< "Uniform stress: a lower bound": all sides are pulled by the mean stress: a lower bound; no
                        ///< void may touch them
    STRAIGHT = 3,       ///< "Straight: mirrors": sides stay plane and slide: mirror images fill space
    SLIP = 4, ///< "Platens that slip": between platens without friction, along each axis in turn, other sides free
    GRIP = 5  ///< "Platens that grip": between platens that hold, along each axis in turn, other sides free
  };
  /**
   * What the sides of the box do.
   * @group Load
   * @choice SideKinds
   */
  vtkSettingMacro(Sides, int, PERIODIC);

  /**
   * Solve for the tensor: one solve for each unit strain. Off, a mean strain alone is solved for.
   * @off no-tensor: Solve for the mean strain alone, not for the tensor.
   * @group Load
   * @advanced
   */
  vtkSwitchMacro(ComputeTensor, true);

  ///@{
  /**
   * Mean strain under which stresses are asked for, one component a row: xx, yy, xy; of a volume xx, yy, zz, yz, xz,
   * xy, shears as angles. Components that are given neither as strain nor as stress have no strain; where some stress
   * is given they have no stress. Between platens one normal component.
   * @word mean-strain
   * @title Mean strain
   * @group Load
   * @columns Component, Strain
   */
  void SetMeanStrain(const char* component, double value);
  void RemoveAllMeanStrains();
  ///@}
  ///@{
  /**
   * Mean stress under which stresses are asked for [Pa], one component a row, tension positive.
   * @word mean-stress
   * @title Mean stress [Pa]
   * @group Load
   * @columns Component, Stress [Pa]
   */
  void SetMeanStress(const char* component, double value);
  void RemoveAllMeanStresses();
  ///@}
  /**
   * Change of temperature or moisture, which phases expand by, besides the mean strain or stress. Where none is given
   * nothing strains on average; with mean stresses of 0 the box is free.
   * @group Load
   */
  vtkSettingMacro(Change, double, 0);
  /**
   * Point array of numbers that the change is multiplied by: a temperature or a concentration of a diffusion result.
   * Empty: the same everywhere.
   * @group Load
   * @advanced
   */
  vtkSettingMacro(ChangeArray, std::string, "");

  /**
   * Put the displacement of a load into the output.
   * @group Output
   */
  vtkSwitchMacro(ComputeDisplacement, true);
  /**
   * Put the strain of a load into the output.
   * @group Output
   */
  vtkSwitchMacro(ComputeStrain, true);
  /**
   * Put the stress of a load into the output.
   * @group Output
   */
  vtkSwitchMacro(ComputeStress, true);

  /**
   * Solve coarser pictures of the box as well, and tell the error. About as much work as the box of a volume, twice
   * that of a picture.
   * @off no-error-estimate: Do not solve coarser pictures of the box: no error is told.
   * @group Accuracy and cost
   */
  vtkSwitchMacro(EstimateError, true);

  /**
   * Also tell how the tensor and the constants of the box change with the constants of each phase: exactly, from the
   * fields that are there anyway. Not of rigid phases, nor of those whose tensor is given by its numbers.
   * @word sensitivity
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(ComputeSensitivity, false);

  /**
   * Also solve the windows that the box is cut into, halves and thirds of it along each axis, and tell how far it
   * speaks for the material that it was cut out of: an interval that holds the material's value with a probability of
   * 95 %, and whether the box changes along an axis. About twice the work of the box.
   * @word window-error
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(EstimateWindowError, false);

  /**
   * Also tell how the tensor changes where the surfaces between phases lie elsewhere, as far as the picture's
   * segmentation leaves it open: from the fields of the solves, no other one is made. Needs a picture that was
   * segmented, or the doubt in pixels.
   * @word segmentation-error
   * @group Accuracy and cost
   * @advanced
   */
  vtkSwitchMacro(EstimateSegmentationError, false);

  /**
   * How far surfaces between phases may lie from where the picture has them [pixels], for the segmentation error; 0:
   * what the picture's segmentation told of itself.
   * @group Accuracy and cost
   * @range [0, 10]
   * @unset 0
   * @advanced
   */
  vtkSettingMacro(SurfaceDoubt, double, 0);

  /**
   * Nodes along each axis that a pixel was split in before it came here: what is a picture, for the error.
   * @group Accuracy and cost
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(NodesPerPixel, int, 1);

  /**
   * Error of the strain energy that iterations leave, relative, estimated.
   * @group Accuracy and cost
   * @range [1e-14, 0.1]
   * @advanced
   */
  vtkSettingMacro(Tolerance, double, 1e-6);
  /**
   * Gives up after this many.
   * @word max-iterations
   * @group Accuracy and cost
   * @range [1, inf)
   * @advanced
   */
  vtkSettingMacro(MaximumIterations, int, 500);

  ///@{
  /** The processes that may work together. Default: the global controller. */
  vtkSetSmartPointerMacro(Controller, vtkMultiProcessController);
  vtkGetSmartPointerMacro(Controller, vtkMultiProcessController);
  ///@}

  /** Output 0. */
  vtkImageData* GetImage();
  /** Output 1. */
  vtkTable* GetTensor();
  /** Output 2. */
  vtkTable* GetConstants();
  /** Output 3. */
  vtkPolyData* GetDirections();

  /** Of the last update; NaN when it was not estimated. */
  vtkGetMacro(EstimatedError, double);

protected:
  vtkVoxelStiffness();
  ~vtkVoxelStiffness() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  struct Internals;
  void Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team);

  std::unique_ptr<Internals> Internal;
  double EstimatedError;
};
