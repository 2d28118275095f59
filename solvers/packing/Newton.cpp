#include "packing/BlockCholesky.h"
#include "packing/Enthalpy.h"
#include "packing/Relaxation.h"

#include "core/Error.h"

#include <algorithm>
#include <cmath>

namespace lamella::packing
{

template <int Dim>
RelaxationResult newton(GrainSystem<Dim>& g, const RelaxationOptions& options)
{
  Enthalpy<Dim> enthalpy(g, options);
  BlockCholesky<Dim> factors;
  const double farthest = 0.1; // no grain further than a tenth of a diameter
  double shift = 1e-6;
  enthalpy.evaluate();
  RelaxationResult result;
  for (; result.steps < options.maxSteps; ++result.steps)
  {
    const Eigen::VectorXd force = enthalpy.force();
    if (enthalpy.unbalanced() <= options.tolerance && enthalpy.pressureError() <= options.tolerance)
    {
      result.atRest = true;
      break;
    }
    if (options.interrupted && options.interrupted())
      throw Cancelled();
    const BlockMatrix<Dim>& hessian = enthalpy.hessian();
    if (enthalpy.linksChanged())
      factors.analyse(g.count(), hessian.links);
    for (; !factors.factorise(hessian, shift); shift *= 10)
      if (shift > 1e3)
      {
        g.computeForces(0);
        return result;
      }
    Eigen::VectorXd step = factors.solve(force, enthalpy.boxUnknowns());
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > farthest)
      step *= farthest / longest;

    // Contacts open and close on the way: find where the slope along the step vanishes, nearly.
    const auto startPosition = g.position;
    const auto startBox = g.box;
    const double slope = force.dot(step);
    double low = 0;
    double high = 0;
    double slopeLow = slope;
    double slopeHigh = 0;
    double length = 1;
    for (int trial = 0; trial < 12; ++trial)
    {
      g.position = startPosition;
      g.box = startBox;
      enthalpy.move(length * step);
      enthalpy.evaluate();
      const double here = enthalpy.force().dot(step);
      if (std::abs(here) <= 0.3 * slope)
        break;
      if (here > 0)
      {
        low = length;
        slopeLow = here;
        if (high == 0 && length >= 4)
          break;
      }
      else
      {
        high = length;
        slopeHigh = here;
      }
      length = high == 0 ? 2 * length : low + (high - low) * std::clamp(slopeLow / (slopeLow - slopeHigh), 0.1, 0.9);
    }
    shift = length >= 0.5 ? std::max(shift * 0.1, 1e-12) : std::min(shift * 3, 1e3);
  }
  g.computeForces(0);
  return result;
}

template RelaxationResult newton<2>(GrainSystem<2>&, const RelaxationOptions&);
template RelaxationResult newton<3>(GrainSystem<3>&, const RelaxationOptions&);

} // namespace lamella::packing
