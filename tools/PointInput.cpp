#include "PointInput.h"

#include "SampleRun.h"
#include "Text.h"
#include "Units.h"

#include "lattice/Error.h"
#include "lattice/PhaseNames.h"
#include "vtkLatticeConversion.h"
#include "vtkPointAlgorithm.h"

#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> laws{ "auto", "isotropic", "orthotropic", "plastic" };
const std::vector<std::string> planes{ "auto", "plane-stress", "plane-strain" };

/// What values a constant may have; the library knows the bounds of ratios.
enum class Kind
{
  Modulus, ///< [Pa], above 0
  Ratio,
  Yield, ///< [Pa], above 0 or infinite
  Slope, ///< [Pa], 0 or above
  Factor,
  Density
};

struct Constant
{
  const char* name;
  const char* law; ///< that alone has it, or null
  Kind kind;
  const char* text;
  void (vtkPointAlgorithm::*set)(double);
};
const std::array<Constant, 9> constants{ {
  { "young", nullptr, Kind::Modulus,
    "Young's modulus [Pa], along the wall where it is orthotropic: 8e9, 7.2e9 isotropic",
    &vtkPointAlgorithm::SetYoungsModulus },
  { "transverse", "orthotropic", Kind::Modulus, "Young's modulus across the wall [Pa]: 6.4e9",
    &vtkPointAlgorithm::SetTransverseModulus },
  { "poisson", nullptr, Kind::Ratio, "Poisson's ratio, pulled along the wall: 0.3",
    &vtkPointAlgorithm::SetPoissonsRatio },
  { "transverse-poisson", "orthotropic", Kind::Ratio, "Poisson's ratio among the directions across the wall: 0.3",
    &vtkPointAlgorithm::SetTransversePoissonsRatio },
  { "shear", "orthotropic", Kind::Modulus, "Shear modulus [Pa]; from the others when not given",
    &vtkPointAlgorithm::SetShearModulus },
  { "barrier", nullptr, Kind::Factor, "What keeps walls from being crushed to nothing, over their stiffness: 1",
    &vtkPointAlgorithm::SetBarrier },
  { "yield", "plastic", Kind::Yield, "Yield stress [Pa]: 1e8", &vtkPointAlgorithm::SetYieldStress },
  { "hardening", "plastic", Kind::Slope, "Slope of the yield stress over the plastic strain [Pa]: 0",
    &vtkPointAlgorithm::SetHardening },
  { "density", nullptr, Kind::Density, "Density of the walls [kg/m³]: 1500", &vtkPointAlgorithm::SetDensity },
} };

double value(Kind kind, const std::string& option, const std::string& text, const std::string& number)
{
  const bool stress = kind == Kind::Modulus || kind == Kind::Yield || kind == Kind::Slope;
  const auto found = stress ? pascals(number) : toNumber(number);
  if (!found || std::isnan(*found))
  {
    throw ParameterError(fmt::format("{} {}: '{}' is not a number", option, text, number),
      fmt::format(
        "write it as {} VALUE, or {} PHASE=VALUE, in SI units{}", option, option, stress ? ", or as 7.2GPa" : ""));
  }
  const double v = *found;
  const bool fine = kind == Kind::Ratio           ? std::isfinite(v)
    : kind == Kind::Yield                         ? v > 0 && (std::isinf(v) || plausible(v))
    : kind == Kind::Slope || kind == Kind::Factor ? v == 0 || (v > 0 && plausible(v))
                                                  : v > 0 && plausible(v);
  if (!fine)
  {
    throw ParameterError(fmt::format("{} {}: {} is out of range", option, text, v),
      kind == Kind::Ratio                             ? "a ratio is finite"
        : kind == Kind::Slope || kind == Kind::Factor ? "it is 0 or above, at most 1e30"
                                                      : "it is above 0, between 1e-30 and 1e30; leave it out for the "
                                                        "default");
  }
  return v;
}

/// Phases that the sample does not have are slips: told with their option.
void checkNames(const PointOptions& o, const std::vector<std::string>& names)
{
  const auto check = [&](const std::string& option, const std::string& name)
  {
    if (!phaseMeant(names, name))
    {
      throw ParameterError(option + " names '" + name + "', which is no phase of this sample",
        suggestion(name, names, "its phases are " + quotedList(names, "and")));
    }
  };
  for (std::size_t c = 0; c < constants.size(); ++c)
  {
    const std::string option = std::string("--") + constants[c].name;
    for (const std::string& text : listItems(o.constants[c]))
    {
      if (text.find('=') != std::string::npos)
      {
        check(option, keyValue(option, text, "PHASE=VALUE").first);
      }
    }
  }
  for (const std::string& name : o.voids)
  {
    check("--void", name);
  }
}

} // namespace

void addPointOptions(CLI::App& command, PointOptions& o)
{
  const auto walls = [](CLI::Option* option) { return option->group("Walls"); };
  walls(command.add_option("--law", o.law,
          "Law of all walls; auto: orthotropic where the file has directions along the walls, else isotropic"))
    ->type_name("auto|isotropic|orthotropic|plastic")
    ->capture_default_str();
  walls(command.add_option("--plane", o.plane, "Of a picture; auto: plane stress, plane strain where walls yield"))
    ->type_name("auto|plane-stress|plane-strain")
    ->capture_default_str();
  for (std::size_t c = 0; c < constants.size(); ++c)
  {
    walls(command.add_option(std::string("--") + constants[c].name, o.constants[c], constants[c].text))
      ->type_name("VALUE|PHASE=VALUE")
      ->allow_extra_args(false);
  }
  walls(command.add_option(
          "--void", o.voids, "A phase without points; those called void, pore, lumen or air when not given"))
    ->type_name("PHASE")
    ->allow_extra_args(false);
  const auto points = [](CLI::Option* option) { return option->group("Points and grid"); };
  points(command.add_option("--points-per-node", o.perNode,
           "Points along each axis in a pixel; two a cell, and two at least, when not given"))
    ->type_name("NUMBER");
  points(command.add_option("--cells-per-node", o.cellsPerNode, "Cells of the grid along each axis in a pixel"))
    ->type_name("NUMBER")
    ->capture_default_str();
  points(command.add_option("--threads", o.threads, "Threads"))->type_name("NUMBER")->capture_default_str();
}

void applyPoints(const PointOptions& o, vtkPointAlgorithm* filter)
{
  filter->SetLaw(static_cast<int>(oneOf("--law", o.law, laws)));
  filter->SetPlane(static_cast<int>(oneOf("--plane", o.plane, planes)));
  for (std::size_t c = 0; c < constants.size(); ++c)
  {
    const Constant& constant = constants[c];
    const std::string option = std::string("--") + constant.name;
    if (constant.law != nullptr && !o.constants[c].empty() && o.law != constant.law && o.law != "auto")
    {
      throw ParameterError(
        fmt::format("{} is no constant of --law {}", option, o.law), fmt::format("add --law {}", constant.law));
    }
    if (constant.law != nullptr && constant.law == laws.back() && !o.constants[c].empty() && o.law == "auto")
    {
      throw ParameterError(option + " without walls that yield", "add --law plastic");
    }
    for (const std::string& text : listItems(o.constants[c]))
    {
      if (text.find('=') == std::string::npos)
      {
        (filter->*constant.set)(value(constant.kind, option, text, text));
        continue;
      }
      const auto [phase, number] = keyValue(option, text, "PHASE=VALUE");
      filter->SetPhaseConstant(phase.c_str(), constant.name, value(constant.kind, option, text, number));
    }
  }
  for (const std::string& name : o.voids)
  {
    filter->AddVoid(name.c_str());
  }
  const double wanted = std::clamp(2 * o.cellsPerNode, 2.0, 16.0);
  const int perNode = o.perNode.value_or(std::isfinite(wanted) ? static_cast<int>(std::ceil(wanted)) : 2);
  if (perNode < 1 || perNode > 16)
  {
    throw ParameterError(fmt::format("--points-per-node {} is outside 1 to 16", perNode), "2 is usual");
  }
  filter->SetPointsPerNode(perNode);
  filter->SetCellsPerNode(o.cellsPerNode);
  filter->SetFitPlatens(o.fitPlatens);
  checkThreads(o.threads);
  filter->SetThreads(o.threads);
}

PointSample loadPointSample(Session& session, const PictureOptions& picture, const PointOptions& options)
{
  Sample sample = loadSample(picture);
  Session::checkInterrupt();
  checkNames(options, sample.image.phases.names());
  tellDoubts(session, sample);
  const NodeArray directions = sampleArray(picture, sample, "axis");
  for (std::size_t c = 0; c < constants.size() && options.law == "auto" && directions.components == 0; ++c)
  {
    if (constants[c].law != nullptr && !options.constants[c].empty())
    {
      throw ParameterError(
        fmt::format("--{} of walls that have no direction: '{}' has no array 'axis'", constants[c].name, picture.file),
        "leave it out, for isotropic walls have one modulus; lamella micrograph writes directions along the walls");
    }
  }
  PointSample result;
  result.pixelSizeSource = sample.pixelSizeSource;
  result.provenance = sample.provenance;
  result.image = toImageData(std::move(sample.image));
  if (directions.components > 0)
  {
    vtkNew<vtkFloatArray> axis;
    axis->SetName("axis");
    axis->SetNumberOfComponents(directions.components);
    axis->SetNumberOfTuples(result.image->GetNumberOfPoints());
    std::transform(directions.values.begin(), directions.values.end(), axis->GetPointer(0),
      [](double value) { return static_cast<float>(value); });
    result.image->GetPointData()->AddArray(axis);
  }
  setFieldText(result.image, "pixel_size_source", result.pixelSizeSource);
  setProvenance(result.image, result.provenance);
  return result;
}

} // namespace lamella::cli
