#pragma once

#include "LatticeBoltzmann.h"
#include "lattice/Error.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

/// Odd pictures, and how stepping to rest ends on them.
namespace lamella::test
{

struct OddPicture
{
  std::string name;
  PhaseImage image; ///< of phases 0 and 1
};

inline PhaseImage paint(std::int64_t nx, std::int64_t ny, std::int64_t nz,
  const std::function<bool(std::int64_t, std::int64_t, std::int64_t)>& second)
{
  PhaseImage image = noise(nx, ny, nz, -1.0, 1); // all of the first phase
  for (std::int64_t z = 0, i = 0; z < nz; ++z)
    for (std::int64_t y = 0; y < ny; ++y)
      for (std::int64_t x = 0; x < nx; ++x, ++i)
        image.phase[static_cast<std::size_t>(i)] = second(x, y, z) ? 1 : 0;
  return image;
}

/// Along x, the direction of the flux.
inline std::vector<OddPicture> oddPictures(int dimension)
{
  const std::int64_t deep = dimension == 3 ? 3 : 1;
  // down at x = 2, back up at x = 6: every link of it counts
  const auto path = [](std::int64_t x, std::int64_t y, std::int64_t z)
  { return z == 0 && (x == 2 || x == 6 ? y >= 1 && y <= 4 : y == (x > 2 && x < 6 ? 4 : 1)); };
  const auto middle = [](std::int64_t x, std::int64_t, std::int64_t) { return x >= 4; };
  return {
    { "one wide", paint(1, 8, deep, [](std::int64_t, std::int64_t y, std::int64_t) { return y >= 4; }) },
    { "one high", paint(8, 1, deep, middle) },
    { "first alone", paint(8, 6, deep, [](auto...) { return false; }) },
    { "second alone", paint(8, 6, deep, [](auto...) { return true; }) },
    { "single path", paint(9, 6, deep, path) },
    { "prime sizes", noise(11, 7, dimension == 3 ? 5 : 1, 0.5, 5) },
    { "checkerboard",
      paint(8, 6, deep, [](std::int64_t x, std::int64_t y, std::int64_t z) { return (x + y + z) % 2 == 1; }) },
    { "line", paint(8, 6, deep, [](std::int64_t, std::int64_t y, std::int64_t z) { return y == 2 && z == 0; }) },
    { "layers", paint(8, 3, deep, middle) },
  };
}

/// The picture and its mirror image in the planes of its outer nodes: in this cell of a medium the values on those
/// planes are given and nothing crosses those along the flux, as bgk has it.
inline PhaseImage mirrored(const PhaseImage& image)
{
  const auto& n = image.lattice.size;
  const auto cell = [&](std::size_t a) { return n[a] > 1 ? 2 * (n[a] - 1) : 1; };
  const auto fold = [&](std::int64_t p, std::size_t a) { return std::min(p, cell(a) - p); };
  return paint(cell(0), cell(1), cell(2),
    [&](std::int64_t x, std::int64_t y, std::int64_t z)
    { return image.phase[static_cast<std::size_t>(image.lattice.index(fold(x, 0), fold(y, 1), fold(z, 2)))] == 1; });
}

enum class Verdict
{
  Right,   ///< as near to the steady solver as was asked for
  Warned,  ///< not so near, and it said that it would not be
  Refused, ///< by an exception of ours
  Wrong    ///< not so near, and nothing was said
};

struct Outcome
{
  Verdict verdict = Verdict::Wrong;
  double error = 0; ///< relative, of the effective value
  std::string what; ///< warning or message
};

struct Trial
{
  lbm::Stencil stencil = lbm::Stencil::D2Q5;
  Collision collision = Collision::TRT;
  double relaxation = 0.5;
  std::vector<double> diffusivity;
  double tolerance = 1e-6;      ///< of the flux: RestOptions
  double accuracy = 1e-5;       ///< of the effective value, to be right
  std::int64_t maxSteps = 2000; ///<
};

/// Steps to rest along x between faces of value 1 and 0 and insulated sides.
inline Outcome attempt(const PhaseImage& image, const Trial& t)
{
  Outcome out;
  const bool diagonal = t.stencil == lbm::Stencil::D2Q9 || t.stencil == lbm::Stencil::D3Q19;
  try
  {
    SteppingOptions o;
    o.stencil = t.stencil;
    o.collision = t.collision;
    o.relaxation = t.relaxation;
    o.steady = true;
    auto solver = stepper(image, t.diffusivity, o);
    out.what = solver.warning();
    const auto r = solver.rest({ .tolerance = t.tolerance, .maxSteps = t.maxSteps });
    const double k = t.collision == Collision::BGK
      ? solve(mirrored(image), t.diffusivity, { .sides = lbm::Sides::Periodic, .diagonal = diagonal }).effective[0]
      : solve(image, t.diffusivity, { .diagonal = diagonal }).effective[0];
    out.error = r.effective / k - 1;
    const double worst =
      std::max({ std::fabs(out.error), std::fabs(r.inletFlux / k - 1), std::fabs(r.outletFlux / k - 1) });
    out.verdict = worst <= t.accuracy ? Verdict::Right : out.what.empty() ? Verdict::Wrong : Verdict::Warned;
  }
  catch (const Error& e)
  {
    out.verdict = Verdict::Refused;
    out.what = e.what();
  }
  return out;
}

} // namespace lamella::test
