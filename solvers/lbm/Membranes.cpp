#include "lbm/Membranes.h"

#include "core/Error.h"
#include "lbm/Links.h"
#include "lbm/SurfaceSlope.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace lamella::lbm
{
namespace
{

constexpr int finestLevels = 32;
constexpr int coarsestLevels = 4;
constexpr std::size_t mostIds = 256;

/// Which membrane lies between two phases: its place in the list and 1, 0: none.
std::vector<std::uint16_t> byPair(std::span<const Membrane> membranes)
{
  std::vector<std::uint16_t> place(mostIds * mostIds, 0);
  for (std::size_t i = 0; i < membranes.size(); ++i)
  {
    const Membrane& m = membranes[i];
    if (m.first == m.second)
      throw ParameterError(fmt::format("a membrane between phase {} and itself", m.first), "name two different phases");
    if (!std::isfinite(m.resistance) || m.resistance < 0)
      throw ParameterError(fmt::format("a membrane's resistance is {}", m.resistance),
        "give a finite number of at least 0; for phases that do not exchange a very large one");
    auto& one = place[m.first * mostIds + m.second];
    if (one != 0)
      throw ParameterError(
        fmt::format("two membranes between phases {} and {}", m.first, m.second), "give every pair one resistance");
    one = place[m.second * mostIds + m.first] = static_cast<std::uint16_t>(i + 1);
  }
  return place;
}

/// Surface over faces of a pixel as a byte.
struct Scale
{
  double range;                                ///< from planes along the lattice, 1, to diagonal ones
  static constexpr std::uint8_t elsewhere = 0; ///< at no membrane
  static constexpr std::uint8_t unknown = 1;
  static constexpr std::uint8_t steepest = 2;
  static constexpr std::uint8_t flat = 255;

  [[nodiscard]] std::uint8_t step(double flatness) const noexcept
  {
    return static_cast<std::uint8_t>(
      flat - std::clamp<long>(std::lround((1 - flatness) / range * (flat - steepest)), 0, flat - steepest));
  }
  [[nodiscard]] double flatness(std::uint8_t step) const noexcept
  {
    return 1 - range * (flat - step) / (flat - steepest);
  }
};

/// The pixels that tell the normal of one: of cubes 5 × 5 (× 5), which is the sum of Sobel's over 3 × 3 (× 3) pixels;
/// else as many more along an axis as spacings are shorter than the longest one, with weights as long as there.
class NormalWindow
{
public:
  using Sum = double;
  static constexpr int coarsest = 2; ///< reach along the longest spacing
  static constexpr int farthest = 40;

  NormalWindow(const Lattice& lattice, const std::array<std::int64_t, 3>& size)
  {
    std::size_t longest = 0;
    std::size_t shortest = 0;
    for (std::size_t a = 0; a < 3; ++a)
      if (size[a] > 1)
      {
        if (size[longest] == 1 || lattice.aspect[a] > lattice.aspect[longest])
          longest = a;
        if (size[shortest] == 1 || lattice.aspect[a] < lattice.aspect[shortest])
          shortest = a;
      }
    constexpr double width = coarsest + 0.5;
    std::array<double, 3> slopes{};  // Σ |step|
    std::array<double, 3> weights{}; // their sum
    for (std::size_t a = 0; a < 3; ++a)
    {
      const double ratio = std::max(1.0, lattice.aspect[longest] / lattice.aspect[a]);
      reach_[a] = a == 2 && lattice.dimension == 2 ? 0
        : size[a] == 1                             ? coarsest
                                                   : static_cast<int>(std::lround(width * ratio - 0.5));
      if (reach_[a] > farthest)
        throw ParameterError(
          fmt::format("membranes between voxels with edges of {:g} and {:g}",
            lattice.spacingAlong(static_cast<int>(longest)), lattice.spacingAlong(static_cast<int>(shortest))),
          fmt::format(
            "with membranes they may differ by a factor of {:g}: resample the sample to voxels nearer to cubes",
            (farthest + 0.5) / width));
      for (int step = -reach_[a]; step <= reach_[a]; ++step)
      {
        weight_[a].push_back(falling(std::abs(step) * std::min(1.0, width / (reach_[a] + 0.5))));
        slopes[a] += std::abs(step);
        weights[a] += weight_[a].back();
      }
    }
    const auto response = [&](std::size_t a)
    { return slopes[a] * weights[(a + 1) % 3] * weights[(a + 2) % 3] * lattice.aspect[a]; };
    for (std::size_t a = 0; a < 3; ++a)
      unit_[a] = slopes[a] > 0 ? response(0) / response(a) : 0;
  }

  [[nodiscard]] int reach(std::size_t axis) const noexcept { return reach_[axis]; }
  [[nodiscard]] double weight(std::size_t axis, int step) const noexcept
  {
    return weight_[axis][static_cast<std::size_t>(step + reach_[axis])];
  }
  /// What a component of the slope is to be multiplied by, for all of them to be by the same length.
  [[nodiscard]] double unit(std::size_t axis) const noexcept { return unit_[axis]; }

private:
  /// 4, 3, 1, 0 at 0, 1, 2, 3, straight between.
  static double falling(double distance) noexcept
  {
    return distance < 1 ? 4 - distance : distance < 2 ? 5 - 2 * distance : std::max(0.0, 3 - distance);
  }

  std::array<int, 3> reach_{};
  std::array<std::vector<double>, 3> weight_;
  std::array<double, 3> unit_{};
};

std::array<std::int64_t, 3> pixelsOf(const Lattice& lattice, int refinement)
{
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  for (std::size_t a = 0; a < 3; ++a)
    size[a] = std::max<std::int64_t>(1, lattice.size[a] / refinement);
  return size;
}

/// The pixels of a picture, of which each may be several nodes.
class Pixels
{
public:
  Pixels(const PhaseImage& image, int refinement, std::array<bool, 3> wraps)
    : image_(image)
    , refinement_(refinement)
    , wraps_(wraps)
    , size_(pixelsOf(image.lattice, refinement))
    , window_(image.lattice, size_)
  {
    if (refinement == 1)
      return;
    own_.reserve(static_cast<std::size_t>(count()));
    for (std::int64_t z = 0; z < size_[2]; ++z)
      for (std::int64_t y = 0; y < size_[1]; ++y)
        for (std::int64_t x = 0; x < size_[0]; ++x)
          own_.push_back(image.phase[static_cast<std::size_t>(
            image.lattice.index(x * refinement, y * refinement, image.lattice.dimension == 3 ? z * refinement : 0))]);
  }

  [[nodiscard]] std::int64_t size(std::size_t axis) const noexcept { return size_[axis]; }
  [[nodiscard]] std::int64_t count() const noexcept { return size_[0] * size_[1] * size_[2]; }
  [[nodiscard]] std::int64_t at(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept
  {
    return x + size_[0] * (y + size_[1] * z);
  }
  [[nodiscard]] const std::uint8_t* ids() const noexcept
  {
    return refinement_ == 1 ? image_.phase.data() : own_.data();
  }
  /// The next one along an axis; none beyond a side that does not wrap.
  [[nodiscard]] std::optional<std::int64_t> next(std::array<std::int64_t, 3> p, std::size_t axis) const noexcept
  {
    if (++p[axis] == size_[axis])
    {
      if (!wraps_[axis] || size_[axis] == 1)
        return std::nullopt;
      p[axis] = 0;
    }
    return at(p[0], p[1], p[2]);
  }
  /// Surface over faces at a pixel; 0 where nothing tells.
  [[nodiscard]] double flatness(std::int64_t x, std::int64_t y, std::int64_t z) const
  {
    const int reach = window_.reach(0);
    std::array<std::int64_t, 2 * NormalWindow::farthest + 1> along{};
    for (int d = -reach; d <= reach; ++d)
      along[static_cast<std::size_t>(d + reach)] = placed(x + d, 0);
    const std::array<double, 3> slope = surfaceSlope(ids()[at(x, y, z)], window_, along,
      [&](int dy, int dz) { return ids() + at(0, placed(y + dy, 1), placed(z + dz, 2)); });
    double faces = 0;
    double square = 0;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const double component = std::abs(slope[a] * window_.unit(a));
      faces += component;
      square += component * component;
    }
    return faces > 0 ? std::sqrt(square) / faces : 0;
  }

private:
  // Beyond a side what repeats, or its mirror image.
  [[nodiscard]] std::int64_t placed(std::int64_t i, std::size_t axis) const noexcept
  {
    const std::int64_t n = size_[axis];
    if (wraps_[axis])
      return ((i % n) + n) % n;
    return std::clamp<std::int64_t>(i < 0 ? -1 - i : i >= n ? 2 * n - 1 - i : i, 0, n - 1);
  }

  const PhaseImage& image_;
  int refinement_;
  std::array<bool, 3> wraps_;
  std::array<std::int64_t, 3> size_;
  NormalWindow window_;
  std::vector<std::uint8_t> own_; ///< where they are not the image's nodes
};

template <class F>
void forEach(const Pixels& pixels, F&& f)
{
  std::int64_t i = 0;
  for (std::int64_t z = 0; z < pixels.size(2); ++z)
    for (std::int64_t y = 0; y < pixels.size(1); ++y)
      for (std::int64_t x = 0; x < pixels.size(0); ++x, ++i)
        f(i, std::array{ x, y, z });
}

/// f(membrane, pixel, the other one, axis)
template <class F>
void forEachFace(const Pixels& pixels, const std::vector<std::uint16_t>& place, F&& f)
{
  forEach(
    pixels,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& p)
    {
      for (std::size_t a = 0; a < 3; ++a)
        if (const std::optional<std::int64_t> other = pixels.next(p, a))
          if (const auto membrane = place[pixels.ids()[i] * mostIds + pixels.ids()[*other]]; membrane != 0)
            f(static_cast<std::size_t>(membrane - 1), i, *other, a);
    });
}

/// Of links along an axis, by its spacing: by the ids at both ends, surface over faces and spacing.
double surfaceOf(const MembraneIds& ids, const Lattice& lattice, std::size_t axis, std::size_t a, std::size_t b)
{
  return lattice.spacingAlong(static_cast<int>(axis)) * 0.5 * (ids.flatness[a] + ids.flatness[b]);
}

} // namespace

MembraneIds membraneIds(
  const PhaseImage& image, int refinement, std::span<const Membrane> membranes, std::array<bool, 3> wraps)
{
  const std::vector<std::uint16_t> place = byPair(membranes);
  const Pixels pixels(image, refinement, wraps);
  const Scale scale{ 1 - 1 / (image.lattice.dimension == 3 ? std::numbers::sqrt3 : std::numbers::sqrt2) };
  std::vector<std::uint8_t> flatness(static_cast<std::size_t>(pixels.count()), Scale::elsewhere);
  const auto of = [&](std::int64_t i) -> std::uint8_t& { return flatness[static_cast<std::size_t>(i)]; };
  forEachFace(
    pixels, place, [&](std::size_t, std::int64_t i, std::int64_t j, std::size_t) { of(i) = of(j) = Scale::unknown; });
  forEach(pixels,
    [&](std::int64_t i, const std::array<std::int64_t, 3>& p)
    {
      if (of(i) == Scale::unknown)
        if (const double f = pixels.flatness(p[0], p[1], p[2]); f > 0)
          of(i) = scale.step(f);
    });
  // A wall of one pixel lies on both sides alike: what is on them tells.
  std::map<std::int64_t, std::pair<double, int>> beside;
  forEachFace(pixels, place,
    [&](std::size_t, std::int64_t i, std::int64_t j, std::size_t)
    {
      for (const auto& [here, there] : { std::pair{ i, j }, std::pair{ j, i } })
        if (of(here) == Scale::unknown)
        {
          auto& [sum, count] = beside[here];
          if (of(there) != Scale::unknown)
          {
            sum += scale.flatness(of(there));
            ++count;
          }
        }
    });
  for (const auto& [i, mean] : beside)
    of(i) = scale.step(mean.second > 0 ? mean.first / mean.second : 1.0);

  MembraneIds result;
  std::array<bool, mostIds> there{};
  for (const std::uint8_t phase : image.phase)
    there[phase] = true;
  std::vector<std::uint8_t> own(flatness.size()); // id of each pixel
  for (int levels = finestLevels;; levels /= 2)
  {
    const auto levelOf = [&](std::uint8_t step)
    {
      return step < Scale::steepest ? 0
                                    : static_cast<int>(std::lround((1 - scale.flatness(step)) / scale.range * levels));
    };
    // a phase's first id is that of its nodes away from membranes, too
    std::vector<std::array<std::int16_t, finestLevels + 1>> idOf(mostIds);
    result.phase.clear();
    for (std::size_t phase = 0; phase < mostIds; ++phase)
    {
      idOf[phase].fill(-1);
      if (!there[phase])
        continue;
      idOf[phase][0] = static_cast<std::int16_t>(result.phase.size());
      result.phase.push_back(static_cast<std::uint8_t>(phase));
    }
    for (std::size_t i = 0; i < flatness.size(); ++i)
    {
      const std::uint8_t phase = pixels.ids()[i];
      auto& id = idOf[phase][static_cast<std::size_t>(levelOf(flatness[i]))];
      if (id < 0)
      {
        id = static_cast<std::int16_t>(result.phase.size());
        result.phase.push_back(phase);
      }
      own[i] = static_cast<std::uint8_t>(id);
    }
    if (result.phase.size() <= mostIds)
      break;
    if (levels == coarsestLevels)
      throw ParameterError(fmt::format("membranes in a picture of {} phases", std::ranges::count(there, true)),
        "join phases that are alike");
  }
  // each id has the mean of its nodes
  result.flatness.assign(result.phase.size(), 0.0);
  std::vector<double> count(result.phase.size(), 0.0);
  for (std::size_t i = 0; i < flatness.size(); ++i)
    if (flatness[i] >= Scale::steepest)
    {
      result.flatness[own[i]] += scale.flatness(flatness[i]);
      count[own[i]] += 1;
    }
  for (std::size_t id = 0; id < count.size(); ++id)
    result.flatness[id] = count[id] > 0 ? result.flatness[id] / count[id] : 1.0;
  result.area.assign(membranes.size(), 0.0);
  result.across.assign(membranes.size(), { 0, 0, 0 });
  const auto pixelCount = static_cast<double>(pixels.count());
  forEachFace(pixels, place,
    [&](std::size_t m, std::int64_t i, std::int64_t j, std::size_t axis)
    {
      const double f =
        0.5 * (result.flatness[own[static_cast<std::size_t>(i)]] + result.flatness[own[static_cast<std::size_t>(j)]]);
      const double share = 1 / (pixelCount * refinement * image.lattice.aspect[axis]);
      result.area[m] += f * share;
      result.across[m][axis] += share / f;
    });
  if (refinement == 1)
  {
    result.id = std::move(own);
    return result;
  }
  result.id.reserve(image.phase.size());
  const auto& size = image.lattice.size;
  for (std::int64_t z = 0; z < size[2]; ++z)
    for (std::int64_t y = 0; y < size[1]; ++y)
      for (std::int64_t x = 0; x < size[0]; ++x)
        result.id.push_back(own[static_cast<std::size_t>(
          pixels.at(x / refinement, y / refinement, image.lattice.dimension == 3 ? z / refinement : 0))]);
  return result;
}

PairTable membraneLinks(const MembraneIds& ids, std::span<const double> conductivity,
  std::span<const Membrane> membranes, const Lattice& lattice)
{
  const std::vector<std::uint16_t> place = byPair(membranes);
  for (const std::uint8_t phase : ids.phase)
    if (phase >= conductivity.size())
      throw ParameterError(fmt::format("phase {} has no conductivity", phase), "give one value for each phase");
  PairTable table;
  table.ids = ids.phase.size();
  const std::size_t all = table.ids * table.ids;
  const std::size_t tables = lattice.cubes() ? 1 : 3;
  table.link.resize(tables * all);
  for (std::size_t axis = 0; axis < tables; ++axis)
    for (std::size_t a = 0; a < table.ids; ++a)
      for (std::size_t b = 0; b <= a; ++b)
      {
        const double one = conductivity[ids.phase[a]];
        const double other = conductivity[ids.phase[b]];
        double g = one == other ? one : harmonicMean(one, other);
        if (const auto m = place[ids.phase[a] * mostIds + ids.phase[b]]; m != 0 && g > 0)
          g = 1 / (1 / g + membranes[m - 1U].resistance / surfaceOf(ids, lattice, axis, a, b));
        table.link[axis * all + a * table.ids + b] = table.link[axis * all + b * table.ids + a] = g;
      }
  return table;
}

ConductivityDerivatives membraneDerivatives(std::span<const double> pairDerivatives, const MembraneIds& ids,
  std::span<const double> conductivity, std::span<const Membrane> membranes, const Lattice& lattice)
{
  const std::vector<std::uint16_t> place = byPair(membranes);
  const PairTable table = membraneLinks(ids, conductivity, membranes, lattice);
  const std::size_t all = table.ids * table.ids;
  ConductivityDerivatives d;
  for (const double k : conductivity)
    d.along.push_back(k > 0 ? 0.0 : std::numeric_limits<double>::quiet_NaN());
  d.membranes.assign(membranes.size(), 0.0);
  for (std::size_t i = 0; i < table.link.size(); ++i)
  {
    const double e = pairDerivatives[i];
    if (!(e > 0))
      continue;
    const std::size_t a = i % all / table.ids;
    const std::size_t b = i % table.ids;
    // of the halves in series: ∂ ln g / ∂k = g/(2 k²), ∂ ln g / ∂R = −g/(δ f)
    const double g = table.link[i];
    for (const std::size_t end : { a, b })
      d.along[ids.phase[end]] += e * g / (2 * conductivity[ids.phase[end]]) / conductivity[ids.phase[end]];
    if (const auto m = place[ids.phase[a] * mostIds + ids.phase[b]]; m != 0)
      d.membranes[m - 1U] -= e * g / surfaceOf(ids, lattice, i / all, a, b);
  }
  return d;
}

} // namespace lamella::lbm
