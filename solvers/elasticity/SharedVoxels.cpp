#include "elasticity/SharedVoxels.h"

#include "core/Error.h"
#include "elasticity/ElasticKernels.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace lamella::elasticity
{
namespace
{

constexpr double smallChange = 1e-4; // of a modulus, for differences of what a laminate has
constexpr double smallest = 1e-12;
constexpr double flat = 1e-3; // change of the share over two voxels below which it has no direction

bool isVoid(const VoxelMaterial& m)
{
  return !m.rigid &&
    std::ranges::all_of(
      m.stiffness, [](double c) { return c == 0; });
}
bool turns(const VoxelMaterial& m)
{
  return std::ranges::any_of(
    m.axial, [](double c) { return c != 0; });
}

struct Lame
{
  double lambda = 0, mu = 0, expansion = 0;
};
Lame lameOf(const VoxelMaterial& m, int dimension)
{
  const int n = voigtSize(dimension);
  return { m.stiffness[static_cast<std::size_t>(triangle(n, 0, 1))],
    m.stiffness[static_cast<std::size_t>(triangle(n, n - 1, n - 1))], m.expansion.empty() ? 0.0 : m.expansion[0] };
}
bool isIsotropic(const VoxelMaterial& m, int dimension)
{
  const Lame l = lameOf(m, dimension);
  const int n = voigtSize(dimension);
  const double largest = *std::ranges::max_element(m.stiffness);
  for (int i = 0; i < n; ++i)
    for (int j = i; j < n; ++j)
    {
      const double same =
        (i < dimension && j < dimension ? l.lambda : 0.0) + (i == j ? (i < dimension ? 2 * l.mu : l.mu) : 0.0);
      if (std::abs(m.stiffness[static_cast<std::size_t>(triangle(n, i, j))] - same) > 1e-12 * largest)
        return false;
    }
  return !turns(m);
}

// Layers across x.
VoxelMaterial laminate(const Lame& a, const Lame& b, double share, int dimension)
{
  const auto mean = [&](const std::function<double(double, double)>& f)
  { return (1 - share) * f(a.lambda, a.mu) + share * f(b.lambda, b.mu); };
  const auto thin = [](double l, double m) { return l * l / (l + 2 * m); };
  const double normal = 1 / mean([](double l, double m) { return 1 / (l + 2 * m); });
  const double ratio = mean([](double l, double m) { return l / (l + 2 * m); });
  const double cross = ratio * normal;
  const double along = mean([&](double l, double m) { return l + 2 * m - thin(l, m); }) + ratio * ratio * normal;
  const double side = mean([&](double l, double m) { return l - thin(l, m); }) + ratio * ratio * normal;
  const double slide = 1 / mean([](double, double m) { return 1 / m; });
  const double inLayer = mean([](double, double m) { return m; });
  VoxelMaterial material;
  material.stiffness = dimension == 2 ? PhaseStiffness{ normal, cross, 0, along, 0, slide }
                                      : PhaseStiffness{ normal, cross, cross, 0, 0, 0, along, side, 0, 0, 0, along, 0,
                                          0, 0, inLayer, 0, 0, slide, 0, slide };
  material.axial = axialParts(dimension, material.stiffness);
  if (a.expansion != 0 || b.expansion != 0)
  {
    // stress-free as a whole: layers stretch alike, and nothing pulls across them
    const int across = dimension - 1;
    const auto modulus = [&](const Lame& l) { return l.lambda * across + 2 * l.mu - across * thin(l.lambda, l.mu); };
    const double stiff = (1 - share) * modulus(a) + share * modulus(b);
    const double layers = ((1 - share) * modulus(a) * a.expansion + share * modulus(b) * b.expansion) / stiff;
    const auto thick = [&](const Lame& l)
    { return l.expansion - across * l.lambda / (l.lambda + 2 * l.mu) * (layers - l.expansion); };
    material.expansion = { (1 - share) * thick(a) + share * thick(b), layers };
  }
  return material;
}

VoxelMaterial thinned(VoxelMaterial m, double share)
{
  for (double& c : m.stiffness)
    c *= share;
  for (double& c : m.axial)
    c *= share;
  for (ModulusChange& change : m.changes)
    for (double& c : change.moduli)
      c *= share;
  return m;
}

// Of a laminate, with each number of either layer: by differences, of fourth order, of what is rational in the moduli.
std::vector<ModulusChange> laminateChanges(
  const VoxelMaterial& low, const VoxelMaterial& high, double share, int dimension)
{
  std::vector<ModulusChange> changes;
  for (const bool second : { false, true })
    for (const ModulusChange& own : (second ? high : low).changes)
    {
      const Lame a = lameOf(low, dimension);
      const Lame b = lameOf(high, dimension);
      const Lame& moved = second ? b : a;
      const double step = smallChange * (moved.lambda + 2 * moved.mu) /
        std::max({ std::abs(own.moduli[0] + 2 * own.moduli[1]), std::abs(own.moduli[1]), moved.mu * smallest });
      const auto at = [&](double steps)
      {
        Lame there = moved;
        there.lambda += steps * step * own.moduli[0];
        there.mu += steps * step * own.moduli[1];
        return laminate(second ? a : there, second ? there : b, share, dimension).axial;
      };
      const auto more = at(1);
      const auto less = at(-1);
      const auto most = at(2);
      const auto least = at(-2);
      ModulusChange& change = changes.emplace_back(ModulusChange{ own.number, {} });
      for (std::size_t k = 0; k < change.moduli.size(); ++k)
        change.moduli[k] = (8 * (more[k] - less[k]) - (most[k] - least[k])) / (12 * step);
    }
  return changes;
}

} // namespace

std::vector<VoxelMaterial> sharedMaterials(
  Continuum continuum, const VoxelMaterial& low, const VoxelMaterial& high, std::span<const double> shares)
{
  if (low.rigid || high.rigid)
    throw ParameterError("a rigid phase that shares voxels", "give it a Young's modulus, or take whole voxels");
  if (isVoid(low) && isVoid(high))
    throw NoPathError("all of the box is void", "give some phase a Young's modulus");
  const int dimension = dimensionOf(continuum);
  const bool solids = !isVoid(low) && !isVoid(high);
  if (solids && !(isIsotropic(low, dimension) && isIsotropic(high, dimension)))
    throw ParameterError("shares of two solids, one of them stiffer along an axis",
      "take isotropic ones, or one solid and a void, or whole voxels");
  std::vector<VoxelMaterial> materials;
  for (const double share : shares)
  {
    materials.push_back(share <= 0 ? low
        : share >= 1               ? high
        : solids                   ? laminate(lameOf(low, dimension), lameOf(high, dimension), share, dimension)
        : isVoid(low)              ? thinned(high, share)
                                   : thinned(low, 1 - share));
    if (solids && share > 0 && share < 1)
      materials.back().changes = laminateChanges(low, high, share, dimension);
  }
  return materials;
}

std::vector<std::array<float, 3>> shareAxes(
  const Lattice& lattice, std::span<const std::uint8_t> ids, std::span<const double> shares, bool periodic, int threads)
{
  std::vector<std::array<float, 3>> axes(ids.size());
  const auto [nx, ny, nz] = lattice.size;
  const auto near = [&](std::int64_t i, std::int64_t n) -> std::int64_t {
    return i >= 0 && i < n ? i : periodic ? (i + n) % n : std::clamp<std::int64_t>(i, 0, n - 1);
  };
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t z = 0; z < nz; ++z)
    for (std::int64_t y = 0; y < ny; ++y)
      for (std::int64_t x = 0; x < nx; ++x)
      {
        // central differences, smoothed across by 1, 2, 1
        std::array<double, 3> slope{};
        std::array<double, 3> bend{};
        const std::int64_t deep = nz > 1 ? 1 : 0;
        for (std::int64_t dz = -deep; dz <= deep; ++dz)
          for (std::int64_t dy = -1; dy <= 1; ++dy)
            for (std::int64_t dx = -1; dx <= 1; ++dx)
            {
              const double share = shares[ids[static_cast<std::size_t>(
                near(x + dx, nx) + nx * (near(y + dy, ny) + ny * near(z + dz, nz)))]];
              const std::array<std::int64_t, 3> d{ dx, dy, dz };
              for (std::size_t a = 0; a < 3; ++a)
              {
                double weight = 1;
                for (std::size_t b = 0; b < 3; ++b)
                  weight *= b != a && d[b] == 0 ? 2 : 1;
                slope[a] += weight * static_cast<double>(d[a]) * share;
                bend[a] += weight * (d[a] == 0 ? -2 : 1) * share;
              }
            }
        double length = 0;
        for (std::size_t a = 0; a < 3; ++a)
        {
          slope[a] /= lattice.aspect[a];
          bend[a] = std::abs(bend[a]) / (lattice.aspect[a] * lattice.aspect[a]);
          length = std::hypot(length, slope[a]);
        }
        auto& axis = axes[static_cast<std::size_t>(x + nx * (y + ny * z))];
        if (length > flat * 16)
          for (std::size_t a = 0; a < 3; ++a)
            axis[a] = static_cast<float>(slope[a]);
        else // in the middle of a thin layer
        {
          if (nz == 1)
            bend[2] = 0;
          axis[static_cast<std::size_t>(std::ranges::max_element(bend) - bend.begin())] = 1;
        }
      }
  return axes;
}

std::vector<std::uint8_t> coarserShares(const Lattice& lattice, std::span<const std::uint8_t> ids,
  std::span<const double> shares, const std::array<std::int64_t, 3>& size)
{
  // one axis after the other
  std::vector<float> values(ids.size());
  std::ranges::transform(ids, values.begin(), [&](std::uint8_t id) { return static_cast<float>(shares[id]); });
  std::array<std::int64_t, 3> now = lattice.size;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const std::int64_t n = now[a];
    const std::int64_t m = size[a];
    if (n == m)
      continue;
    std::array<std::int64_t, 3> next = now;
    next[a] = m;
    std::vector<float> mean(static_cast<std::size_t>(next[0] * next[1] * next[2]), 0.0F);
    const std::int64_t stride = std::accumulate(
      now.begin(), now.begin() + static_cast<std::ptrdiff_t>(a), std::int64_t{ 1 }, std::multiplies<>());
    const std::int64_t lines = static_cast<std::int64_t>(values.size()) / (stride * n);
    const double ratio = static_cast<double>(n) / static_cast<double>(m);
    for (std::int64_t i = 0; i < m; ++i)
      for (auto k = static_cast<std::int64_t>(std::floor(ratio * static_cast<double>(i) + 1e-9)); k < n; ++k)
      {
        const double covered = std::min(static_cast<double>(k) + 1, ratio * static_cast<double>(i + 1)) -
          std::max(static_cast<double>(k), ratio * static_cast<double>(i));
        if (covered <= 1e-9)
          break;
        const auto weight = static_cast<float>(covered / ratio);
        for (std::int64_t line = 0; line < lines; ++line)
          for (std::int64_t s = 0; s < stride; ++s)
            mean[static_cast<std::size_t>(s + stride * (i + m * line))] +=
              weight * values[static_cast<std::size_t>(s + stride * (k + n * line))];
      }
    values = std::move(mean);
    now = next;
  }
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::ranges::sort(order, {}, [&](std::size_t id) { return shares[id]; });
  std::vector<std::uint8_t> found;
  found.reserve(values.size());
  for (const float value : values)
  {
    const auto share = static_cast<double>(value);
    const auto above = std::ranges::lower_bound(order, share, {}, [&](std::size_t id) { return shares[id]; });
    const bool lower =
      above == order.end() || (above != order.begin() && share - shares[*(above - 1)] < shares[*above] - share);
    found.push_back(static_cast<std::uint8_t>(lower ? *(above - 1) : *above));
  }
  return found;
}

} // namespace lamella::elasticity
