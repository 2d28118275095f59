// Equilibrium by adaptive dynamic relaxation: to compare with.
#include "peridynamics/Equilibrium.h"

#include "core/Error.h"
#include "peridynamics/BondForces.h"
#include "peridynamics/multigrid/LevelKernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lamella::peridynamics
{

// A diagonal mass that makes a time step of one stable, damping from the Rayleigh quotient
// of the current motion.
void Equilibrium::relaxDynamically(
  NodeField<double>& u, const NodeField<double>* load, double reference, EquilibriumResult& result)
{
  const NodeLayout& l = bonds_.layout();
  NodeField<float> blocks(l, blockEntries(l.dimension));
  diagonalBlocks(bonds_, blocks);
  const auto mass = [&](std::int64_t i)
  {
    double trace = 0;
    for (int c = 0; c < l.dimension; ++c)
      trace += static_cast<double>(blocks.component(c)[i]);
    return 0.5 * 1.1 * trace; // a quarter of the sum of absolute values of a row of K, at most twice the trace
  };
  NodeField<double> v(l);
  NodeField<double> f(l);
  NodeField<double> last(l);
  const double target = options_.tolerance * reference;
  for (std::int64_t step = 0;; ++step)
  {
    residual(u, load, f, false);
    const double size = norm(f);
    result.residual = size / reference;
    result.iterations = step;
    if (size <= target)
      return;
    if (step >= options_.maxIterations || !std::isfinite(size))
      throw DivergenceError(fmt::format("dynamic relaxation: the residual force is {:.1e} of the load after {} steps",
                              size / reference, step),
        "use the multigrid solver");
    double numerator = 0;
    double denominator = 0;
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
          for (int c = 0; c < l.dimension; ++c)
          {
            const double w = v.component(c)[i];
            if (step > 0 && w != 0)
              numerator -= w * w * (f.component(c)[i] - last.component(c)[i]) / (mass(i) * w);
            denominator += w * w;
          }
    std::array<double, 2> sums{ numerator, denominator };
    bonds_.communicator().sum(sums);
    const double quotient = sums[1] > 0 ? std::clamp(sums[0] / sums[1], 0.0, 4.0) : 0.0;
    const double damping = std::min(2 * std::sqrt(quotient), 1.9);
    for (std::int64_t z = 0; z < l.size[2]; ++z)
      for (std::int64_t y = 0; y < l.size[1]; ++y)
        for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        {
          const double m = mass(i);
          for (int c = 0; c < l.dimension; ++c)
          {
            double& w = v.component(c)[i];
            const double a = m > 0 ? f.component(c)[i] / m : 0;
            w = step == 0 ? a / 2 : ((2 - damping) * w + 2 * a) / (2 + damping);
            u.component(c)[i] += w;
            last.component(c)[i] = f.component(c)[i];
          }
        }
    if (step % 100 == 0)
      report(std::clamp(std::log(result.residual) / std::log(options_.tolerance), 0.0, 1.0));
  }
}

} // namespace lamella::peridynamics
