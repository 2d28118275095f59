#include "DiffusionFields.h"

#include "DiffusionRun.h"
#include "GridFile.h"

#include "vtkLatticeConversion.h"

#include <vtkImageData.h>
#include <vtkPointData.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace lamella::cli
{

Fields takeFields(const Session& session, const lbm::SteadyDiffusion& solver, int axis, const Lattice& lattice,
  const Block& block, const std::string& quantity)
{
  const bool alone = session.ranks() == 1;
  const auto take = [&](int components, const auto& read)
  {
    const auto array = vtkSmartPointer<vtkDoubleArray>::New();
    array->SetNumberOfComponents(components);
    std::span<double> whole;
    if (session.root())
    {
      array->SetNumberOfTuples(lattice.count());
      whole = { array->GetPointer(0), static_cast<std::size_t>(array->GetNumberOfValues()) };
    }
    std::vector<double> part(alone ? 0 : static_cast<std::size_t>(block.count() * components));
    const std::span<double> out = alone ? whole : std::span<double>(part);
    read(out);
    // The solver has its 1 at the low end of y, which is the bottom of a picture.
    if (lattice.dimension == 2 && axis == 1)
    {
      std::transform(out.begin(), out.end(), out.begin(),
        [&](double v)
        {
          return components == 1 ? 1 - v : 0 - v; /* never -0 */
        });
    }
    if (!alone)
    {
      gather(session, lattice, block, part, whole, components);
    }
    return array;
  };
  Fields fields;
  fields.value = take(1, [&](std::span<double> out) { solver.value(out); });
  fields.flux = take(3, [&](std::span<double> out) { solver.flux(out); });
  fields.value->SetName(quantity.c_str());
  describe(fields.value, "1", quantity + ", 1 at the inlet and 0 at the outlet", "lamella diffusion");
  fields.flux->SetName("flux");
  describe(fields.flux, "conductivity/m", "flux of " + quantity + ", -D grad u", "lamella diffusion");
  return fields;
}

void writeFields(
  const DiffusionReport& report, const lbm::DiffusionAnswer& answer, Fields fields, const OutputFile& file)
{
  const auto image = toImageData(refine(report.sample->image, answer.refinement));
  const std::string quantity = fields.value->GetName();
  image->GetPointData()->AddArray(std::exchange(fields.value, nullptr));
  image->GetPointData()->AddArray(std::exchange(fields.flux, nullptr));
  image->GetPointData()->SetActiveScalars(quantity.c_str());
  image->GetPointData()->SetActiveVectors("flux");

  const auto byAxis = [&](double value)
  {
    std::array<double, 3> numbers{};
    numbers.fill(std::numeric_limits<double>::quiet_NaN());
    numbers[static_cast<std::size_t>(answer.axis)] = value;
    return numbers;
  };
  const auto& result = answer.result;
  setFieldNumbers(image, "effective_conductivity", tensorOf({ answer }, report.sample->image.lattice.dimension));
  setFieldNumbers(image, "estimated_error", std::array{ answer.error.relative });
  setFieldNumbers(image, "estimated_error_by_direction", byAxis(answer.error.relative));
  setFieldNumbers(image, "lattice_error", std::array{ answer.error.lattice });
  setFieldNumbers(image, "picture_error", std::array{ answer.error.picture });
  setFieldNumbers(image, "extrapolated_conductivity", byAxis(answer.error.extrapolated));
  setFieldNumbers(image, "bounds",
    std::array{ report.bounds.series, report.bounds.hashinShtrikmanLower, report.bounds.hashinShtrikmanUpper,
      report.bounds.parallel });
  setFieldNumbers(image, "balance", byAxis(result.balance));
  setFieldNumbers(image, "iterations", byAxis(result.iterations));
  setFieldNumbers(image, "stored_nodes", byAxis(static_cast<double>(result.stored)));
  setFieldNumbers(image, "skipped_nodes", byAxis(static_cast<double>(result.skipped)));
  setFieldNumbers(image, "phase_conductivity", report.conductivity);
  if (!report.across.empty())
  {
    setFieldNumbers(image, "phase_conductivity_across", report.across);
  }
  setFieldNumbers(image, "phase_fraction", report.fractions);
  setFieldText(image, "phase_array", "phase");
  setFieldText(image, "direction", axisNames[answer.axis]);
  setFieldText(image, "sides", report.options.steady.sides == lbm::Sides::Periodic ? "periodic" : "insulated");
  setFieldText(image, "lattice", lbm::name(report.options.steady.stencil));
  setFieldText(image, "quantity", quantity);
  setFieldText(image, "pixel_size_source", report.sample->pixelSizeSource);
  setProvenance(image, io::toJson(report.provenance));
  writeGrid(image, file);
}

} // namespace lamella::cli
