// Nothing fails silently: on odd pictures, at any relaxation and contrast, stepping to rest is right, not there yet and
// says so, refused by name, or (one relaxation time) warned about; the steady solver is right or refuses; and long runs
// stay bounded. `./dev bench diffusion-stability` draws all of it.
#include "DiffusionAtlas.h"

#include <gtest/gtest.h>

namespace
{

using namespace lamella;
using namespace lamella::test;

void scan(Collision collision)
{
  for (const auto stencil : everyLattice)
    for (const auto& picture : oddPictures(dimensionOf(stencil)))
      for (const double contrast : { 1.0, 0.0, 1e-2, 1e-6, 1e6 })
        for (const double relaxation : { 1e-3, 1e-2, 0.1, 0.5, 10.0, 100.0 })
        {
          const Outcome o = attempt(picture.image,
            { .stencil = stencil, .collision = collision, .relaxation = relaxation, .diffusivity = { contrast, 1.0 } });
          EXPECT_NE(o.verdict, Verdict::Wrong)
            << name(stencil) << " " << name(collision) << ", " << picture.name << ", " << contrast
            << " : 1, relaxation " << relaxation << ": off by " << o.error;
          if (collision != Collision::BGK)
            EXPECT_NE(o.verdict, Verdict::Warned) << o.what;
          // what two relaxation times refuse is a picture through which nothing leads
          if (o.verdict == Verdict::Refused && collision != Collision::BGK)
            EXPECT_EQ(contrast, 0.0) << picture.name << ": " << o.what;
          if (o.verdict == Verdict::Refused || o.verdict == Verdict::Slow)
            EXPECT_FALSE(o.what.empty());
        }
}

TEST(LatticeBoltzmannStability, TwoRelaxationTimesAreRightOrRefused)
{
  scan(Collision::TRT);
}

TEST(LatticeBoltzmannStability, OneRelaxationTimeIsRightRefusedOrWarnedAbout)
{
  scan(Collision::BGK);
}

// Every link counts: the dense system is assembled from the definition, link by link.
TEST(LatticeBoltzmannStability, SteadySolverIsRightOrRefuses)
{
  for (const auto stencil : everyLattice)
    for (const auto& picture : oddPictures(dimensionOf(stencil)))
      for (const double contrast : { 1.0, 0.0, 1e-2, 1e-6, 1e6 })
        for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic })
          for (const auto method : { lbm::Method::Auto, lbm::Method::AlgebraicMultigrid })
          {
            Case c{ .sides = sides, .method = method, .tolerance = 1e-9 };
            c.diagonal = stencil == lbm::Stencil::D2Q9 || stencil == lbm::Stencil::D3Q19;
            const Outcome o = attemptSteady(picture.image, { contrast, 1.0 }, c, 1e-8); // ten times what was asked for
            const std::string where = std::string(name(stencil)) + " " + picture.name + " " + std::to_string(contrast) +
              (sides == lbm::Sides::Periodic ? " periodic" : "") + (method == lbm::Method::Auto ? "" : " algebraic");
            EXPECT_NE(o.verdict, Verdict::Wrong) << where << ": off by " << o.error;
            if (o.verdict == Verdict::Refused)
            {
              EXPECT_EQ(contrast, 0.0) << where << ": " << o.what;
              EXPECT_EQ(directValue(picture.image, { contrast, 1.0 }, c.diagonal, sides), 0) << where << ": " << o.what;
            }
          }
}

// Both faces of a symmetric picture say the same from the first step, and at contrast 10⁶ change slower than any
// tolerance long before they are right: planes between and what is dissipated tell.
TEST(LatticeBoltzmannStability, SlowSymmetricPicturesAreNotAtRest)
{
  for (const auto& picture : oddPictures(2))
  {
    if (picture.name != "checkerboard" && picture.name != "single path")
      continue;
    for (const double relaxation : { 1e-3, 1e-2 })
    {
      const Outcome o =
        attempt(picture.image, { .relaxation = relaxation, .diffusivity = { 1e-6, 1.0 }, .maxSteps = 4000 });
      EXPECT_EQ(o.verdict, Verdict::Slow) << picture.name << " " << relaxation;
    }
  }
}

// Collisions with rates in (0, 2) shrink Σ f²/w, and u² ≤ Σ f²/w at every node: insulated, Σ u² never exceeds what it
// was at the start. On mirrors of one relaxation time outer nodes count half along each axis: 2 to the dimension.
TEST(LatticeBoltzmannStability, LongRunsStayBoundedAndKeepTheirMean)
{
  for (const auto stencil : everyLattice)
    for (const auto collision : { Collision::TRT, Collision::BGK })
      for (const double relaxation : { 1e-3, 100.0 })
      {
        const auto image = dimensionOf(stencil) == 2 ? noise(7, 5, 1, 0.5, 3) : noise(5, 3, 2, 0.5, 3);
        SteppingOptions o;
        o.stencil = stencil;
        o.collision = collision;
        o.relaxation = relaxation;
        o.sides = { Boundary::Insulated, Boundary::Insulated, Boundary::Insulated };
        auto solver = stepper(image, { 1e-6, 1.0 }, o);
        std::mt19937_64 random(7);
        const auto initial = fieldOf(decompose(image.lattice, MPI_COMM_SELF),
          [&](double, double, double) { return static_cast<double>(random() >> 11) * 0x1p-53; });
        solver.start(initial);
        const auto squares = [](const std::vector<double>& u)
        {
          double sum = 0;
          for (const double v : u)
            sum += v * v;
          return sum;
        };
        const double before = solver.mean();
        solver.advance(100'000);
        EXPECT_NEAR(solver.mean(), before, 1e-11) << name(stencil) << " " << name(collision); // 1e5 round-offs of 1e-16
        const double slack = collision == Collision::BGK ? std::pow(2.0, dimensionOf(stencil)) : 1 + 1e-11;
        EXPECT_LE(squares(valueOf(solver, image.lattice.count())), slack * squares(initial))
          << name(stencil) << " " << name(collision) << " " << relaxation;
      }
}

} // namespace
