#include "MicrographPlan.h"

#include "Text.h"

#include "lattice/Error.h"

#include <fmt/format.h>

#include <cmath>

namespace lamella::cli
{

namespace
{

const std::vector<std::string> lamellaWords{ "growth", "constant", "labels", "none" };

} // namespace

Plan planOf(const MicrographCommandOptions& o)
{
  Plan plan;
  plan.lamella = lamellaWords[oneOf("--lamella", o.lamella, lamellaWords)];
  plan.how.method =
    plan.lamella == "constant" ? micrograph::LamellaMethod::Constant : micrograph::LamellaMethod::Growth;
  const bool made = plan.lamella == "growth" || plan.lamella == "constant";
  if (!o.thickness.empty())
  {
    plan.how.thickness = lengthInMetres("--lamella-thickness", o.thickness);
  }
  if (!o.radius.empty())
  {
    plan.how.radius = toNumber(o.radius) == 0.0 ? 0.0 : lengthInMetres("--lamella-radius", o.radius);
  }
  if ((plan.how.thickness && !made) || (plan.how.radius && plan.lamella != "growth"))
  {
    throw ParameterError(
      fmt::format("--lamella-{} with --lamella {}", plan.how.thickness && !made ? "thickness" : "radius", plan.lamella),
      plan.how.thickness && !made ? "it is for growth and constant" : "it is for growth");
  }
  if (!o.lamellaPhase.empty() && plan.lamella != "labels")
  {
    throw ParameterError("--lamella-phase with --lamella " + plan.lamella, "it is for --lamella labels");
  }
  if (!(o.horizon >= 0) || !std::isfinite(o.horizon))
  {
    throw ParameterError(fmt::format("--horizon {:g} is below 0", o.horizon), "give a number of nodes, such as 3");
  }
  plan.how.horizon = o.horizon;
  if (!o.spacing.empty())
  {
    plan.spacing = lengthInMetres("--spacing", o.spacing);
  }
  if (!o.diffusion.given("conductivity") && o.diffusion.given("target-error"))
  {
    throw ParameterError("--target-error without --conductivity", "say what lumen and wall conduct");
  }
  if (o.overlayWidth != 0 && (o.overlayWidth < 100 || o.overlayWidth > 20000))
  {
    throw ParameterError(
      fmt::format("--overlay-width {} is outside 100 to 20000", o.overlayWidth), "leave it out to have it chosen");
  }
  return plan;
}

} // namespace lamella::cli
