#include "BondInput.h"

#include "FilterRun.h"
#include "GridFile.h"
#include "Record.h"
#include "SampleRun.h"
#include "Text.h"
#include "Units.h"

#include "lattice/Memory.h"
#include "lattice/PhaseNames.h"
#include "peridynamics/ElasticStudy.h"
#include "peridynamics/PairTable.h"
#include "vtkBondAlgorithm.h"
#include "vtkLatticeConversion.h"

#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> mixings{ "none", "harmonic", "minimum" };
const std::vector<std::string> continua{ "plane-stress", "plane-strain", "space" };
const std::vector<std::string> micromoduli{ "continuum", "lattice", "isotropic" };
const std::vector<std::string> voidBondWords{ "keep", "cut" };

/// The four tables of values, with the options that fill them.
struct Table
{
  const char* option;
  const std::vector<std::string>& texts;
  void (vtkBondAlgorithm::*set)(const char*, double);
  std::optional<double> (*read)(std::string_view);
};

std::array<Table, 4> tables(const BondOptions& o)
{
  return { { { "--young", o.young, &vtkBondAlgorithm::SetYoungsModulus, pascals },
    { "--fracture-energy", o.fractureEnergy, &vtkBondAlgorithm::SetFractureEnergy, toNumber },
    { "--toughness", o.toughness, &vtkBondAlgorithm::SetToughness, pascalRootMetres },
    { "--critical-stretch", o.criticalStretch, &vtkBondAlgorithm::SetCriticalStretch, strainFrom } } };
}

/// How its unit may be written.
const char* unitsOf(const std::string& option)
{
  return option == "--young" ? ", or as 7.2GPa" : option == "--toughness" ? ", or as 0.4MPa√m" : "";
}

std::array<int, 3> parsePeriodic(const std::string& text)
{
  std::array<int, 3> axes{ 0, 0, 0 };
  for (const char c : text == "none" ? std::string() : text)
  {
    if (c >= 'x' && c <= 'z')
    {
      axes[static_cast<std::size_t>(c - 'x')] = 1;
    }
    else if (c != ',')
    {
      throw ParameterError("--periodic '" + text + "' names no axes", "write the axes, such as x or xz, or none");
    }
  }
  return axes;
}

/// Pairs and voids that no phase of the sample fits are slips here; the filter would ignore them.
void checkNames(const BondOptions& o, const std::vector<std::string>& names)
{
  const auto check = [&](const char* option, const std::string& pair)
  {
    if (!peridynamics::findPair(pair, names))
    {
      throw ParameterError(
        fmt::format("{} names '{}', which is no phase or pair of phases of this sample", option, pair),
        suggestion(pair, names,
          "its phases are " + quotedList(names, "and") + "; a pair is written as " + names.front() + "-" +
            names.back()));
    }
  };
  for (const Table& table : tables(o))
  {
    for (const std::string& text : listItems(table.texts))
    {
      check(table.option, keyValue(table.option, text, "PAIR=VALUE").first);
    }
  }
  for (const std::string& text : listItems(o.like))
  {
    const auto [pair, other] = keyValue("--like", text, "PAIR=PAIR");
    check("--like", pair);
    check("--like", other);
  }
  if (!o.relativeTo.empty())
  {
    check("--relative-to", o.relativeTo);
  }
  const auto checkPhase = [&](const std::string& option, const std::string& name)
  {
    if (!phaseMeant(names, name))
    {
      throw ParameterError(option + " names '" + name + "', which is no phase of this sample",
        suggestion(name, names, "its phases are " + quotedList(names, "and")));
    }
  };
  for (const std::string& name : o.voids)
  {
    checkPhase("--void", name);
  }
  for (const std::string& text : listItems(o.density))
  {
    if (text.find('=') != std::string::npos)
    {
      checkPhase("--density", keyValue("--density", text, "PHASE=VALUE").first);
    }
  }
}

/// A value in another unit is a slip that nothing else tells.
void tellLowToughness(Session& session, const BondOptions& o)
{
  constexpr double least = 1e3; // Pa √m, far below glue (1e5); gels lie here
  for (const std::string& text : o.relativeTo.empty() ? listItems(o.toughness) : std::vector<std::string>())
  {
    const std::string number = keyValue("--toughness", text, "PAIR=VALUE").second;
    if (const double value = pascalRootMetres(number).value_or(least); value < least)
    {
      session.warn(fmt::format(
        "--toughness {} is {:g} Pa √m: glass has 7e5, wood 1e5 to 1e6; was {}MPa√m meant?", text, value, number));
    }
  }
}

/// The grains of a .vti, where it has them, in the sample's order: window cut out, not refined.
std::vector<std::int32_t> loadGrains(const PictureOptions& picture, const Sample& sample)
{
  const NodeArray array = sampleArray(picture, sample, "grain");
  std::vector<std::int32_t> grains(array.components == 1 ? array.values.size() : 0);
  for (std::size_t i = 0; i < grains.size(); ++i)
  {
    const double value = array.values[i];
    if (!(std::abs(value) < 2147483647) || value != std::floor(value))
    {
      throw InputError(fmt::format("'{}': array 'grain' holds {}; grains are whole numbers", picture.file, value),
        "0 stands for no grain");
    }
    grains[i] = static_cast<std::int32_t>(value);
  }
  return grains;
}

vtkSmartPointer<vtkIntArray> grainArray(const std::vector<std::int32_t>& grains, const Lattice& from, int n)
{
  const auto array = vtkSmartPointer<vtkIntArray>::New();
  array->SetName("grain");
  const Lattice to = makeLattice(
    from.size[0] * n, from.size[1] * n, from.dimension == 3 ? from.size[2] * n : 1, from.dimension, from.spacing / n);
  array->SetNumberOfTuples(to.count());
  vtkIdType at = 0;
  for (std::int64_t z = 0; z < to.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < to.size[1]; ++y)
    {
      for (std::int64_t x = 0; x < to.size[0]; ++x)
      {
        const std::int64_t layer = from.dimension == 3 ? z / n : 0;
        array->SetValue(at++, grains[static_cast<std::size_t>(from.index(x / n, y / n, layer))]);
      }
    }
  }
  describe(array, "1", "number of the grain, 0 none", "lamella");
  return array;
}

} // namespace

double coordinate(const std::string& option, const std::string& text)
{
  if (const auto number = toNumber(text); number && std::isfinite(*number))
  {
    return *number;
  }
  const bool negative = !text.empty() && text.front() == '-';
  return (negative ? -1 : 1) * lengthInMetres(option, negative ? text.substr(1) : text);
}

void addBondOptions(CLI::App& command, BondOptions& o, BondUse use)
{
  const auto material = [&](const char* name, std::vector<std::string>& list, const char* text, const char* type)
  { return command.add_option(name, list, text)->type_name(type)->allow_extra_args(false)->group("Materials"); };
  material("--young", o.young,
    "Young's modulus [Pa] of a phase (grain), of bonds between two phases (matrix-grain), or between two different "
    "grains of a phase (grain-grain)",
    "PAIR=VALUE")
    ->required();
  if (use != BondUse::Stiffness)
  {
    material("--fracture-energy", o.fractureEnergy, "Fracture energy [J/m²]", "PAIR=VALUE");
    material("--toughness", o.toughness, "Toughness [Pa √m]", "PAIR=VALUE");
    material("--critical-stretch", o.criticalStretch, "Elongation at which bonds break", "PAIR=VALUE");
  }
  if (use == BondUse::Motion)
  {
    material("--density", o.density, "Density [kg/m³] of all that is solid, or of a phase", "VALUE|PHASE=VALUE")
      ->required();
  }
  material("--like", o.like, "Bonds of the first pair are like those of the second", "PAIR=PAIR");
  command.add_option("--relative-to", o.relativeTo, "All other values are multiples of this pair's")
    ->type_name("PAIR")
    ->group("Materials");
  command.add_option("--mixing", o.mixing, "Bonds of two phases without material of their own; none: an error")
    ->type_name("none|harmonic|minimum")
    ->capture_default_str()
    ->group("Materials");
  material("--void", o.voids, "A phase without bonds; those called void, pore, lumen or air when not given", "PHASE");

  const auto bond = [](CLI::Option* option) { return option->group("Bonds"); };
  bond(command.add_option("--horizon", o.horizon, "Length of the longest bonds, in pixels: 1 to 8"))
    ->type_name("NUMBER")
    ->capture_default_str();
  bond(command.add_option("--continuum", o.continuum, "plane-stress for pictures, space for volumes when not given"))
    ->type_name("plane-stress|plane-strain|space");
  bond(command.add_option("--micromodulus", o.micromodulus,
         use == BondUse::Stiffness
           ? "Stiffness of bonds as in the literature, or exact for E along the axes of this lattice, or in every "
             "direction; isotropic when not given"
           : "Stiffness of bonds as in the literature, or exact for E along the axes of this lattice, or in every "
             "direction; when not given, continuum for pictures, isotropic for volumes"))
    ->type_name("continuum|lattice|isotropic");
  bond(command.add_option("--void-bonds", o.voidBonds, "Bonds that cross a thin void"))
    ->type_name("keep|cut")
    ->capture_default_str();
  bond(command.add_flag("--surface-correction", o.surfaceCorrection, "Stiffer bonds near free surfaces"));
  if (use == BondUse::Load)
  {
    bond(command.add_flag("--large-strains", o.largeStrains, "Exact for large rotations, instead of linear"));
  }
  bond(command.add_option("--notch", o.notches,
         "A cut from point to point, y upwards, in metres or with a unit; of a volume a corner and two edges"))
    ->type_name("X1,Y1,X2,Y2")
    ->allow_extra_args(false);
  if (use != BondUse::Stiffness)
  {
    bond(command.add_option("--periodic", o.periodic, "Axes at whose end the sample begins again, as x; none"))
      ->type_name("AXES");
  }
  bond(command.add_option("--refine", o.refine, "Split every pixel into N × N (× N)"))
    ->type_name("N")
    ->capture_default_str();
  bond(command.add_option("--threads", o.threads, "Threads of each process"))
    ->type_name("NUMBER")
    ->capture_default_str();
}

void applyBonds(const BondOptions& o, vtkBondAlgorithm* filter)
{
  for (const Table& table : tables(o))
  {
    for (const std::string& text : listItems(table.texts))
    {
      const auto [pair, number] = keyValue(table.option, text, "PAIR=VALUE");
      const auto value = table.read(number);
      if (!value || !(*value > 0) || !std::isfinite(*value))
      {
        throw ParameterError(fmt::format("{} {}: '{}' is not a positive number", table.option, text, number),
          fmt::format("write it as {} {}=VALUE, in SI units{}", table.option, pair, unitsOf(table.option)));
      }
      if (!plausible(*value))
      {
        throw ParameterError(fmt::format("{} {}: {} is not between 1e-30 and 1e30", table.option, text, *value),
          "no material has it; ratios are far below that, too");
      }
      (filter->*table.set)(pair.c_str(), *value);
    }
  }
  for (const std::string& text : listItems(o.like))
  {
    const auto [pair, other] = keyValue("--like", text, "PAIR=PAIR");
    filter->SetLike(pair.c_str(), other.c_str());
  }
  filter->SetRelativeTo(o.relativeTo);
  filter->SetMixing(static_cast<int>(oneOf("--mixing", o.mixing, mixings)));
  for (const std::string& name : o.voids)
  {
    filter->AddVoid(name.c_str());
  }
  if (!(o.horizon >= 1 && o.horizon <= 8))
  {
    throw ParameterError(
      fmt::format("--horizon {} is outside 1 to 8", o.horizon), "3 is usual; 2 is strongly anisotropic");
  }
  filter->SetHorizon(o.horizon);
  if (!o.continuum.empty())
  {
    filter->SetContinuum(1 + static_cast<int>(oneOf("--continuum", o.continuum, continua)));
  }
  if (!o.micromodulus.empty())
  {
    filter->SetMicromodulus(static_cast<int>(oneOf("--micromodulus", o.micromodulus, micromoduli)));
  }
  filter->SetCutVoidBonds(oneOf("--void-bonds", o.voidBonds, voidBondWords) == 1);
  filter->SetSurfaceCorrection(o.surfaceCorrection);
  filter->SetLargeStrains(o.largeStrains);
  for (const std::string& text : o.notches)
  {
    std::vector<double> p;
    for (const std::string& part : split(text, ','))
    {
      p.push_back(coordinate("--notch", part));
    }
    if (p.size() == 4)
    {
      filter->AddNotch(p[0], p[1], p[2], p[3]);
    }
    else if (p.size() == 9)
    {
      filter->AddNotchInSpace(p.data(), p.data() + 3, p.data() + 6);
    }
    else
    {
      throw ParameterError("--notch '" + text + "' has " + std::to_string(p.size()) + " numbers",
        "a picture takes X1,Y1,X2,Y2, a volume a corner and two edges: 9 numbers");
    }
  }
  filter->SetPeriodic(parsePeriodic(o.periodic).data());
  if (o.refine < 1)
  {
    throw ParameterError(fmt::format("--refine {} is below 1", o.refine), "every pixel becomes N × N");
  }
  checkThreads(o.threads);
  filter->SetThreads(o.threads);
}

BondSample loadBondSample(Session& session, const PictureOptions& picture, const BondOptions& o)
{
  Sample sample = loadSample(picture,
    [&](const Lattice& lattice)
    {
      const double need = peridynamics::leastElasticBytes(lattice, o.horizon, o.refine);
      if (const auto available = static_cast<double>(availableMemory()); need > available)
      {
        throw MemoryError(fmt::format("the bonds and displacements of {} {} at refinement {} need {} of memory at "
                                      "least, and {} are free",
                            sizeText(lattice.size, lattice.dimension), lattice.dimension == 3 ? "voxels" : "pixels",
                            o.refine, bytesText(need), bytesText(available)),
          "take a smaller --window or --refine");
      }
    });
  Session::checkInterrupt();
  checkNames(o, sample.image.phases.names());
  if (sample.pixelSizeSource == "none" && (!o.density.empty() || !o.fractureEnergy.empty() || !o.toughness.empty()))
  {
    throw ParameterError(fmt::format("{} needs the size of a pixel, which '{}' does not tell",
                           !o.density.empty()      ? "motion"
                             : o.toughness.empty() ? "--fracture-energy"
                                                   : "--toughness",
                           picture.file),
      std::string("add --pixel-size, such as --pixel-size 0.5um") +
        (o.density.empty() ? "; or give --critical-stretch" : ""));
  }
  tellLowToughness(session, o);
  BondSample result;
  result.pixelSizeSource = sample.pixelSizeSource;
  result.provenance = sample.provenance;
  tellDoubts(session, sample);
  const std::vector<std::int32_t> grains = loadGrains(picture, sample);
  const Lattice lattice = sample.image.lattice;
  result.image = toImageData(o.refine > 1 ? refine(sample.image, o.refine) : std::move(sample.image));
  if (!grains.empty())
  {
    result.image->GetPointData()->AddArray(grainArray(grains, lattice, o.refine));
  }
  setFieldText(result.image, "pixel_size_source", sample.pixelSizeSource);
  setProvenance(result.image, sample.provenance);
  result.image->GetExtent(result.extent.data());
  return result;
}

BondRun bondRun(Session& session, vtkBondAlgorithm* filter, const PictureOptions& picture, const BondOptions& options,
  const BondSample& sample, const std::string& commandLine)
{
  (void)VtkMessages::takeWarnings(); // the same as in the field data
  BondRun run;
  run.image = vtkImageData::SafeDownCast(filter->GetOutputDataObject(0));
  for (const std::string& warning : fieldTexts(run.image, "warnings"))
  {
    session.warn(warning);
  }
  run.file = picture.file;
  run.pixelSizeSource = sample.pixelSizeSource;
  run.provenance = recordRun(commandLine, picture.file, sample.provenance);
  run.refine = options.refine;
  run.threads = options.threads;
  run.ranks = session.ranks();
  return run;
}

void runBonds(Session& session, vtkBondAlgorithm* filter, const BondSample& sample, const char* what)
{
  std::array<int, 6> extent = sample.extent;
  session.broadcast(extent);
  const auto image = sample.image ? sample.image : vtkSmartPointer<vtkImageData>::New();
  runFilterOnRanks(session, filter, image, extent, what);
  session.onRoot( // a mistake is one on every rank, and told once
    [&]
    {
      if (vtkImageData::SafeDownCast(filter->GetOutputDataObject(0))->GetNumberOfPoints() > 0)
      {
        return;
      }
      throwFailure(filter->GetFailure());
    });
}

} // namespace lamella::cli
