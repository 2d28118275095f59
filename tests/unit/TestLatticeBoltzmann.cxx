// What lattice Boltzmann stepping refuses, and says.
#include "core/Error.h"
#include "lbm/stepping/LatticeBoltzmann.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::lbm;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

LatticeBoltzmann make(
  const SteppingOptions& o, const std::vector<double>& d = { 1.0, 0.1 }, std::size_t ids = 60, std::int64_t nx = 10)
{
  const Lattice lattice = makeLattice(nx, 60 / nx, 1, 2, 1e-6);
  std::vector<std::uint8_t> phase(ids, 0);
  for (std::size_t i = 0; i < ids; i += 3)
    phase[i] = 1;
  return { lattice, decompose(lattice, MPI_COMM_SELF), phase, d, o };
}

// The message of the error that f throws, and that there is a hint.
template <class E>
std::string refusal(const std::function<void()>& f)
{
  try
  {
    f();
  }
  catch (const E& e)
  {
    EXPECT_FALSE(e.hint().empty());
    return e.what();
  }
  catch (const std::exception& e)
  {
    return std::string("another class: ") + e.what();
  }
  return "nothing thrown";
}

std::string refused(const std::function<void(SteppingOptions&)>& change)
{
  SteppingOptions o;
  change(o);
  return refusal<ParameterError>([&] { make(o); });
}

TEST(LatticeBoltzmann, RefusesBadOptions)
{
  EXPECT_EQ(refused([](auto& o) { o.stencil = Stencil::D3Q7; }), "lattice d3q7 does not fit a 2-dimensional picture");
  EXPECT_EQ(refused([](auto& o) { o.axis = 2; }), "there is no axis 2 in 2 dimensions");
  EXPECT_EQ(refused([](auto& o) { o.relaxation = -0.5; }), "a relaxation time τ of 0 is not above ½");
  EXPECT_EQ(refused([](auto& o) { o.relaxation = nan; }), "a relaxation time τ of nan is not above ½");
  EXPECT_EQ(refused([](auto& o) { o.timeStep = -1; }), "a time step of -1 s is not above 0");
  EXPECT_EQ(refused(
              [](auto& o)
              {
                o.timeStep = 1;
                o.relaxation = 1;
              }),
    "both a relaxation and a time step were given");
  EXPECT_EQ(refused([](auto& o) { o.threads = 0; }), "0 threads are too few");
  EXPECT_EQ(refused([](auto& o) { o.faceValues[0][1] = nan; }), "the value nan on a face is not finite");
  EXPECT_EQ(refused([](auto& o) { o.drop = 1; }), "the value cannot fall by 1 over the box");
  EXPECT_EQ(refused(
              [](auto& o)
              {
                o.steady = true;
                o.sides[0] = Boundary::Periodic;
              }),
    "no flux is driven through the box, so there is none to come to rest");
  EXPECT_EQ(refusal<ParameterError>(
              [] {
                make({}, { 1.0, -1.0 });
              }),
    "diffusivity -1 of phase 1 is not a finite number of at least 0");
  EXPECT_EQ(refusal<ParameterError>([] { make({}, { 1.0 }); }), "phase 1 has no diffusivity");
  EXPECT_EQ(refusal<ParameterError>(
              [] {
                make({}, { 1.0, 1.0 }, 59);
              }),
    "59 phase ids were given for a block of 60 nodes");
  EXPECT_EQ(refusal<NoPathError>([] { make({}, { 0.0, 0.0 }); }), "no node of the picture conducts");
  SteppingOptions steady;
  steady.steady = true;
  EXPECT_EQ(refusal<NoPathError>(
              [&] {
                make(steady, { 0.0, 1.0 });
              }),
    "no conducting path leads across the box along x");
  SteppingOptions bgk;
  bgk.collision = Collision::BGK;
  EXPECT_EQ(refusal<ParameterError>(
              [&] {
                make(bgk, { 1.0, 1.0 }, 60, 1);
              }),
    "bgk has its faces on the outer nodes, and there is one node along x");
}

TEST(LatticeBoltzmann, RefusesBadCalls)
{
  auto solver = make({});
  EXPECT_EQ(refusal<ParameterError>([&] { solver.advance(3); }), "3 steps cannot be taken");
  EXPECT_EQ(refusal<ParameterError>([&] { solver.start(nan); }), "the initial value nan is not finite");
  EXPECT_EQ(refusal<ParameterError>([&] { solver.start(std::vector<double>(59, 0.0)); }),
    "59 initial values were given for a block of 60 nodes");
  std::vector<double> field(60, 0.0);
  field[7] = nan;
  EXPECT_EQ(refusal<ParameterError>([&] { solver.start(field); }), "the initial value nan of node 7 is not finite");
  EXPECT_EQ(refusal<ParameterError>([&] { solver.value(std::span<double>(field).first(3)); }),
    "room for 3 values was given for a block of 60 nodes");
  solver.start(0);
  const std::vector<double> backwards{ 2.0, 1.0 };
  EXPECT_EQ(refusal<ParameterError>(
              [&]
              {
                solver.run(
                  backwards, [](const auto&) {});
              }),
    "a time of 1 s cannot be reached from 2 s");
  EXPECT_EQ(refusal<ParameterError>([&] { solver.rest({ .tolerance = 0 }); }), "tolerance 0 is not between 0 and 1");
}

TEST(LatticeBoltzmann, SaysHowMuchMemoryItWouldNeed)
{
  SteppingOptions o;
  o.memory = 1000;
  // 60 nodes of 5 populations and a phase, and two bits of all
  EXPECT_EQ(refusal<MemoryError>([&] { make(o); }),
    "stepping on 60 nodes needs about 2.5 kB on each rank, and 1.0 kB are available");
}

TEST(LatticeBoltzmann, StopsWhereItIsAskedTo)
{
  auto solver = make({});
  std::vector<std::int64_t> seen;
  solver.run(std::vector<std::int64_t>{ 0, 2, 10 }, [&](const LatticeBoltzmann& s) { seen.push_back(s.steps()); });
  EXPECT_EQ(seen, (std::vector<std::int64_t>{ 0, 2, 10 }));
  ASSERT_EQ(solver.records().size(), 3U);
  EXPECT_EQ(solver.records()[2].steps, 10);
  EXPECT_EQ(solver.records()[2].time, solver.time());
  EXPECT_EQ(solver.records()[2].faceFlux, solver.faceFlux());
  EXPECT_EQ(solver.records()[2].mean, solver.mean());
  EXPECT_EQ(solver.stepsAt(solver.time() * 1.01), 10);
  const std::vector<std::int64_t> odd{ 11 };
  EXPECT_EQ(
    refusal<ParameterError>([&] { solver.run(odd, [](const auto&) {}); }), "step 11 cannot be reached from step 10");
  const std::vector<std::int64_t> past{ 8 };
  EXPECT_EQ(
    refusal<ParameterError>([&] { solver.run(past, [](const auto&) {}); }), "step 8 cannot be reached from step 10");
  solver.start(0);
  EXPECT_TRUE(solver.records().empty());
}

TEST(LatticeBoltzmann, NamesWhatDiverges)
{
  // Growth past any bound that diffusion has: the largest double squares to infinity in the first pair of steps.
  auto solver = make({});
  std::vector<double> field(60, 1e200);
  solver.start(field);
  EXPECT_EQ(refusal<DivergenceError>([&] { solver.advance(64); }),
    "the values are no longer finite at step 2 (time 3.333e-13 s): their root mean square is inf");
  // Steps that are not enough
  SteppingOptions o;
  o.steady = true;
  auto slow = make(o);
  EXPECT_NE(refusal<DivergenceError>([&] { slow.rest({ .tolerance = 1e-12, .maxSteps = 20 }); }).find("after 20 steps"),
    std::string::npos);
}

TEST(LatticeBoltzmann, ReportsAndCancels)
{
  SteppingOptions o;
  double last = -1;
  int calls = 0;
  o.progress = [&](double share, const char*)
  {
    EXPECT_GE(share, last);
    last = share;
    return ++calls < 5;
  };
  auto solver = make(o);
  EXPECT_THROW(solver.advance(100000), Cancelled);
  EXPECT_EQ(calls, 5);
  EXPECT_LT(solver.steps(), 1000);
}

TEST(LatticeBoltzmann, KeepsTime)
{
  // δt = Λ δx²/(3 D) for the phase that conducts best
  SteppingOptions o;
  o.relaxation = 0.75;
  EXPECT_DOUBLE_EQ(make(o, { 1e-9, 2e-9 }).timeStep(), 0.75 * 1e-12 / (3 * 2e-9));
  o.relaxation = 0;
  o.timeStep = 1e-4;
  auto solver = make(o, { 1e-9, 2e-9 });
  EXPECT_DOUBLE_EQ(solver.relaxation(), 3 * 2e-9 * 1e-4 / 1e-12);
  std::vector<std::int64_t> seen;
  solver.run(std::vector<double>{ 0.0, 0.00029, 0.00031, 0.001 },
    [&](const LatticeBoltzmann& s)
    {
      seen.push_back(s.steps());
      EXPECT_DOUBLE_EQ(s.time(), static_cast<double>(s.steps()) * 1e-4);
    });
  EXPECT_EQ(seen, (std::vector<std::int64_t>{ 0, 2, 4, 10 })); // the nearest pairs
}

TEST(LatticeBoltzmann, CountsWhatItDoes)
{
  auto solver = make({}, { 1.0, 0.0 });
  solver.advance(20);
  const auto s = solver.statistics();
  EXPECT_EQ(s.nodes, 60);
  EXPECT_EQ(s.stored, 40);
  EXPECT_EQ(s.skipped, 20);
  EXPECT_EQ(s.updates, 800);
  EXPECT_EQ(s.bytesPerUpdate, 40.5);
  EXPECT_GT(s.bytes, 40U * 41U);
}

} // namespace
