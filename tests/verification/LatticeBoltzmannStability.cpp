// Nothing fails silently: on odd pictures, at any relaxation and contrast, stepping to rest is right, refused by name,
// or (one relaxation time) warned about; and long runs stay bounded.
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
          {
            EXPECT_NE(o.verdict, Verdict::Warned) << o.what;
          }
          if (o.verdict == Verdict::Refused)
          {
            EXPECT_FALSE(o.what.empty());
          }
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
      EXPECT_EQ(o.verdict, Verdict::Refused) << picture.name << " " << relaxation;
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
