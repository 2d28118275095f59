// Trilinear elements with a tensor each: exact where the answer is linear, of second order in a smooth medium, rotated
// laminates in space, of isotropic and of orthotropic materials, the material's bounds, any ratio; flux, faces and
// columns of the tensor.
#include "Diffusion.h"

#include "core/Error.h"
#include "lbm/DirectedLinks.h"

#include <Eigen/Dense>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace
{

using namespace lamella;
using namespace lamella::test;

struct Scene
{
  PhaseImage image;
  lbm::DirectedDiffusivity diffusivity;
};

lbm::SteadyResult solveElements(
  const Scene& scene, int axis, lbm::Sides sides, double tolerance = 1e-9, int threads = 1)
{
  lbm::SteadyOptions o =
    optionsOf(scene.image, { .axis = axis, .sides = sides, .tolerance = tolerance, .threads = threads });
  o.stencil = lbm::Stencil::Q1;
  o.directed = std::make_shared<lbm::DirectedDiffusivity>(scene.diffusivity);
  lbm::SteadyDiffusion solver(scene.image.lattice, decompose(scene.image.lattice, MPI_COMM_SELF), scene.image.phase,
    scene.diffusivity.larger(), o);
  return solver.solve(axis);
}

Eigen::Matrix3d tensorOf(double along, double across, const Eigen::Vector3d& axis)
{
  const Eigen::Vector3d a = axis.normalized();
  return across * Eigen::Matrix3d::Identity() + (along - across) * a * a.transpose();
}

TEST(Elements, OneMaterialIsExactInAnyDirection)
{
  const Eigen::Vector3d axis(1, 2, -2);
  for (const double ratio : { 0.01, 0.3, 5.0, 100.0 })
    for (const std::array<double, 3> edges : { std::array<double, 3>{ 1, 1, 1 }, { 1, 2, 0.5 } })
    {
      Scene scene{ noise(8, 7, 9, 0, 1), { { ratio, 1 }, { 1, 1 }, {} } };
      scene.image.lattice = makeLattice(8, 7, 9, 3, edges[0], { 1, edges[1] / edges[0], edges[2] / edges[0] });
      scene.diffusivity.axis.assign(scene.image.phase.size(), { 1.0F, 2.0F, -2.0F });
      const Eigen::Matrix3d tensor = tensorOf(ratio, 1, axis);
      for (int a = 0; a < 3; ++a)
      {
        const auto r = solveElements(scene, a, lbm::Sides::Periodic);
        for (int b = 0; b < 3; ++b)
          EXPECT_NEAR(r.effective[static_cast<std::size_t>(b)], tensor(b, a), 1e-6 * std::max(1.0, ratio));
      }
    }
}

/// Layers of two materials across an axis: in series across, in parallel along, in volumes and pictures.
TEST(Elements, LayersAreExact)
{
  for (const std::int64_t nz : { std::int64_t{ 9 }, std::int64_t{ 1 } })
    for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Mixed, lbm::Sides::Periodic })
      for (int across = 0; across < (nz > 1 ? 3 : 2); ++across)
      {
        Scene scene{ noise(9, 12, nz, 0, 1), { { 0.1, 1 }, { 0.1, 1 }, {} } };
        scene.diffusivity.axis.assign(scene.image.phase.size(), { 0, 0, 0 });
        std::int64_t i = 0;
        for (std::int64_t z = 0; z < nz; ++z)
          for (std::int64_t y = 0; y < 12; ++y)
            for (std::int64_t x = 0; x < 9; ++x)
              scene.image.phase[static_cast<std::size_t>(i++)] =
                std::array{ x, y, z }[static_cast<std::size_t>(across)] % 3 == 0 ? 1 : 0;
        for (int axis = 0; axis < (nz > 1 ? 3 : 2); ++axis)
        {
          const auto r = solveElements(scene, axis, sides);
          const double value = r.effective[static_cast<std::size_t>(axis)];
          EXPECT_NEAR(value, axis == across ? 1 / (2 / 0.1 / 3 + 1.0 / 3) : 0.2 / 3 + 1.0 / 3, 1e-8);
          EXPECT_NEAR(r.inletFlux, value, 1e-8);
          EXPECT_NEAR(r.outletFlux, value, 1e-8);
        }
      }
}

/// Layers of two isotropic materials across a direction in space, fraction one half, that repeat with the box. Voxels
/// that the surfaces cut are layered within: along the normal in series, else in parallel.
Scene laminate(std::int64_t n, const std::array<int, 3>& waves, double contrast, bool within)
{
  constexpr int levels = 200;
  const Eigen::Vector3d normal = Eigen::Vector3d(waves[0], waves[1], waves[2]);
  Scene scene{ noise(n, n, n, 0, 1), {} };
  for (int s = 0; s <= levels; ++s)
  {
    const double share = static_cast<double>(s) / levels;
    scene.diffusivity.along.push_back(1 / (share / contrast + (1 - share)));
    scene.diffusivity.across.push_back(share * contrast + 1 - share);
  }
  scene.diffusivity.axis.assign(scene.image.phase.size(),
    { static_cast<float>(waves[0]), static_cast<float>(waves[1]), static_cast<float>(waves[2]) });
  std::size_t i = 0;
  constexpr int samples = 8;
  const double h = 1.0 / static_cast<double>(n);
  for (std::int64_t z = 0; z < n; ++z)
    for (std::int64_t y = 0; y < n; ++y)
      for (std::int64_t x = 0; x < n; ++x)
      {
        int inside = 0;
        const int each = within ? samples : 1;
        for (int c = 0; c < each; ++c)
          for (int b = 0; b < each; ++b)
            for (int a = 0; a < each; ++a)
            {
              const Eigen::Vector3d p(static_cast<double>(x) + (a + 0.5) / each,
                static_cast<double>(y) + (b + 0.5) / each, static_cast<double>(z) + (c + 0.5) / each);
              const double phase = h * p.dot(normal) + 0.137;
              inside += phase - std::floor(phase) < 0.5 ? 1 : 0;
            }
        scene.image.phase[i++] =
          static_cast<std::uint8_t>(std::lround(levels * static_cast<double>(inside) / (each * each * each)));
      }
  return scene;
}

TEST(Elements, RotatedLaminatesAreOfFirstOrderAndCanBeExtrapolated)
{
  for (const std::array<int, 3> waves : { std::array<int, 3>{ 1, 2, 2 }, { 0, 1, 2 }, { 1, -1, 3 } })
    for (const double contrast : { 10.0, 0.1 })
    {
      const Eigen::Vector3d normal = Eigen::Vector3d(waves[0], waves[1], waves[2]);
      const Eigen::Matrix3d exact = tensorOf(2 / (1 + 1 / contrast), 0.5 * (1 + contrast), normal);
      for (const bool within : { false, true })
      {
        std::array<Eigen::Matrix3d, 3> found;
        for (const std::size_t level : { 0, 1, 2 })
        {
          if (level == 2 && (waves[0] == 0 || contrast < 1))
            continue;
          const Scene scene = laminate(std::int64_t{ 16 } << level, waves, contrast, within);
          for (int a = 0; a < 3; ++a)
          {
            const auto r = solveElements(scene, a, lbm::Sides::Periodic, 1e-5, 2);
            EXPECT_LE(r.iterations, 6);
            for (int b = 0; b < 3; ++b)
              found[level](b, a) = r.effective[static_cast<std::size_t>(b)];
          }
        }
        const auto error = [&](const Eigen::Matrix3d& k) { return (k - exact).cwiseAbs().maxCoeff() / exact.norm(); };
        EXPECT_LT(error(found[0]), within ? 0.013 : 0.025);
        EXPECT_GT(error(found[0]) / error(found[1]), 1.9);
        EXPECT_LT(error(2 * found[1] - found[0]), 3e-3);
        if (waves[0] == 0 || contrast < 1)
          continue;
        EXPECT_GT(error(found[1]) / error(found[2]), 1.9);
        EXPECT_LT(error(2 * found[2] - found[1]), 1e-3);
      }
    }
}

/// An orthotropic material that is turned: principal values along axes of any direction.
Eigen::Matrix3d orthotropic(const Eigen::Vector3d& principal, double angle, const Eigen::Vector3d& about)
{
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, about.normalized()).toRotationMatrix();
  return turn * principal.asDiagonal() * turn.transpose();
}

template <class Real>
lbm::SymmetricTensor<Real> entries(const Eigen::Matrix3d& k)
{
  lbm::SymmetricTensor<Real> result{};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      result[lbm::tensorPlace(static_cast<std::size_t>(a), static_cast<std::size_t>(b))] = static_cast<Real>(k(a, b));
  return result;
}

using Source = lbm::DirectedDiffusivity::Source;

/// Phases with tensors.
lbm::DirectedDiffusivity tensorsOf(const PhaseImage& image, const std::vector<Eigen::Matrix3d>& tensors)
{
  lbm::DirectedDiffusivity d;
  d.along.assign(tensors.size(), 0.0);
  d.across = d.along;
  d.source.assign(tensors.size(), Source::Phase);
  for (const Eigen::Matrix3d& k : tensors)
    d.ofPhase.push_back(entries<double>(k));
  d.takeTensors(image.lattice, image.phase);
  return d;
}

/// The same, voxel by voxel.
lbm::DirectedDiffusivity tensorsByVoxel(const PhaseImage& image, const std::vector<Eigen::Matrix3d>& tensors)
{
  lbm::DirectedDiffusivity d;
  d.along.assign(tensors.size(), 0.0);
  d.across = d.along;
  d.source.assign(tensors.size(), Source::Node);
  for (const std::uint8_t id : image.phase)
    d.ofNode.push_back(entries<float>(tensors[id]));
  d.takeTensors(image.lattice, image.phase);
  return d;
}

Eigen::Matrix3d effectiveOf(const Scene& scene, lbm::Sides sides, double tolerance, int threads, int mostIterations)
{
  Eigen::Matrix3d found = Eigen::Matrix3d::Zero();
  for (int a = 0; a < scene.image.lattice.dimension; ++a)
  {
    const auto r = solveElements(scene, a, sides, tolerance, threads);
    EXPECT_LE(r.iterations, mostIterations);
    for (int b = 0; b < 3; ++b)
      found(b, a) = r.effective[static_cast<std::size_t>(b)];
  }
  return found;
}

TEST(Elements, OneTensorIsExact)
{
  for (const Eigen::Vector3d& principal :
    { Eigen::Vector3d(3, 1, 0.2), Eigen::Vector3d(0.02, 5, 0.9), Eigen::Vector3d(1, 1e-3, 1e-3) })
    for (const std::array<double, 3> edges : { std::array<double, 3>{ 1, 1, 1 }, { 1, 2, 0.5 } })
    {
      const Eigen::Matrix3d exact = orthotropic(principal, 0.7, { 1, 2, -0.5 });
      Scene scene{ noise(8, 7, 9, 0, 1), {} };
      scene.image.lattice = makeLattice(8, 7, 9, 3, edges[0], { 1, edges[1] / edges[0], edges[2] / edges[0] });
      for (const bool byVoxel : { false, true })
      {
        scene.diffusivity =
          byVoxel ? tensorsByVoxel(scene.image, { exact, exact }) : tensorsOf(scene.image, { exact, exact });
        EXPECT_NEAR(scene.diffusivity.larger()[0], principal.maxCoeff(), 1e-6 * principal.maxCoeff());
        EXPECT_NEAR(scene.diffusivity.smaller()[0], principal.minCoeff(), 1e-6 * principal.maxCoeff());
        const Eigen::Matrix3d found = effectiveOf(scene, lbm::Sides::Periodic, 1e-9, 1, 30);
        EXPECT_LT((found - exact).cwiseAbs().maxCoeff(), 1e-6 * principal.maxCoeff());
      }
    }
  // a picture: what there is across it does not count
  Eigen::Matrix3d flat = Eigen::Matrix3d::Identity() * 7;
  flat.topLeftCorner<2, 2>() << 2, 0.6, 0.6, 0.5;
  Scene scene{ noise(9, 8, 1, 0, 1), {} };
  scene.diffusivity = tensorsOf(scene.image, { flat, flat });
  const Eigen::Matrix3d found = effectiveOf(scene, lbm::Sides::Periodic, 1e-9, 1, 30);
  EXPECT_LT((found - flat).topLeftCorner(2, 2).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_NEAR(scene.diffusivity.larger()[0], 1.25 + std::sqrt(0.75 * 0.75 + 0.36), 1e-12);
}

/// Layers of two orthotropic materials, each turned its own way. Across a surface the normal flux and the gradient
/// along it are continuous: with a = n·K n and means ⟨⟩ over the layers
/// K* = ⟨K − K n nᵀ K / a⟩ + ⟨K n / a⟩ ⟨K n / a⟩ᵀ / ⟨1 / a⟩ (Milton, The Theory of Composites, 2002, chapter 9).
TEST(Elements, RotatedLaminatesOfOrthotropicMaterials)
{
  const std::vector<Eigen::Matrix3d> materials{ orthotropic({ 10, 3, 1 }, 0.5, { 1, 1, 0.2 }),
    orthotropic({ 1, 0.2, 0.5 }, -0.9, { 0.3, -1, 1 }) };
  for (const std::array<int, 3> waves : { std::array<int, 3>{ 1, 1, 1 }, { 1, 2, 2 }, { 1, -1, 3 } })
  {
    const Eigen::Vector3d normal = Eigen::Vector3d(waves[0], waves[1], waves[2]).normalized();
    Eigen::Matrix3d exact = Eigen::Matrix3d::Zero();
    Eigen::Vector3d flux = Eigen::Vector3d::Zero();
    double resistance = 0;
    for (const Eigen::Matrix3d& k : materials)
    {
      const Eigen::Vector3d kn = k * normal;
      const double a = normal.dot(kn);
      exact += 0.5 * (k - kn * kn.transpose() / a);
      flux += 0.5 * kn / a;
      resistance += 0.5 / a;
    }
    exact += flux * flux.transpose() / resistance;
    std::array<Eigen::Matrix3d, 3> found;
    for (const std::size_t level : { 0, 1, 2 })
    {
      Scene scene = laminate(std::int64_t{ 16 } << level, waves, 2, false);
      for (std::uint8_t& id : scene.image.phase)
        id = id > 0 ? 1 : 0;
      scene.diffusivity = level == 1 ? tensorsByVoxel(scene.image, materials) : tensorsOf(scene.image, materials);
      found[level] = effectiveOf(scene, lbm::Sides::Periodic, 1e-5, 2, 10);
    }
    const auto error = [&](const Eigen::Matrix3d& k) { return (k - exact).cwiseAbs().maxCoeff() / exact.norm(); };
    EXPECT_GT(error(found[0]) / error(found[1]), 1.9);
    EXPECT_GT(error(found[1]) / error(found[2]), 1.9);
    EXPECT_LT(error(2 * found[2] - found[1]), 1e-3);
  }
}

/// A medium of which every voxel has a tensor of its own, and which conducts as an isotropic one of 1: the box,
/// deformed by a periodic map x(y) of gradient F, with K = F Fᵀ / det F (a change of variables in ∫ g·K g).
TEST(Elements, ADeformedMediumIsOfSecondOrder)
{
  constexpr double strength = 0.08;
  const double pi = std::acos(-1.0);
  std::array<double, 3> errors{};
  for (const std::size_t level : { 0, 1, 2 })
  {
    const std::int64_t n = std::int64_t{ 16 } << level;
    Scene scene{ noise(n, n, n, 0, 1), {} };
    lbm::DirectedDiffusivity& d = scene.diffusivity;
    d.along = d.across = { 0, 0 };
    d.source.assign(2, Source::Node);
    const double h = 1.0 / static_cast<double>(n);
    for (std::int64_t z = 0; z < n; ++z)
      for (std::int64_t y = 0; y < n; ++y)
        for (std::int64_t x = 0; x < n; ++x)
        {
          const Eigen::Vector3d place(
            (static_cast<double>(x) + 0.5) * h, (static_cast<double>(y) + 0.5) * h, (static_cast<double>(z) + 0.5) * h);
          // x_i = y_i + s sin(2π y_{i+1}) cos(2π y_{i+2}), solved for y
          const auto moved = [&](const Eigen::Vector3d& of)
          {
            Eigen::Vector3d by;
            for (int i = 0; i < 3; ++i)
              by(i) = strength * std::sin(2 * pi * of((i + 1) % 3)) * std::cos(2 * pi * of((i + 2) % 3));
            return by;
          };
          Eigen::Vector3d at = place;
          for (int step = 0; step < 60; ++step)
            at = place - moved(at);
          Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
          for (int i = 0; i < 3; ++i)
          {
            const double a = 2 * pi * at((i + 1) % 3);
            const double b = 2 * pi * at((i + 2) % 3);
            f(i, (i + 1) % 3) += strength * 2 * pi * std::cos(a) * std::cos(b);
            f(i, (i + 2) % 3) -= strength * 2 * pi * std::sin(a) * std::sin(b);
          }
          d.ofNode.push_back(entries<float>(f * f.transpose() / f.determinant()));
        }
    d.takeTensors(scene.image.lattice, scene.image.phase);
    errors[level] = (effectiveOf(scene, lbm::Sides::Periodic, 1e-7, 2, 12) - Eigen::Matrix3d::Identity()).norm();
  }
  EXPECT_GT(errors[0] / errors[1], 3.7);
  EXPECT_GT(errors[1] / errors[2], 3.9);
  EXPECT_LT(errors[2], 1e-3);
}

/// By a factor on a phase's whole tensor: central differences.
TEST(Elements, DerivativesByTensors)
{
  Scene scene = laminate(16, { 1, 2, 0 }, 2, false);
  for (std::uint8_t& id : scene.image.phase)
    id = id > 0 ? 1 : 0;
  const std::vector<Eigen::Matrix3d> materials{ orthotropic({ 10, 3, 1 }, 0.5, { 1, 1, 0.2 }),
    orthotropic({ 1, 0.2, 0.5 }, -0.9, { 0.3, -1, 1 }) };
  for (const bool byVoxel : { false, true })
  {
    const auto solved = [&](double first, double second)
    {
      const std::vector<Eigen::Matrix3d> k{ first * materials[0], second * materials[1] };
      scene.diffusivity = byVoxel ? tensorsByVoxel(scene.image, k) : tensorsOf(scene.image, k);
      lbm::SteadyOptions o = optionsOf(scene.image, { .axis = 1, .tolerance = 1e-12 });
      o.stencil = lbm::Stencil::Q1;
      o.directed = std::make_shared<lbm::DirectedDiffusivity>(scene.diffusivity);
      lbm::SteadyDiffusion solver(scene.image.lattice, decompose(scene.image.lattice, MPI_COMM_SELF), scene.image.phase,
        scene.diffusivity.larger(), o);
      const double value = solver.solve(1).effective[1];
      return std::pair{ value, solver.derivatives() };
    };
    const auto [value, derivatives] = solved(1, 1);
    constexpr double step = 1e-2;
    for (const std::size_t id : { 0, 1 })
    {
      const double more = solved(id == 0 ? 1 + step : 1, id == 1 ? 1 + step : 1).first;
      const double less = solved(id == 0 ? 1 - step : 1, id == 1 ? 1 - step : 1).first;
      const double byFactor = derivatives.along[id] * (id == 0 ? 10 : 1);    // the largest principal value
      EXPECT_NEAR(byFactor, (more - less) / (2 * step), 3e-5 * value) << id; // steps² and single precision
    }
    EXPECT_NEAR(derivatives.along[0] * 10 + derivatives.along[1], value, 1e-7 * value);
  }
}

/// Every voxel has a direction of its own, some conduct nothing.
Scene jumble(std::int64_t n, double ratio, double voids, unsigned seed = 3)
{
  Scene scene{ noise(n, n + 1, n - 1, voids, seed), { { ratio, 0 }, { 1, 0 }, {} } };
  const PhaseImage bits = noise(3 * n, n + 1, n - 1, 0.5, seed + 100);
  const PhaseImage more = noise(3 * n, n + 1, n - 1, 0.3, seed + 200);
  for (std::size_t i = 0; i < scene.image.phase.size(); ++i)
    scene.diffusivity.axis.push_back({ 0.1F + static_cast<float>(bits.phase[3 * i] + more.phase[3 * i]),
      static_cast<float>(bits.phase[3 * i + 1]) - static_cast<float>(more.phase[3 * i + 1]),
      static_cast<float>(bits.phase[3 * i + 2]) - 2.0F * static_cast<float>(more.phase[3 * i + 2]) });
  return scene;
}

TEST(Elements, TheErrorToldHolds)
{
  int cases = 0;
  for (const double ratio : { 3.0, 30.0, 1000.0, 0.001 })
    for (const double voids : { 0.0, 0.1, 0.2, 0.3 })
      for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Mixed, lbm::Sides::Periodic })
      {
        const Scene scene = jumble(10 + cases % 7, ratio, voids, 10U + static_cast<unsigned>(cases));
        ++cases;
        const double value = solveElements(scene, 1, sides, 1e-12).effective[1];
        for (const double tolerance : { 1e-2, 1e-4, 1e-6 })
        {
          lbm::SteadyOptions o = optionsOf(scene.image, { .axis = 1, .sides = sides, .tolerance = tolerance });
          o.stencil = lbm::Stencil::Q1;
          o.fieldTolerance = std::numeric_limits<double>::infinity();
          o.directed = std::make_shared<lbm::DirectedDiffusivity>(scene.diffusivity);
          lbm::SteadyDiffusion solver(scene.image.lattice, decompose(scene.image.lattice, MPI_COMM_SELF),
            scene.image.phase, scene.diffusivity.larger(), o);
          const auto r = solver.solve(1);
          EXPECT_LE(std::abs(r.effective[1] / value - 1), r.solverError + 1e-13)
            << ratio << " " << voids << " " << static_cast<int>(sides) << ": " << r.iterations;
          EXPECT_LE(r.solverError, tolerance);
          EXPECT_LE(r.balance, 1e-9);
          EXPECT_LE(r.iterations, 30);
        }
      }
}

TEST(Elements, ThreadsChangeNothing)
{
  const Scene scene = jumble(40, 30, 0.1);
  const auto one = solveElements(scene, 0, lbm::Sides::Insulated, 1e-6, 1);
  const auto two = solveElements(scene, 0, lbm::Sides::Insulated, 1e-6, 2);
  EXPECT_EQ(one.effective, two.effective);
}

/// The mean of the flux is the column of the tensor over the length; values lie between those of the faces.
TEST(Elements, FieldsBelongToTheValue)
{
  Scene scene = jumble(12, 6, 0.1);
  scene.image.lattice.aspect = { 1, 2, 0.5 };
  for (const auto sides : { lbm::Sides::Insulated, lbm::Sides::Periodic })
    for (const int axis : { 0, 1, 2 })
    {
      lbm::SteadyOptions o = optionsOf(scene.image, { .axis = axis, .sides = sides });
      o.stencil = lbm::Stencil::Q1;
      o.directed = std::make_shared<lbm::DirectedDiffusivity>(scene.diffusivity);
      lbm::SteadyDiffusion solver(scene.image.lattice, decompose(scene.image.lattice, MPI_COMM_SELF), scene.image.phase,
        scene.diffusivity.larger(), o);
      const auto r = solver.solve(axis);
      std::vector<double> flux(3 * scene.image.phase.size());
      std::vector<double> value(scene.image.phase.size());
      solver.flux(flux);
      solver.value(value);
      std::array<double, 3> mean{ 0, 0, 0 };
      for (std::size_t i = 0; i < flux.size(); ++i)
        mean[i % 3] += flux[i] / static_cast<double>(value.size());
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_NEAR(mean[a] * scene.image.lattice.length(axis), r.effective[a], 1e-6);
      for (std::size_t i = 0; i < value.size(); ++i)
      {
        EXPECT_EQ(std::isnan(value[i]), scene.image.phase[i] == 1);
        if (sides == lbm::Sides::Insulated && scene.image.phase[i] == 0)
        {
          EXPECT_GT(value[i], -0.05);
          EXPECT_LT(value[i], 1.05);
        }
      }
    }
}

TEST(Elements, WhatDoesNotFitIsRefused)
{
  Scene scene = jumble(6, 3, 0);
  scene.diffusivity.axis[7] = { 0, 0, 0 };
  EXPECT_THROW((void)solveElements(scene, 0, lbm::Sides::Insulated), ParameterError);
  scene.diffusivity.axis.pop_back();
  EXPECT_THROW((void)solveElements(scene, 0, lbm::Sides::Insulated), ParameterError);
  scene = jumble(6, 3, 0);
  scene.diffusivity.across[0] = -1;
  EXPECT_THROW((void)solveElements(scene, 0, lbm::Sides::Insulated), ParameterError);
  scene = jumble(6, 3, 1);
  EXPECT_THROW((void)solveElements(scene, 0, lbm::Sides::Insulated), NoPathError);
}

/// The words of what takeTensors() throws.
std::string refusal(const PhaseImage& image, const std::vector<Eigen::Matrix3d>& tensors, bool byVoxel)
{
  try
  {
    (void)(byVoxel ? tensorsByVoxel(image, tensors) : tensorsOf(image, tensors));
  }
  catch (const ParameterError& error)
  {
    return error.what();
  }
  return "";
}

TEST(Elements, TensorsThatNoMaterialHasAreRefused)
{
  PhaseImage image = noise(4, 3, 5, 0, 1);
  image.phase[4 * (3 * 2 + 1) + 3] = 1; // voxel (3, 1, 2)
  const Eigen::Matrix3d good = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d bad = good;
  bad(0, 1) = bad(1, 0) = 1.5;
  for (const bool byVoxel : { false, true })
  {
    const std::string told = refusal(image, { good, bad }, byVoxel);
    EXPECT_NE(told.find(byVoxel ? "at voxel (3, 1, 2)" : "of phase 1"), std::string::npos) << told;
    EXPECT_NE(told.find("not positive definite: its least principal value is -0.5"), std::string::npos) << told;
    bad(0, 1) = bad(1, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(refusal(image, { good, bad }, byVoxel).find("no finite tensor"), std::string::npos);
    bad = Eigen::Vector3d(1, 1, 1e-7).asDiagonal();
    EXPECT_NE(refusal(image, { good, bad }, byVoxel).find("principal values from 1e-07 to 1"), std::string::npos);
    for (const double size : { 1e-33, 1e33 })
      EXPECT_NE(refusal(image, { good, size * good }, byVoxel).find("not between 1e-30 and 1e30"), std::string::npos);
    bad = good;
    bad(0, 1) = bad(1, 0) = 1.5;
  }
  bad = good;
  bad(0, 2) = bad(2, 0) = 0.1;
  const PhaseImage picture = noise(4, 3, 1, 0.5, 1);
  EXPECT_NE(refusal(picture, { good, bad }, false).find("couples the third axis"), std::string::npos);
}

} // namespace
