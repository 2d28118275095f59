// What diffusion stands: every method on odd pictures, contrasts from 10⁻⁶ to 10⁶ and voids, and every relaxation, each
// right, slow (it says that it wants more steps), warned about, refused, or wrong without a word. study=
//   stepping  lattice Boltzmann to rest, one relaxation time and two, τ − ½ from 10⁻³ to 10², against the steady solver
//             (one relaxation time: on the mirrored picture, whose faces and mirrors are on the outer nodes)
//   long      the same in a closed box: mean and Σ u² after many steps
//   steady    the steady solver, by multigrid and by algebraic multigrid, against the dense system
//   outlines  lattices of outlines, against exact values and their own error bars
// none: all. Keys: quick, steps=NUMBER that a run may take (20000; quick: 2000), long=NUMBER of steps of a long run
// (100000; quick: 1000), output=FOLDER for CSV files (default results/bench-diffusion-stability).
#include "Keys.h"
#include "Table.h"

#include "../tests/verification/DiffusionAtlas.h"
#include "../tests/verification/DiskArray.h"

#include "lbm/ContourDiffusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::benchmark;
using namespace lamella::test;

// Of the first phase over the second.
constexpr std::array<double, 8> contrasts{ 0, 1e-6, 1e-4, 1e-2, 1, 1e2, 1e4, 1e6 };
constexpr std::array<double, 7> relaxations{ 1e-3, 1e-2, 0.1, 0.5, 1, 10, 100 };

double small(const Keys& keys, const char* key, double usual, double quick)
{
  return number(keys, key, keys.contains("quick") ? quick : usual);
}

std::string quoted(std::string text)
{
  std::replace(text.begin(), text.end(), '"', '\'');
  return fmt::format("\"{}\"", text);
}

/// A table of verdicts, and how many of each.
class Atlas
{
public:
  Atlas(const Keys& keys, const char* study)
    : study_(study)
    , table_(keys, "diffusion-stability", study, "method,lattice,picture,contrast,column,verdict,error,what")
  {
  }
  ~Atlas()
  {
    fmt::print("{}:", study_);
    for (const auto& [verdict, count] : counts_)
      fmt::print(" {} {}", count, name(verdict));
    fmt::print("\n");
    std::fflush(stdout);
  }

  /// @param column what the cells of a picture differ in besides the contrast
  void line(const std::string& method, const char* lattice, const std::string& picture, double contrast,
    const std::string& column, const Outcome& o)
  {
    table_.line(method, lattice, picture, contrast, column, name(o.verdict), o.error, quoted(o.what));
    ++counts_[o.verdict];
    if (o.verdict == Verdict::Wrong)
      fmt::print("wrong: {} {}, {}, {} : 1, {}: off by {:.2e}\n", method, lattice, picture, contrast, column, o.error);
  }

private:
  std::string study_;
  Table table_;
  std::map<Verdict, int> counts_;
};

template <class F>
void forAll(F&& f)
{
  for (const auto stencil : everyLattice)
    for (const auto& picture : oddPictures(dimensionOf(stencil)))
      for (const double contrast : contrasts)
        f(stencil, picture, contrast);
}

void stepping(const Keys& keys)
{
  Atlas atlas(keys, "stepping");
  const auto steps = static_cast<std::int64_t>(small(keys, "steps", 2e4, 2e3));
  for (const auto collision : { Collision::BGK, Collision::TRT })
    forAll(
      [&](lbm::Stencil stencil, const OddPicture& picture, double contrast)
      {
        for (const double relaxation : relaxations)
          atlas.line(name(collision), name(stencil), picture.name, contrast, fmt::format("{}", relaxation),
            attempt(picture.image,
              { .stencil = stencil,
                .collision = collision,
                .relaxation = relaxation,
                .diffusivity = { contrast, 1.0 },
                .maxSteps = steps }));
      });
}

/// A closed box from a random field: its mean stays, Σ u² never exceeds what it was (on mirrors of one relaxation time
/// outer nodes count half along each axis).
void longRuns(const Keys& keys)
{
  Atlas atlas(keys, "long");
  const auto steps = 2 * static_cast<std::int64_t>(small(keys, "long", 1e5, 1e3) / 2);
  for (const auto collision : { Collision::BGK, Collision::TRT })
    for (const auto stencil : everyLattice)
    {
      const auto image = dimensionOf(stencil) == 2 ? noise(11, 7, 1, 0.5, 5) : noise(5, 3, 2, 0.5, 3);
      std::mt19937_64 random(7);
      const auto initial = fieldOf(decompose(image.lattice, MPI_COMM_SELF),
        [&](double, double, double) { return static_cast<double>(random() >> 11) * 0x1p-53; });
      for (const double contrast : contrasts)
        for (const double relaxation : relaxations)
          atlas.line(name(collision), name(stencil), "long run", contrast, fmt::format("{}", relaxation),
            judged(
              [&](Outcome& out)
              {
                SteppingOptions o;
                o.stencil = stencil;
                o.collision = collision;
                o.relaxation = relaxation;
                o.sides.fill(Boundary::Insulated);
                auto solver = stepper(image, { contrast, 1.0 }, o);
                solver.start(initial);
                const auto squares = [&]
                {
                  double sum = 0;
                  for (const double v : valueOf(solver, image.lattice.count()))
                    sum += std::isnan(v) ? 0.0 : v * v;
                  return sum;
                };
                const double mean = solver.mean();
                const double most = squares() * (collision == Collision::BGK ? 1 << dimensionOf(stencil) : 1);
                solver.advance(steps);
                out.error = std::max(std::fabs(solver.mean() / mean - 1), squares() / most - 1);
                out.verdict = out.error < 1e-10 ? Verdict::Right : Verdict::Wrong; // round-off of so many steps
              }));
    }
}

void steady(const Keys& keys)
{
  Atlas atlas(keys, "steady");
  forAll(
    [&](lbm::Stencil stencil, const OddPicture& picture, double contrast)
    {
      for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic })
        for (const auto method : { lbm::Method::Multigrid, lbm::Method::AlgebraicMultigrid })
        {
          Case c{ .sides = sides, .method = method, .tolerance = 1e-8 };
          c.diagonal = stencil == lbm::Stencil::D2Q9 || stencil == lbm::Stencil::D3Q19;
          atlas.line("steady", name(stencil), picture.name, contrast,
            fmt::format("{} {}", sides == lbm::Sides::Periodic ? "periodic" : "insulated", name(method)),
            attemptSteady(picture.image, { contrast, 1.0 }, c, 1e-7));
        }
    });
}

/// A picture of outlines with its exact value along x, of walls that conduct 1.
struct OutlinedPicture
{
  const char* name;
  micrograph::ContourSet outlines;
  double (*exact)(double lumen);
};

constexpr double layer = 0.37; // of a box that is lumen, in layers
constexpr double thin = 0.998;

micrograph::ContourSet layers(double share, bool across)
{
  const double low = 0.5 - share / 2;
  const double high = 0.5 + share / 2;
  micrograph::ContourSet set{ { 1, 1 }, {} };
  const auto point = [&](double along, double beside) {
    return across ? micrograph::Point{ along, beside } : micrograph::Point{ 1 - beside, along };
  };
  // lumen on the left of each chain
  set.contours.push_back({ { point(low, 1), point(low, 0) }, false, 1 });
  set.contours.push_back({ { point(high, 0), point(high, 1) }, false, 1 });
  return set;
}

double series(double share, double lumen)
{
  return lumen > 0 ? 1 / (share / lumen + 1 - share) : 0.0;
}

std::vector<OutlinedPicture> outlinedPictures()
{
  return {
    { "no lumen", { { 1, 1 }, {} }, [](double) { return 1.0; } },
    { "disk 0.1", squareOfDisk(0.1, 1), [](double s) { return squareArrayOfDisks(0.1, s); } },
    { "disk 0.6", squareOfDisk(0.6, 1), [](double s) { return squareArrayOfDisks(0.6, s); } },
    { "disk 0.7", squareOfDisk(0.7, 1), [](double s) { return squareArrayOfDisks(0.7, s, 80); } },
    { "layer across", layers(layer, true), [](double s) { return series(layer, s); } },
    { "layer along", layers(layer, false), [](double s) { return layer * s + 1 - layer; } },
    { "thin walls across", layers(thin, true), [](double s) { return series(thin, s); } },
    { "thin walls along", layers(thin, false), [](double s) { return thin * s + 1 - thin; } },
  };
}

/// Right: within 1 %. Warned: no more off than three times the error bar says, which is what its median has over.
void outlines(const Keys& keys)
{
  constexpr double fine = 0.01;
  constexpr double slack = 3;
  Atlas atlas(keys, "outlines");
  for (const OutlinedPicture& picture : outlinedPictures())
    for (const double contrast : contrasts)
      for (const int nodes : { 4, 7, 16, 31, 64, 128 })
        atlas.line("outlines", "d2q5", picture.name, contrast, fmt::format("{}", nodes),
          judged(
            [&](Outcome& out)
            {
              lbm::ContourStudyOptions o;
              o.spacing = 1.0 / nodes;
              o.axes = { 0 };
              o.conductivity = { contrast, 1.0 };
              const lbm::ContourAnswer a = lbm::studyContours(picture.outlines, o, MPI_COMM_SELF)[0];
              out.error = worstOf(picture.exact(contrast), { a.value });
              out.what = fmt::format("{} with error bar {:.2g}", a.value, a.error);
              out.verdict = out.error <= fine  ? Verdict::Right
                : out.error <= slack * a.error ? Verdict::Warned
                                               : Verdict::Wrong;
            }));
}

/// The pictures themselves, for the drawing's margin: first layer, rows from the top.
void pictures(const Keys& keys)
{
  Table table(keys, "diffusion-stability", "pictures", "picture,rows");
  for (const OddPicture& picture : oddPictures(2))
  {
    const auto& n = picture.image.lattice.size;
    std::string rows;
    for (std::int64_t y = n[1] - 1; y >= 0; --y)
    {
      rows += rows.empty() ? "" : "/";
      for (std::int64_t x = 0; x < n[0]; ++x)
        rows += picture.image.phase[static_cast<std::size_t>(picture.image.lattice.index(x, y))] == 0 ? '0' : '1';
    }
    table.line(picture.name, rows);
  }
}

} // namespace

int main(int argc, char** argv)
{
  return runWith(
    argc, argv,
    [](const Keys& keys)
    {
      pictures(keys);
      runStudies(keys,
        { { "stepping", [&] { stepping(keys); } }, { "long", [&] { longRuns(keys); } },
          { "steady", [&] { steady(keys); } }, { "outlines", [&] { outlines(keys); } } });
    });
}
