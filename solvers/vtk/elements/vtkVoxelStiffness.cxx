#include "vtkVoxelStiffness.h"

#include "BondFields.h"
#include "BoxExchange.h"
#include "FieldNumbers.h"
#include "Listed.h"
#include "NewArray.h"
#include "StiffnessDirections.h"
#include "StiffnessSensitivity.h"
#include "StiffnessTables.h"
#include "SurfaceDoubt.h"
#include "VoxelMaterials.h"
#include "WindowFields.h"
#include "vtkClassMacros.h"
#include "vtkLatticeConversion.h"
#include "vtkPieces.h"
#include "vtkProvenance.h"

#include "core/Error.h"
#include "elasticity/TensorParts.h"

#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

namespace el = lamella::elasticity;

namespace
{

using lamella::unknown;

constexpr std::array<const char*, 6> sideWords{ "periodic", "uniform-strain", "uniform-stress", "straight", "slip",
  "grip" };

/// Values of points, in pieces, of the whole image on every rank.
class Gathered
{
public:
  Gathered(const lamella::WholeImage& whole, const lamella::Team& team)
    : all_{ { 0, 0, 0 }, whole.lattice.size }
    , in_(whole.lattice, whole.held, all_, { false, false, false }, team.comm(), team.size())
  {
  }
  template <class Value>
  [[nodiscard]] std::vector<Value> from(std::span<const Value> piece) const
  {
    std::vector<Value> values(static_cast<std::size_t>(all_.count()));
    in_.run<Value>(piece, values);
    return values;
  }

private:
  lamella::lbm::Block all_;
  lamella::BoxExchange in_;
};

/// The fields of a load of the rank's planes of the image, single precision.
struct LoadFields
{
  std::vector<float> displacement, strain, stress;
};

/// VTK's order of a symmetric tensor, XX YY ZZ XY YZ XZ, by places in Voigt's; below 0: not of the plane.
constexpr std::array<int, 6> ofSpace{ 0, 1, 2, 5, 3, 4 };
constexpr std::array<int, 6> ofPlane{ 0, 1, -1, 2, -1, -1 };

el::StiffnessSides sidesOf(int sides)
{
  return static_cast<el::StiffnessSides>(sides);
}

void describeParts(vtkImageData* output, const std::vector<double>& stiffness, int dimension)
{
  const el::IsotropicPart same = el::nearestIsotropic(stiffness, dimension);
  lamella::setFieldNumbers(
    output, "isotropic_part", std::array{ same.bulk, same.shear, same.young, same.poisson, same.rest });
  const el::OrthotropicPart own = el::nearestOrthotropic(stiffness, dimension);
  lamella::setFieldNumbers(output, "orthotropic_part", own.stiffness);
  std::vector<double> axes;
  for (const auto& axis : own.axes)
    axes.insert(axes.end(), axis.begin(), axis.end());
  lamella::setFieldNumbers(output, "orthotropic_axes", axes);
  lamella::setFieldNumber(output, "orthotropic_rest", own.rest);
}

} // namespace

struct vtkVoxelStiffness::Internals
{
  lamella::VoxelSettings Materials;
  std::map<std::string, double> Strain, Stress;
};

vtkStandardNewMacro(vtkVoxelStiffness);

vtkVoxelStiffness::vtkVoxelStiffness()
  : Internal(std::make_unique<Internals>())
  , EstimatedError(unknown)
{
  this->Controller = vtkMultiProcessController::GetGlobalController();
  this->SetNumberOfOutputPorts(4);
  this->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "axis");
}

vtkVoxelStiffness::~vtkVoxelStiffness() = default;

vtkSetNamedMacro(vtkVoxelStiffness, YoungsModulus, YoungsModuli, Internal->Materials.young);
vtkSetNamedMacro(vtkVoxelStiffness, PoissonsRatio, PoissonsRatios, Internal->Materials.poisson);
vtkSetNamedMacro(vtkVoxelStiffness, YoungsModulusAcross, YoungsModuliAcross, Internal->Materials.youngAcross);
vtkSetNamedMacro(vtkVoxelStiffness, PoissonsRatioAcross, PoissonsRatiosAcross, Internal->Materials.poissonAcross);
vtkSetNamedMacro(vtkVoxelStiffness, ShearModulus, ShearModuli, Internal->Materials.shear);
vtkSetNamedMacro(
  vtkVoxelStiffness, YoungsModulusUncertainty, YoungsModulusUncertainties, Internal->Materials.youngUncertainty);
vtkSetNamedMacro(
  vtkVoxelStiffness, PoissonsRatioUncertainty, PoissonsRatioUncertainties, Internal->Materials.poissonUncertainty);
vtkSetNamedMacro(vtkVoxelStiffness, YoungsModulusAcrossUncertainty, YoungsModulusAcrossUncertainties,
  Internal->Materials.youngAcrossUncertainty);
vtkSetNamedMacro(vtkVoxelStiffness, PoissonsRatioAcrossUncertainty, PoissonsRatioAcrossUncertainties,
  Internal->Materials.poissonAcrossUncertainty);
vtkSetNamedMacro(
  vtkVoxelStiffness, ShearModulusUncertainty, ShearModulusUncertainties, Internal->Materials.shearUncertainty);

void vtkVoxelStiffness::SetStiffness(const char* phase, const char* numbers)
{
  lamella::setNamed(this, this->Internal->Materials.stiffness, phase, std::string(numbers != nullptr ? numbers : ""));
}

void vtkVoxelStiffness::RemoveAllStiffnesses()
{
  lamella::removeAll(this, this->Internal->Materials.stiffness);
}

void vtkVoxelStiffness::AddRigid(const char* phase)
{
  if (phase == nullptr || *phase == '\0')
    return;
  this->Internal->Materials.rigid.emplace_back(phase);
  this->Modified();
}

void vtkVoxelStiffness::RemoveAllRigids()
{
  lamella::removeAll(this, this->Internal->Materials.rigid);
}

vtkSetNamedMacro(vtkVoxelStiffness, Expansion, Expansions, Internal->Materials.expansion);
vtkSetNamedMacro(vtkVoxelStiffness, ExpansionAcross, ExpansionsAcross, Internal->Materials.expansionAcross);
vtkSetNamedMacro(vtkVoxelStiffness, MeanStrain, MeanStrains, Internal->Strain);
vtkSetNamedMacro(vtkVoxelStiffness, MeanStress, MeanStresses, Internal->Stress);
vtkImageData* vtkVoxelStiffness::GetImage()
{
  return vtkImageData::SafeDownCast(this->GetOutputDataObject(0));
}

vtkTable* vtkVoxelStiffness::GetTensor()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(1));
}

vtkTable* vtkVoxelStiffness::GetConstants()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(2));
}

vtkPolyData* vtkVoxelStiffness::GetDirections()
{
  return vtkPolyData::SafeDownCast(this->GetOutputDataObject(3));
}

int vtkVoxelStiffness::FillOutputPortInformation(int port, vtkInformation* info)
{
  constexpr std::array<const char*, 4> types{ "vtkImageData", "vtkTable", "vtkTable", "vtkPolyData" };
  info->Set(vtkDataObject::DATA_TYPE_NAME(), types[static_cast<std::size_t>(port)]);
  return 1;
}

int vtkVoxelStiffness::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  return this->Attempt(
    [&]
    {
      const lamella::Team team(this->Controller, lamella::requestedOutput(request, outputVector));
      this->Run(vtkImageData::GetData(inputVector[0]), vtkImageData::GetData(outputVector, 0), team);
    },
    outputVector);
}

void vtkVoxelStiffness::Run(vtkImageData* input, vtkImageData* output, const lamella::Team& team)
{
  this->EstimatedError = unknown;
  vtkTable* const tensor = this->GetTensor();
  vtkTable* const constants = this->GetConstants();
  vtkPolyData* const directions = this->GetDirections();
  tensor->Initialize();
  constants->Initialize();
  directions->Initialize();

  const lamella::WholeImage whole = lamella::uprightImage(input, team, lamella::Voxels::Any);
  const lamella::Lattice& lattice = whole.lattice;
  const int dimension = lattice.dimension;
  lamella::VoxelSettings settings = this->Internal->Materials;
  settings.voids = this->GivenVoids();
  settings.continuum = dimension == 3 ? el::Continuum::Space
    : this->Plane == PLANE_STRAIN     ? el::Continuum::PlaneStrain
                                      : el::Continuum::PlaneStress;
  std::optional<lamella::GreyBins> bins;
  const bool shared = this->Shares[0] != 0 || this->Shares[1] != 0;
  if (shared && this->Shares[0] == this->Shares[1])
    throw lamella::ParameterError(
      fmt::format("greys of none and of all that are both {:g}", this->Shares[0]), "give the greys of the two phases");
  if (shared)
    bins = lamella::GreyBins::even(this->Shares[0], this->Shares[1]);
  const lamella::PhaseIds phases = lamella::phaseIds(input, this->GetInputArrayInformation(0), team, bins);
  const Gathered gathered(whole, team);
  std::vector<std::uint8_t> moved;
  std::span<const std::uint8_t> phase = phases.ids;
  if (team.size() > 1)
    phase = moved = gathered.from<std::uint8_t>(phases.ids);
  std::vector<std::int64_t> nodes(std::max<std::size_t>(phases.names.size(), 1), 0);
  for (const std::uint8_t id : phase)
    ++nodes[id];
  std::optional<lamella::VoxelMaterials> materials;
  std::vector<double> shares;
  std::vector<double> fractions(nodes.begin(), nodes.end());
  for (double& fraction : fractions)
    fraction /= static_cast<double>(lattice.count());
  team.agree(
    [&]
    {
      if (!shared)
        materials.emplace(settings, phases, nodes);
      else
      {
        shares = lamella::sharesOf(phases, this->Shares[0], this->Shares[1]);
        const double high = std::inner_product(shares.begin(), shares.end(), fractions.begin(), 0.0);
        fractions = { 1 - high, high };
        materials.emplace(settings, shares);
      }
    });

  std::vector<std::array<float, 3>> axis;
  if (materials->turn() && !materials->turnsAcrossSurfaces())
  {
    const lamella::NodeVectors vectors = lamella::vectorsOf(input, this->GetInputArrayInformation(1), "axis",
      "give the directions along the walls, as MicrographLattice does, or leave out what holds across them", dimension,
      team);
    axis.resize(phases.ids.size());
    for (std::size_t i = 0; i < axis.size(); ++i)
      for (int c = 0; c < vectors.array->GetNumberOfComponents(); ++c)
        axis[i][static_cast<std::size_t>(c)] =
          static_cast<float>(vectors.array->GetComponent(static_cast<vtkIdType>(i), c));
    if (team.size() > 1)
      axis = gathered.from<std::array<float, 3>>(axis);
  }
  std::vector<float> source;
  if (!this->ChangeArray.empty())
  {
    team.agree(
      [&]
      {
        vtkDataArray* const array = input->GetPointData()->GetArray(this->ChangeArray.c_str());
        if (input->GetNumberOfPoints() > 0 && (array == nullptr || array->GetNumberOfComponents() != 1))
          throw lamella::InputError("the image has no point array '" + this->ChangeArray + "' of one component",
            "choose the temperature or concentration of a diffusion result");
        source.resize(phases.ids.size());
        for (std::size_t i = 0; i < source.size(); ++i)
        {
          const double value = array->GetTuple1(static_cast<vtkIdType>(i));
          const el::VoxelMaterial& material = materials->materials()[phases.ids[i]];
          const bool expands = std::ranges::any_of(material.expansion, [](double e) { return e != 0; });
          if (!std::isfinite(value) && expands)
            throw lamella::InputError(
              fmt::format("array '{}' holds {} in a phase that expands", this->ChangeArray, value),
              "give finite numbers wherever something expands");
          source[i] = std::isfinite(value) ? static_cast<float>(value) : 0.0F; // of what does not expand
        }
      });
    if (team.size() > 1)
      source = gathered.from<float>(source);
  }

  el::VoxelStiffnessOptions options;
  options.sides = sidesOf(this->Sides);
  options.tensor = this->ComputeTensor;
  options.shares = shares;
  options.tolerance = this->Tolerance;
  options.maxIterations = this->MaximumIterations;
  options.estimateError = this->EstimateError;
  options.windowError = this->EstimateWindowError;
  const bool sensitivity = this->ComputeSensitivity || materials->uncertain();
  options.numbers = sensitivity ? materials->numbers().size() : 0;
  double doubt = unknown;
  options.surfaces = this->ComputeTensor && (this->EstimateSegmentationError || this->SurfaceDoubt > 0);
  if (options.surfaces)
    team.agree([&] { doubt = lamella::surfaceDoubt(input, this->SurfaceDoubt, lamella::Communicator(team.comm())); });
  options.nodesPerPixel = this->NodesPerPixel;
  options.threads = this->ThreadCount();
  options.ranks = lamella::Communicator(team.comm());
  this->SetProgressText("stiffness");
  options.progress = [this](double share)
  {
    this->UpdateProgress(std::min(share, 1.0));
    return !this->CheckAbort();
  };
  if (team.any(this->CheckAbort()))
    throw lamella::Cancelled();
  LoadFields fields;
  const bool loaded = !this->Internal->Strain.empty() || !this->Internal->Stress.empty() || this->Change != 0;
  team.agree(
    [&]
    {
      if (loaded)
        options.load = el::VoxelLoad{ lamella::voigtVector(this->Internal->Strain, dimension, "mean strain"),
          lamella::voigtVector(this->Internal->Stress, dimension, "mean stress"), this->Change, source };
      else if (!this->ComputeTensor)
        throw lamella::ParameterError("neither the tensor nor the stresses of a load are wanted",
          "give a mean strain, or let the tensor be solved for");
    });
  const auto [firstPlane, lastPlane] = el::fieldPlanes(lattice, options.sides, options.ranks);
  lamella::lbm::Block slab{ { 0, 0, 0 }, lattice.size };
  slab.start[static_cast<std::size_t>(dimension - 1)] = firstPlane;
  slab.size[static_cast<std::size_t>(dimension - 1)] = lastPlane - firstPlane;
  const std::int64_t before = (slab.start[1] + lattice.size[1] * slab.start[2]) * lattice.size[0];
  const auto count = static_cast<std::size_t>(slab.count());
  if (loaded && (this->ComputeDisplacement || this->ComputeStrain || this->ComputeStress))
  {
    fields.displacement.resize(this->ComputeDisplacement ? 3 * count : 0);
    fields.strain.resize(this->ComputeStrain ? 6 * count : 0);
    fields.stress.resize(this->ComputeStress ? 6 * count : 0);
    options.fields = [&](std::int64_t row, std::int64_t plane, const double* const* displacement,
                       const double* const* strain, const double* const* stress)
    {
      const std::int64_t nx = lattice.size[0];
      const std::int64_t first = dimension == 3 ? nx * (row + lattice.size[1] * plane) : nx * plane;
      const std::array<int, 6>& order = dimension == 3 ? ofSpace : ofPlane;
      for (std::int64_t i = 0; i < nx; ++i)
      {
        const auto voxel = static_cast<std::size_t>(first + i);
        const auto at = static_cast<std::size_t>(first + i - before);
        if (materials->isVoid(phase[voxel]))
          continue;
        for (std::size_t c = 0; c < static_cast<std::size_t>(dimension) && this->ComputeDisplacement; ++c)
          fields.displacement[3 * at + c] = static_cast<float>(displacement[c][i]);
        for (std::size_t c = 0; c < 6; ++c)
        {
          if (order[c] < 0)
            continue;
          if (this->ComputeStrain)
            fields.strain[6 * at + c] = static_cast<float>((c < 3 ? 1.0 : 0.5) * strain[order[c]][i]);
          if (this->ComputeStress)
            fields.stress[6 * at + c] = static_cast<float>(stress[order[c]][i]);
        }
        const bool strained = this->Plane == PLANE_STRAIN; // the strain across is 0, else the stress is
        if (dimension == 2 && (strained ? this->ComputeStress : this->ComputeStrain))
          (strained ? fields.stress : fields.strain)[6 * at + 2] =
            static_cast<float>(materials->acrossPlane(phase[voxel], stress[0][i], stress[1][i], stress[2][i],
              axis.empty() ? std::array<float, 3>{ 1, 0, 0 } : axis[voxel],
              this->Change * (source.empty() ? 1.0 : static_cast<double>(source[voxel]))));
      }
    };
  }
  el::VoxelStiffness result;
  team.agree([&] { result = el::studyVoxelStiffness(lattice, phase, materials->materials(), axis, options); });
  this->EstimatedError = result.error.relative;

  output->ShallowCopy(input);
  if (options.fields)
  {
    // back into the pieces
    const lamella::BoxExchange out(lattice, slab, whole.held, { false, false, false }, team.comm(), team.size());
    const auto add = [&](const char* name, const std::vector<float>& values, int components, bool wanted,
                       const char* unit, const char* words)
    {
      if (!wanted)
        return;
      const auto array = lamella::newArray<vtkFloatArray>(name, components, phases.ids.size());
      const std::span<float> to(array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()));
      out.run<float>(values, to, components);
      if (components == 6)
        for (int c = 0; c < 6; ++c)
          array->SetComponentName(c, std::array{ "XX", "YY", "ZZ", "XY", "YZ", "XZ" }[static_cast<std::size_t>(c)]);
      lamella::describe(array, unit, words, "vtkVoxelStiffness");
      output->GetPointData()->AddArray(array);
    };
    add("displacement", fields.displacement, 3, this->ComputeDisplacement, "m",
      "displacement of the point's element, from the image's middle; 0 in voids");
    add("strain", fields.strain, 6, this->ComputeStrain, "1", "mean strain of the point's element; 0 in voids");
    add("stress", fields.stress, 6, this->ComputeStress, "Pa",
      "mean stress of the point's element, tension positive; 0 in voids");
    if (this->ComputeDisplacement)
      output->GetPointData()->SetActiveVectors("displacement");
  }
  if (team.rank() != 0)
    return;

  const lamella::StiffnessFound found{ dimension, result.stiffness, result.voigt, result.reuss, result.asymmetry,
    &result.constants, &result.error, result.steps, result.sides, result.crosses, result.pieces, result.loosePieces,
    result.looseVoxels };
  lamella::setStiffness(output, found);
  const auto number = [&](const char* name, double value) { lamella::setFieldNumber(output, name, value); };
  const auto voxels = static_cast<double>(lattice.count());
  number("solver_error", result.solverError);
  number("levels", static_cast<double>(result.levels));
  number("bytes", static_cast<double>(result.bytes));
  number("solid_nodes", static_cast<double>(result.solidVoxels));
  number("skipped_nodes", voxels - static_cast<double>(result.solidVoxels));
  lamella::setFieldNumbers(output, "seconds",
    std::array{ result.setupSeconds, result.solveSeconds, result.loaded ? result.loaded->seconds : 0.0,
      result.estimateSeconds, result.changeSeconds });
  lamella::setFieldNumbers(output, "phase_fraction", fractions);
  lamella::setFieldTexts(output, "phase_names", shared ? std::vector<std::string>{ "low", "high" } : phases.names);
  lamella::setFieldText(output, "phase_array", phases.array);
  const char* const continuum = dimension == 3 ? "space"
    : this->Plane == PLANE_STRAIN              ? "plane-strain"
                                               : "plane-stress";
  lamella::setFieldText(output, "continuum", continuum);
  lamella::setFieldText(output, "sides", sideWords[static_cast<std::size_t>(this->Sides)]);
  lamella::setFieldTexts(output, "warnings", result.warnings);
  if (!result.stiffness.empty())
  {
    if (!el::between(options.sides))
    {
      describeParts(output, result.stiffness, dimension);
      lamella::setExtremes(output, result.stiffness, dimension, result.zero);
      lamella::fillDirections(directions, result.stiffness, dimension, result.zero);
    }
    lamella::fillTensor(tensor, found, "vtkVoxelStiffness");
    lamella::fillConstants(constants, found, "vtkVoxelStiffness");
  }
  if (const auto& own = materials->isotropic(); !own.bulk.empty())
  {
    const el::IsotropicBounds bounds = el::hashinShtrikman(fractions, own.bulk, own.shear, dimension);
    lamella::setFieldNumbers(
      output, "hashin_shtrikman", std::array{ bounds.bulk[0], bounds.bulk[1], bounds.shear[0], bounds.shear[1] });
  }
  lamella::setWindowFields(output, result.windows);
  if (sensitivity)
    lamella::setSensitivity(output, result, materials->numbers());
  if (options.surfaces)
    lamella::setSurfaces(output, result, phases.names, doubt);
  if (!result.stiffness.empty() && materials->uncertain())
    lamella::setInputErrors(output, result, materials->numbers());
  if (!result.stiffness.empty() && (materials->uncertain() || this->EstimateWindowError || options.surfaces))
    lamella::setTotalErrors(output, result);
  if (!result.expansion.empty())
    lamella::setFieldNumbers(output, "expansion", result.expansion);
  if (result.loaded)
  {
    lamella::setFieldNumbers(output, "load_strain", result.loaded->strain);
    lamella::setFieldNumbers(output, "load_stress", result.loaded->stress);
    number("load_energy", 0.5 * result.loaded->energy);
    number("load_iterations", result.loaded->iterations);
  }
  const nlohmann::json model{ { "phases", materials->told() }, { "continuum", continuum },
    { "sides", sideWords[static_cast<std::size_t>(this->Sides)] },
    { "shares", shared ? nlohmann::json(this->Shares) : nlohmann::json(nullptr) } };
  lamella::setFieldText(output, "element_model", model.dump());
  nlohmann::json parameters{ { "model", model }, { "estimate_error", this->EstimateError },
    { "window_error", this->EstimateWindowError }, { "segmentation_error", options.surfaces },
    { "nodes_per_pixel", this->NodesPerPixel }, { "tolerance", this->Tolerance } };
  if (loaded)
    parameters["load"] = { { "mean_strain", this->Internal->Strain }, { "mean_stress", this->Internal->Stress },
      { "change", this->Change }, { "change_array", this->ChangeArray } };
  lamella::continueProvenance(output, "voxel_stiffness", parameters);
  for (const std::string& warning : result.warnings)
    vtkWarningMacro(<< warning);
  for (vtkDataObject* const data : std::initializer_list<vtkDataObject*>{ tensor, constants, directions })
    data->GetFieldData()->ShallowCopy(output->GetFieldData());
  lamella::setFieldText(directions, "length_unit", "1"); // its coordinates are no lengths
}
