// How near plain voxels come to the material, and voxels that know their share of a phase: simple cubic array of
// spheres, by contrast, fraction and nodes across; and 2 × fine − coarse of the last two.
//   fraction=0.1,0.3,0.4  contrast=1000,10,0.1,0.001 (sphere over matrix)  size=16,32,64
#include "Keys.h"
#include "Table.h"

#include "../tests/SphereShares.h"

#include "lbm/Shares.h"
#include "lbm/SteadyDiffusion.h"

#include <cmath>
#include <limits>
#include <optional>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

/// Values of McPhedran & McKenzie (1978), as far as digits are printed.
std::optional<double> published(double fraction, double contrast)
{
  struct Value
  {
    double fraction, contrast, value;
  };
  for (const Value& v : { Value{ 0.1, 10, 1.2433 }, Value{ 0.3, 10, 1.8877 }, Value{ 0.4, 10, 2.3644 } })
    if (v.fraction == fraction && v.contrast == contrast)
      return v.value;
  return {};
}

double value(std::int64_t n, const std::vector<double>& share, double contrast, std::optional<lbm::AcrossSurface> rule)
{
  constexpr int levels = 255;
  const Lattice lattice = makeLattice(n, n, n, 3, 1.0 / static_cast<double>(n));
  lbm::SteadyOptions options;
  options.stencil = lbm::Stencil::D3Q7;
  options.sides = lbm::Sides::Mixed;
  options.tolerance = 1e-7;
  options.fieldTolerance = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> id(share.size());
  std::vector<double> conductivity{ 1, contrast };
  for (std::size_t i = 0; i < id.size(); ++i)
    id[i] = static_cast<std::uint8_t>(rule ? std::lround(share[i] * (levels - 1)) : (share[i] >= 0.5 ? 1 : 0));
  if (rule)
  {
    std::vector<double> of(levels);
    for (int i = 0; i < levels; ++i)
      of[static_cast<std::size_t>(i)] = i / static_cast<double>(levels - 1);
    auto pairs = std::make_shared<lbm::PairTable>(lbm::shareLinks(of, 1, contrast, *rule));
    conductivity.clear();
    for (std::size_t i = 0; i < levels; ++i)
      conductivity.push_back(pairs->link[i * levels + i]);
    options.pairs = std::move(pairs);
  }
  lbm::SteadyDiffusion solver(lattice, decompose(lattice, MPI_COMM_SELF), id, conductivity, options);
  return solver.solve(0).effective[0];
}

void run(const Keys& keys)
{
  const std::vector<double> sizes =
    list(keys, "size", 0).front() > 0 ? list(keys, "size", 0) : std::vector{ 16.0, 32.0, 64.0 };
  const std::vector<double> fractions =
    keys.contains("fraction") ? list(keys, "fraction", 0) : std::vector{ 0.1, 0.3, 0.4 };
  const std::vector<double> contrasts =
    keys.contains("contrast") ? list(keys, "contrast", 0) : std::vector{ 1000.0, 10.0, 0.1, 0.001 };
  Table table(keys, "surface-shares", "spheres", "fraction,contrast,way,nodes,value,published");
  for (const double fraction : fractions)
    for (const double contrast : contrasts)
    {
      const auto exact = published(fraction, contrast);
      fmt::print("spheres of {:g}, {:g} times the matrix{}\n", fraction, contrast,
        exact ? fmt::format(", published {:.4f}", *exact) : "");
      // the matrix leads across: flux runs in it where it conducts better
      const lbm::AcrossSurface rule = lbm::ruleFor(contrast < 1);
      for (const bool shares : { false, true })
      {
        std::vector<double> values;
        fmt::print("  {:<8}", shares ? "shares" : "voxels");
        for (const double size : sizes)
        {
          const auto n = static_cast<std::int64_t>(size);
          values.push_back(
            value(n, test::sphereShares(n, fraction), contrast, shares ? std::optional(rule) : std::nullopt));
          fmt::print(" {:>9.5f}", values.back());
          table.line(fraction, contrast, shares ? "shares" : "voxels", n, values.back(), exact.value_or(std::nan("")));
        }
        const double last = values.size() > 1 ? 2 * values.back() - values[values.size() - 2] : values.back();
        fmt::print("  extrapolated {:>9.5f}", last);
        if (exact)
          fmt::print("  errors {:+.3f} % and {:+.3f} %", 100 * (values.back() / *exact - 1), 100 * (last / *exact - 1));
        fmt::print("\n");
        std::fflush(stdout);
      }
    }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv, run);
}
