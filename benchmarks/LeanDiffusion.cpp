// Steady conduction of volumes: the lean solver beside the others, by size, contrast and picture: bytes a voxel,
// iterations, seconds by the clock and of all processors, the value and how far both faces are from it.
//   size=200  kind=softwood|balls|noise  contrast=43  walls=conduct|insulate  fraction=0.4  axis=0  tolerance=1e-6
//   methods=lean-multigrid,multigrid,algebraic-multigrid  threads=1  sides=insulated|mixed|periodic  dimension=3
//   base=200 size=400: a picture and its mirror images, which have the same value   file=cube.raw: bytes instead of a
//   kind contrast=inf: one phase does not conduct
#include "Keys.h"

#include "core/Clock.h"
#include "generators/Generators.h"
#include "lbm/SteadyDiffusion.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <random>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;

PhaseImage picture(const Keys& keys)
{
  const int dimension = static_cast<int>(number(keys, "dimension", 3));
  const auto n = static_cast<std::int64_t>(number(keys, "size", 200));
  const auto base = static_cast<std::int64_t>(number(keys, "base", static_cast<double>(n)));
  const double fraction = number(keys, "fraction", 0.4);
  const std::string kind = text(keys, "kind", "softwood");
  const auto seed = static_cast<std::uint64_t>(number(keys, "seed", 1));
  PhaseImage image;
  if (const std::string file = text(keys, "file", ""); !file.empty())
  {
    // a cube of bytes, x fastest: 1 where it is not 0
    image.lattice = makeLattice(base, base, base, 3, 1.0);
    std::ifstream in(file, std::ios::binary);
    image.phase.resize(static_cast<std::size_t>(image.lattice.count()));
    in.read(reinterpret_cast<char*>(image.phase.data()), static_cast<std::streamsize>(image.phase.size()));
    for (auto& p : image.phase)
      p = p != 0 ? 1 : 0;
    if (!in)
      throw InputError("the file '" + file + "' is shorter than size^3 bytes", "give its size");
  }
  else if (kind == "softwood")
  {
    generators::SoftwoodOptions o;
    o.dimension = dimension;
    o.size = { base, base, dimension == 3 ? base : 1 };
    o.solidFraction = fraction;
    o.seed = seed;
    image = generators::softwood(o);
  }
  else
  {
    image.lattice = makeLattice(base, base, dimension == 3 ? base : 1, dimension, 1.0 / static_cast<double>(base));
    image.phase.assign(static_cast<std::size_t>(image.lattice.count()), 0);
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return std::uniform_real_distribution<double>{}(random); };
    if (kind == "noise")
      for (auto& p : image.phase)
        p = uniform() < fraction ? 1 : 0;
    else if (kind == "balls") // overlapping, until the fraction is reached
    {
      const double radius = number(keys, "radius", 8);
      std::int64_t inside = 0;
      const auto wanted = static_cast<std::int64_t>(fraction * static_cast<double>(image.lattice.count()));
      while (inside < wanted)
      {
        std::array<double, 3> c{};
        for (auto& v : c)
          v = uniform() * static_cast<double>(base);
        const auto r = static_cast<std::int64_t>(radius) + 1;
        for (std::int64_t z = -r; z <= r; ++z)
          for (std::int64_t y = -r; y <= r; ++y)
            for (std::int64_t x = -r; x <= r; ++x)
            {
              const std::array<std::int64_t, 3> p{ static_cast<std::int64_t>(c[0]) + x,
                static_cast<std::int64_t>(c[1]) + y, static_cast<std::int64_t>(c[2]) + z };
              double distance = 0;
              bool in = true;
              for (std::size_t a = 0; a < 3; ++a)
              {
                const double d = static_cast<double>(p[a]) + 0.5 - c[a];
                distance += d * d;
                in = in && p[a] >= 0 && p[a] < base;
              }
              if (!in || distance > radius * radius)
                continue;
              auto& id = image.phase[static_cast<std::size_t>(image.lattice.index(p[0], p[1], p[2]))];
              inside += id == 0 ? 1 : 0;
              id = 1;
            }
      }
    }
    else
      throw ParameterError("no kind '" + kind + "'", "one of softwood, balls, noise");
  }
  if (base == n)
    return image;
  // mirror images of it: the same value
  PhaseImage all;
  all.lattice = makeLattice(n, n, dimension == 3 ? n : 1, dimension, image.lattice.spacing);
  all.phase.resize(static_cast<std::size_t>(all.lattice.count()));
  const auto from = [&](std::int64_t i) { return i / base % 2 == 0 ? i % base : base - 1 - i % base; };
  std::size_t i = 0;
  for (std::int64_t z = 0; z < all.lattice.size[2]; ++z)
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t x = 0; x < n; ++x)
        all.phase[i++] = image.phase[static_cast<std::size_t>(image.lattice.index(from(x), from(y), from(z)))];
  return all;
}

void run(const Keys& keys)
{
  const PhaseImage image = picture(keys);
  const int axis = static_cast<int>(number(keys, "axis", 0));
  fmt::print("{} {} x {} x {}, phase 1 {:.4f}, tolerance {:.0e}, axis {}, {} threads\n", text(keys, "kind", "softwood"),
    image.lattice.size[0], image.lattice.size[1], image.lattice.size[2],
    static_cast<double>(std::count(image.phase.begin(), image.phase.end(), 1)) /
      static_cast<double>(image.phase.size()),
    number(keys, "tolerance", 1e-6), "xyz"[axis], number(keys, "threads", 1));
  fmt::print("{:<22}{:>10}{:>7}{:>8}{:>9}{:>9}{:>9}  {:<15}{:<10}{}\n", "method", "contrast", "walls", "B/voxel",
    "iterations", "s", "s CPU", "value", "error", "faces");
  for (const double contrast : list(keys, "contrast", 43))
    for (std::string methods = text(keys, "methods", "lean-multigrid,multigrid"); !methods.empty();)
    {
      const std::string name = methods.substr(0, methods.find(','));
      methods.erase(0, name.size() + 1);
      const bool insulate = text(keys, "walls", "conduct") == "insulate";
      lbm::SteadyOptions options;
      options.stencil = image.lattice.dimension == 3 ? lbm::Stencil::D3Q7 : lbm::Stencil::D2Q5;
      for (const auto method : { lbm::Method::Auto, lbm::Method::LeanMultigrid, lbm::Method::PieceMultigrid,
             lbm::Method::Multigrid, lbm::Method::AlgebraicMultigrid })
        if (name == lbm::name(method))
          options.method = method;
      const std::string sides = text(keys, "sides", "insulated");
      options.sides = sides == "periodic" ? lbm::Sides::Periodic
        : sides == "mixed"                ? lbm::Sides::Mixed
                                          : lbm::Sides::Insulated;
      options.tolerance = number(keys, "tolerance", 1e-6);
      options.fieldTolerance = number(keys, "field", std::numeric_limits<double>::infinity());
      options.threads = static_cast<int>(number(keys, "threads", 1));
      const auto start = Clock::now();
      const double cpuBefore = cpu();
      const std::vector<double> conductivity{ insulate ? 1.0 : 1 / contrast, insulate ? 1 / contrast : 1.0 };
      try
      {
        lbm::SteadyDiffusion solver(
          image.lattice, decompose(image.lattice, MPI_COMM_SELF), image.phase, conductivity, options);
        const lbm::SteadyResult r = solver.solve(axis);
        fmt::print("{:<22}{:>10g}{:>9}{:>8.2f}{:>9}{:>9.3f}{:>9.3f}  {:<15.11f}{:<10.1e}{:.1e}\n", lbm::name(r.method),
          contrast, insulate ? "insulate" : "conduct", static_cast<double>(r.bytes) / static_cast<double>(r.nodes),
          r.iterations, secondsSince(start), cpu() - cpuBefore, r.effective[static_cast<std::size_t>(axis)],
          r.solverError, r.balance);
      }
      catch (const Error& e)
      {
        fmt::print("{:<22}{:>10g}{:>9} {:.2f} s: {}\n", name, contrast, insulate ? "insulate" : "conduct",
          secondsSince(start), e.what());
      }
      std::fflush(stdout);
    }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(argc, argv, run);
}
