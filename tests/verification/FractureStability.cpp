// Samples at the edge of what fracture stands come apart by both methods alike, or say why they do not. The benchmark
// fracture-stability has more of them.
#include "FractureSamples.h"

#include "lattice/Error.h"

#include <gtest/gtest.h>

namespace
{

using namespace lamella;
using namespace lamella::test;

// Neither is within one in a thousand of the other by chance: strengths with these moduli differ by factors. The bonds
// are not compared: in the soft phase elongations are known to the residual over the contrast.
void alike(const Breakable& s, double tolerance)
{
  const FractureRecord accurate = fracture(s, by(FractureMethod::Accurate, 0.3));
  const FractureRecord events = fracture(s, by(FractureMethod::Events, 0.3));
  for (const FractureRecord* r : { &accurate, &events })
  {
    EXPECT_TRUE(r->end == FractureEnd::StressFell || r->end == FractureEnd::Severed) << describe(r->end);
    EXPECT_GE(r->peak.stress, r->first.stress);
    double strain = 0;
    for (const CurvePoint& p : r->curve)
    {
      EXPECT_GE(p.strain, (1 - 1e-9) * strain) << "after " << p.broken;
      strain = p.strain;
    }
  }
  EXPECT_NEAR(events.peak.stress, accurate.peak.stress, tolerance * accurate.peak.stress);
}

Breakable disks(double contrast, double horizon = 3)
{
  Breakable s{ aggregate(20, 32), modelOf(Continuum::PlaneStress, horizon) };
  s.model.pairs[{ 1, 2 }] = s.model.pairs[{ 1, 1 }];
  s.model.pairs[{ 2, 2 }].material = { .youngsModulus = contrast * young, .criticalStretch = 0.01 };
  return s;
}

TEST(FractureStability, StiffDisks)
{
  alike(disks(1e6), 1e-4);
}

TEST(FractureStability, Horizons)
{
  for (const double horizon : { 2.0, 5.0 })
    alike(disks(4, horizon), 1e-4);
}

// What is left after a notch through nearly all of it turns like a hinge.
TEST(FractureStability, DeepNotch)
{
  Breakable s = strip(32, 48);
  s.model.notches.push_back({ { 0, 24 * spacing, 0 }, { 29 * spacing, 0, 0 }, {} });
  alike(s, 1e-4);
}

TEST(FractureStability, NotchThroughEverything)
{
  Breakable s = strip(32, 48);
  s.model.notches.push_back({ { 0, 24 * spacing, 0 }, { 32 * spacing, 0, 0 }, {} });
  for (const FractureMethod method : { FractureMethod::Accurate, FractureMethod::Events })
    try
    {
      fracture(s, by(method));
      FAIL() << "it was pulled";
    }
    catch (const NoPathError& e)
    {
      EXPECT_NE(std::string(e.what()).find("in 2 pieces"), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.hint()), "");
    }
}

} // namespace
