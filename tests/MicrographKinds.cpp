#include "MicrographKinds.h"

#include "core/Random.h"
#include "generators/Generators.h"
#include "generators/MicrographLook.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

namespace lamella::kinds
{
namespace
{

using generators::Stain;
using micrograph::Picture;
using Colour = std::array<double, 3>;

/// A choice made once a picture.
struct Dice
{
  Random random;
  std::int64_t next = 0;
  explicit Dice(std::uint64_t seed)
    : random(seed)
  {
  }
  double between(double low, double high) { return low + (high - low) * random.uniform(RandomUse::Grime, next++); }
  bool often(double probability) { return between(0, 1) < probability; }
  std::size_t of(std::size_t n)
  {
    return std::min(n - 1, static_cast<std::size_t>(between(0, static_cast<double>(n))));
  }
};

Colour mixed(const Colour& a, const Colour& b, double part)
{
  Colour c{};
  for (std::size_t i = 0; i < 3; ++i)
    c[i] = a[i] + (b[i] - a[i]) * part;
  return c;
}

/// What is at a point.
struct Point
{
  Colour colour{};
  bool open = false;
};

/// A field of one channel, blurred by a Gaussian that is cut off after three deviations.
void blur(std::vector<double>& field, int width, int height, double sigma)
{
  if (!(sigma > 0))
    return;
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<double> weight;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i)
  {
    weight.push_back(std::exp(-i * i / (2 * sigma * sigma)));
    sum += weight.back();
  }
  std::vector<double> line;
  const auto along = [&](int count, int lines, std::size_t step, std::size_t stride)
  {
    line.resize(static_cast<std::size_t>(count));
    for (int k = 0; k < lines; ++k)
    {
      double* const first = field.data() + static_cast<std::size_t>(k) * stride;
      for (int i = 0; i < count; ++i)
      {
        double value = 0;
        for (int d = -reach; d <= reach; ++d)
          value += weight[static_cast<std::size_t>(d + reach)] *
            first[static_cast<std::size_t>(std::clamp(i + d, 0, count - 1)) * step];
        line[static_cast<std::size_t>(i)] = value / sum;
      }
      for (int i = 0; i < count; ++i)
        first[static_cast<std::size_t>(i) * step] = line[static_cast<std::size_t>(i)];
    }
  };
  along(width, height, 1, static_cast<std::size_t>(width));
  along(height, width, static_cast<std::size_t>(width), 1);
}

struct Optics
{
  double blur = 0.8;  ///< [pixels]
  double noise = 5;   ///< standard deviation
  double uneven = 0;  ///< share of the light lost in a corner
  bool colour = true; ///< else its mean
};

/// A picture of a function of the place, two by two points a pixel.
Sample render(
  int width, int height, const Optics& optics, std::uint64_t seed, const std::function<Point(double x, double y)>& at)
{
  Sample sample;
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::array<std::vector<double>, 3> seen{ std::vector<double>(count), std::vector<double>(count),
    std::vector<double>(count) };
  sample.open.resize(count);
  for (std::size_t node = 0; node < count; ++node)
  {
    const auto x = static_cast<double>(node % static_cast<std::size_t>(width));
    const auto y = static_cast<double>(node / static_cast<std::size_t>(width));
    int open = 0;
    for (int k = 0; k < 4; ++k)
    {
      const Point point = at(x + 0.25 + 0.5 * (k % 2), y + 0.25 + 0.5 * static_cast<double>(k / 2));
      open += point.open;
      for (std::size_t c = 0; c < 3; ++c)
        seen[c][node] += point.colour[c] / 4;
    }
    sample.open[node] = open >= 2;
  }
  const Random random(seed ^ 0x5eedU);
  sample.picture.lattice = makeLattice(width, height, 1, 2, 1);
  sample.picture.fileSize = sample.picture.lattice.size;
  for (auto& field : seen)
    blur(field, width, height, optics.blur);
  for (std::size_t node = 0; node < count; ++node)
  {
    const auto x = static_cast<std::int64_t>(node % static_cast<std::size_t>(width));
    const auto y = static_cast<std::int64_t>(node / static_cast<std::size_t>(width));
    const double light = 1 - optics.uneven * (static_cast<double>(x) / width + static_cast<double>(y) / height) / 2;
    std::array<std::uint16_t, 3> value{};
    double grey = 0;
    for (std::size_t c = 0; c < 3; ++c)
    {
      // A grey camera has one noise.
      const auto channel = static_cast<std::int64_t>(optics.colour ? c : 0);
      const double noisy = seen[c][node] * light + optics.noise * random.normal(RandomUse::Noise, x, y, channel);
      value[c] = static_cast<std::uint16_t>(std::clamp(std::lround(noisy), 0L, 255L));
      grey += std::array{ 0.299, 0.587, 0.114 }[c] * value[c];
    }
    sample.picture.grey.push_back(static_cast<std::uint16_t>(std::lround(grey)));
    if (optics.colour)
      sample.picture.colour.insert(sample.picture.colour.end(), value.begin(), value.end());
  }
  return sample;
}

/// Cells around the points of a shaken hexagonal lattice.
class Cells
{
public:
  Cells(std::uint64_t seed, double pitch, double shake, double stretch = 1)
    : random_(seed)
    , pitch_(pitch)
    , shake_(shake)
    , stretch_(stretch)
  {
  }
  struct At
  {
    std::int64_t cell = 0, next = 0; ///< numbers of the nearest and of the second nearest
    double edge = 0;                 ///< distance from the line between the two
    double corner = 0;               ///< about the distance from where a third one meets them
  };
  [[nodiscard]] At at(double x, double y) const
  {
    x /= stretch_;
    const double rowHeight = pitch_ * 0.866;
    const auto row = static_cast<std::int64_t>(std::floor(y / rowHeight));
    struct Near
    {
      double square, x, y;
      std::int64_t cell;
    };
    std::array<Near, 3> best{};
    best.fill({ std::numeric_limits<double>::max(), 0, 0, 0 });
    for (std::int64_t j = row - 2; j <= row + 2; ++j)
    {
      const double shift = (j & 1) != 0 ? pitch_ / 2 : 0;
      const auto column = static_cast<std::int64_t>(std::floor((x - shift) / pitch_));
      for (std::int64_t i = column - 2; i <= column + 2; ++i)
      {
        const double px = shift + (static_cast<double>(i) + 0.5) * pitch_ +
          shake_ * pitch_ * random_.normal(RandomUse::CellPlace, i, j, 0);
        const double py =
          (static_cast<double>(j) + 0.5) * rowHeight + shake_ * pitch_ * random_.normal(RandomUse::CellPlace, i, j, 1);
        const Near one{ (px - x) * (px - x) + (py - y) * (py - y), px, py, i * 100003 + j };
        const auto place = std::find_if(best.begin(), best.end(), [&](const Near& b) { return one.square < b.square; });
        if (place != best.end())
        {
          std::move_backward(place, best.end() - 1, best.end());
          *place = one;
        }
      }
    }
    const auto line = [&](const Near& other)
    { return (other.square - best[0].square) / (2 * std::hypot(other.x - best[0].x, other.y - best[0].y)); };
    return { best[0].cell, best[1].cell, line(best[1]), line(best[2]) };
  }

private:
  Random random_;
  double pitch_, shake_, stretch_;
};

struct Look
{
  Colour lumen, wall;
  bool colour = true;
};

Look lookOf(std::size_t which)
{
  switch (which)
  {
    case 0:
      return { { 232, 226, 230 }, { 176, 58, 122 } };
    case 1:
      return { { 226, 230, 234 }, { 62, 96, 170 } };
    default:
      return { { 48, 48, 48 }, { 176, 176, 176 }, false };
  }
}

/// Smooth noise over the plane, about ±1.
double cloud(const Random& random, double x, double y)
{
  return 0.7 * (random.smooth(RandomUse::Warp, 1, x + 0.37 * y) + random.smooth(RandomUse::Warp, 2, y - 0.41 * x));
}

Sample pith(std::uint64_t seed, bool other)
{
  Dice dice(seed);
  const double pitch = dice.between(18, 48);
  const Cells cells(seed, pitch, other ? 0.24 : 0.12, other ? 1.5 : 1);
  const double wall = std::max(1.5, pitch * dice.between(0.06, 0.12));
  const double share = dice.between(0.35, 0.6);
  const double pale = dice.between(0, 0.3);
  const Look look = lookOf(dice.of(3));
  const Random random(seed);
  const int size = static_cast<int>(dice.between(300, 460));
  Optics optics{ dice.between(0.5, 1.1), dice.between(2, 10), dice.between(0, 0.2), look.colour };
  Sample sample = render(size, size - 40, optics, seed,
    [&](double x, double y)
    {
      const Cells::At at = cells.at(x, y);
      if (at.edge < wall / 2)
        return Point{ look.wall, false };
      // In the other family whole groups of cells are filled.
      const bool filled = other ? cloud(random, x / (4 * pitch), y / (4 * pitch)) > 0.35 - 0.7 * share &&
          random.uniform(RandomUse::Stain, at.cell) < 0.9
                                : random.uniform(RandomUse::Stain, at.cell) < share;
      const double grain = other ? 0.08 * cloud(random, x / 4, y / 4) : 0;
      return Point{ filled ? mixed(look.wall, look.lumen, std::clamp(pale + grain, 0.0, 1.0)) : look.lumen, true };
    });
  sample.what = "half-stained thin-walled cells";
  return sample;
}

/// Disks that do not overlap, put down at random.
class Disks
{
public:
  Disks(std::uint64_t seed, int width, int height, double smallest, double largest, double share, double gap)
    : width_(width)
    , reach_(largest + gap)
  {
    const Random random(seed);
    columns_ = static_cast<int>(width / (2 * reach_)) + 2;
    double covered = 0;
    for (std::int64_t k = 0; k < 60000 && covered < share * width * height; ++k)
    {
      // Large ones first: they find no room later.
      const double radius = largest + (smallest - largest) * std::min(1.0, static_cast<double>(k) / 20000);
      const double x = random.uniform(RandomUse::GrainPlace, k, 0) * width;
      const double y = random.uniform(RandomUse::GrainPlace, k, 1) * height;
      if (fromNearest(x, y, gap).first > radius)
      {
        grid_[place(x, y)].push_back({ x, y, radius, k });
        covered += 3.14159 * radius * radius;
      }
    }
  }
  /// Distance from the nearest outline, negative inside, and the disk's number.
  [[nodiscard]] std::pair<double, std::int64_t> fromNearest(double x, double y, double gap = 0) const
  {
    std::pair<double, std::int64_t> best{ 2 * reach_, -1 };
    const auto [column, row] = cell(x, y);
    for (int j = row - 1; j <= row + 1; ++j)
    {
      for (int i = column - 1; i <= column + 1; ++i)
      {
        const auto found = grid_.find(i + columns_ * j);
        if (found == grid_.end())
          continue;
        for (const auto& disk : found->second)
        {
          const double distance = std::hypot(disk.x - x, disk.y - y) - disk.radius - gap;
          best = distance < best.first ? std::pair{ distance, disk.number } : best;
        }
      }
    }
    return best;
  }

private:
  struct Disk
  {
    double x, y, radius;
    std::int64_t number;
  };
  [[nodiscard]] std::pair<int, int> cell(double x, double y) const
  {
    return { static_cast<int>(x / (2 * reach_)) + 1, static_cast<int>(y / (2 * reach_)) + 1 };
  }
  [[nodiscard]] int place(double x, double y) const
  {
    const auto [column, row] = cell(x, y);
    return column + columns_ * row;
  }
  int width_;
  double reach_;
  int columns_ = 1;
  std::map<int, std::vector<Disk>> grid_;
};

Sample rock(std::uint64_t seed, bool electrons, bool other)
{
  Dice dice(seed);
  const int size = static_cast<int>(dice.between(340, 480));
  const double pitch = dice.between(36, 70);
  const Cells cells(seed, pitch, 0.2, dice.between(1, 1.4));
  const Disks disks(seed, size, size, pitch * 0.2, pitch * 0.62, 0.78, dice.between(-3, 0.5));
  const double touching = dice.between(0.2, 0.5);
  const double widest = dice.between(5, 12);
  const double corner = dice.between(0.1, 0.2) * pitch;
  const Random random(seed);
  const Colour resin = electrons ? Colour{ 25, 25, 25 }
    : other                      ? Colour{ 40, 90, dice.between(150, 190) }
                                 : Colour{ dice.between(60, 110), dice.between(125, 165), dice.between(190, 225) };
  const Optics optics{ dice.between(0.5, 1.2), dice.between(2, 7), 0, !electrons };
  const auto mineral = [&](std::int64_t grain, double x, double y)
  {
    const double kind = random.uniform(RandomUse::GrainOrder, grain);
    const double shade = random.normal(RandomUse::GrainSize, grain);
    if (electrons)
    {
      const double grey = (kind < 0.7 ? 120 : kind < 0.93 ? 150 : 225) + 3 * shade;
      return Colour{ grey, grey, grey };
    }
    const double cloudy = cloud(random, x / 6, y / 6);
    Colour colour = kind < 0.75 ? Colour{ 234, 231, 224 }
      : kind < 0.92             ? Colour{ 196, 190, 178 }
                                : Colour{ 112, 88, 66 };
    for (double& c : colour)
      c += 6 * shade + (kind < 0.75 ? 3 : 14) * cloudy;
    return colour;
  };
  Sample sample = render(size, size, optics, seed,
    [&](double x, double y)
    {
      if (other)
      {
        const auto [distance, grain] = disks.fromNearest(x, y);
        return distance > 0 ? Point{ resin, true } : Point{ mineral(grain, x, y), false };
      }
      const Cells::At at = cells.at(x, y);
      const auto pair = std::minmax(at.cell, at.next);
      const double draw = random.uniform(RandomUse::VesselGap, pair.first, pair.second);
      const double gap = draw < touching ? 0 : widest * draw;
      const bool pore = at.edge < gap / 2 || (at.corner < corner && at.edge < corner * 0.8);
      return pore ? Point{ resin, true } : Point{ mineral(at.cell, x, y), false };
    });
  sample.what = other ? "round grains in resin" : "grains that touch";
  return sample;
}

Sample tomogram(std::uint64_t seed, bool other)
{
  Dice dice(seed);
  const int size = static_cast<int>(dice.between(280, 420));
  const double radius = dice.between(6, 15);
  const Disks fibres(seed, size, size, radius * 0.85, radius, dice.between(0.3, 0.45), 1);
  const Disks voids(seed + 1000, size, size, size * 0.04, size * 0.11, dice.between(0.1, 0.25), 2);
  const Random random(seed);
  const bool darkFibre = dice.often(0.4);
  const double middle = dice.between(95, 135);
  const double high = dice.between(185, 215);
  const std::array<double, 3> grey{ dice.between(25, 45), darkFibre ? high : middle, darkFibre ? middle : high };
  const Optics optics{ dice.between(0.8, 1.6), dice.between(5, 16), 0, false };
  const double band = dice.between(20, 40);
  Sample sample = render(size, size, optics, seed,
    [&](double x, double y)
    {
      std::size_t phase = 1;
      if (other)
      {
        // Layers of fibre in matrix, cut by cracks and holes.
        const double bent = y + 12 * cloud(random, x / 90, 3);
        const double layer = bent / band - std::floor(bent / band);
        phase = layer < 0.55 ? 2 : 1;
        phase = cloud(random, x / 35, y / 35) > 0.75 ? 0 : phase;
      }
      else
      {
        phase = voids.fromNearest(x, y).first < 0 ? 0 : fibres.fromNearest(x, y).first < 0 ? 2 : 1;
      }
      return Point{ { grey[phase], grey[phase], grey[phase] }, phase == 0 };
    });
  sample.what = other ? "layers, matrix and holes" : "fibres, matrix and holes";
  return sample;
}

/// A tissue on nodes n times finer than the picture's pixels, seen through the look's optics.
Sample seenTissue(const PhaseImage& fine, int n, const generators::LookOptions& look)
{
  Sample sample;
  sample.picture = generators::makeLook(fine, n, look);
  const std::int64_t nx = fine.lattice.size[0] / n;
  const std::int64_t ny = fine.lattice.size[1] / n;
  sample.open.resize(static_cast<std::size_t>(nx * ny));
  for (std::int64_t node = 0; node < nx * ny; ++node)
  {
    std::int64_t wall = 0;
    for (std::int64_t k = 0; k < std::int64_t{ n } * n; ++k)
      wall += fine.phase[fine.lattice.index(node % nx * n + k % n, node / nx * n + k / n)];
    sample.open[static_cast<std::size_t>(node)] = 2 * wall < std::int64_t{ n } * n;
  }
  return sample;
}

generators::LookOptions look(Dice& dice, std::uint64_t seed, double pixel)
{
  generators::LookOptions o;
  o.stain = std::array{ Stain::Magenta, Stain::Blue, Stain::Grey }[dice.of(3)];
  o.strength = dice.between(0.6, 1.4);
  o.blur = pixel * dice.between(0.4, 1.3);
  o.noise = dice.between(0.005, 0.045);
  o.unevenLight = dice.between(0, 0.3);
  o.dirt = dice.between(0, 12);
  o.seed = seed;
  return o;
}

struct TissueOptions
{
  bool hardwood = false;
  double spacing = 0.25e-6; ///< of the nodes [m]
  int finer = 2;
  std::int64_t width = 420, height = 340; ///< [pixels]
  double solid = 0.4;
  double ring0 = 0, ring1 = 0;
  double cell = 1; ///< cells so many times larger
  double earlyEnd = 0.6;
  double rays = 1; ///< so many times as far apart
};

PhaseImage tissue(const TissueOptions& o, std::uint64_t seed)
{
  if (o.hardwood)
  {
    generators::HardwoodOptions h;
    h.size = { o.width * o.finer, o.height * o.finer, 1 };
    h.spacing = o.spacing;
    h.solidFraction = o.solid;
    h.fibreDiameter *= o.cell;
    h.earlyEnd = o.earlyEnd;
    h.ringPosition0 = o.ring0;
    h.ringPosition1 = o.ring1;
    h.seed = seed;
    return generators::hardwood(h);
  }
  generators::SoftwoodOptions s;
  s.size = { o.width * o.finer, o.height * o.finer, 1 };
  s.spacing = o.spacing;
  s.solidFraction = o.solid;
  s.ringPosition0 = o.ring0;
  s.ringPosition1 = o.ring1;
  s.tangentialDiameter *= o.cell;
  s.radialDiameterEarly *= o.cell;
  s.radialDiameterLate *= o.cell;
  s.rayEvery *= o.rays;
  s.seed = seed;
  return generators::softwood(s);
}

/// Foams and parenchyma: closed cells, none of them filled.
Sample cellular(std::uint64_t seed, bool other)
{
  Dice dice(seed);
  const double pitch = dice.between(22, 44);
  const Cells cells(seed, pitch, other ? 0.2 : 0.12, other ? 1.3 : 1);
  const double wall = pitch * dice.between(0.1, 0.3);
  const Look colours = lookOf(dice.of(3));
  const Disks disks(seed, 420, 340, pitch * 0.25, pitch * 0.5, 0.55, 2);
  const bool round = other && dice.often(0.5);
  Optics optics{ dice.between(0.5, 1.2), dice.between(2, 9), dice.between(0, 0.2), colours.colour };
  Sample sample = render(420, 340, optics, seed,
    [&](double x, double y)
    {
      const bool open = round ? disks.fromNearest(x, y).first < 0 : cells.at(x, y).edge > wall / 2;
      return Point{ open ? colours.lumen : colours.wall, open };
    });
  sample.what = round ? "round holes" : "closed cells";
  return sample;
}

Sample good(std::uint64_t seed, bool other)
{
  Dice dice(seed);
  const std::size_t which = dice.of(6);
  if (which == 5)
    return cellular(seed, other);
  TissueOptions o;
  o.width = static_cast<std::int64_t>(dice.between(320, 560));
  o.height = static_cast<std::int64_t>(dice.between(280, 440));
  std::string what;
  if (which < 2)
  {
    o.solid = dice.between(0.3, 0.5);
    o.cell = other ? dice.between(0.8, 1.4) : 1;
    o.spacing = dice.between(0.2e-6, 0.4e-6);
    what = "softwood";
  }
  else if (which == 2)
  {
    o.ring1 = 1;
    o.solid = dice.between(0.45, 0.55);
    o.rays = other ? 0.6 : 1;
    o.spacing = 0.25e-6;
    what = "softwood, a ring";
  }
  else if (which == 3)
  {
    o.ring0 = o.ring1 = 1;
    o.solid = other ? dice.between(0.6, 0.7) : dice.between(0.66, 0.78);
    o.spacing = 0.2e-6;
    what = "latewood";
  }
  else
  {
    o.hardwood = true;
    o.solid = dice.between(0.36, 0.5);
    o.earlyEnd = other ? 0.25 : 0.6;
    o.ring1 = other ? 0.8 : 0;
    o.cell = other ? 1.2 : 1;
    o.spacing = dice.between(0.2e-6, 0.3e-6);
    what = "hardwood";
  }
  Sample sample = seenTissue(tissue(o, seed), o.finer, look(dice, seed, o.spacing * o.finer));
  sample.what = what;
  return sample;
}

Sample coarse(std::uint64_t seed, bool other)
{
  Dice dice(seed);
  TissueOptions o;
  o.finer = 8;
  o.width = o.height = 160;
  if (other)
  {
    o.ring0 = o.ring1 = 1; // latewood, 15 µm by 30 µm: lumens some 6 µm wide
    o.solid = dice.between(0.6, 0.72);
    o.spacing = dice.between(0.25e-6, 0.37e-6);
  }
  else
  {
    o.hardwood = true; // as maple: fibres of 14 µm, walls of half of that
    o.cell = 14.0 / 16;
    o.solid = dice.between(0.45, 0.55);
    o.spacing = dice.between(0.3e-6, 0.45e-6);
  }
  generators::LookOptions seen = look(dice, seed, o.spacing * o.finer);
  seen.blur = o.spacing * o.finer * dice.between(0.5, 1);
  Sample sample = seenTissue(tissue(o, seed), o.finer, seen);
  sample.what = other ? "latewood, lumens of a few pixels" : "hardwood, fibres' lumens of a few pixels";
  return sample;
}

/// Puts the colour of the lumens where a shape is.
void uncover(Sample& sample, const std::function<double(double x, double y)>& inside, const Random& random)
{
  Picture& picture = sample.picture;
  const std::size_t channels = picture.colour.empty() ? 1 : 3;
  auto& values = picture.colour.empty() ? picture.grey : picture.colour;
  std::array<double, 3> level{};
  std::array<double, 3> count{};
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    level[i % channels] += sample.open[i / channels] ? values[i] : 0;
    count[i % channels] += sample.open[i / channels] ? 1 : 0;
  }
  const auto width = static_cast<std::size_t>(picture.lattice.size[0]);
  for (std::size_t node = 0; node < picture.grey.size(); ++node)
  {
    const double part =
      std::clamp(inside(static_cast<double>(node % width), static_cast<double>(node / width)), 0.0, 1.0);
    for (std::size_t c = 0; c < channels && part > 0; ++c)
    {
      auto& value = values[channels * node + c];
      const double clear =
        level[c] / count[c] + 4 * random.normal(RandomUse::Tear, static_cast<std::int64_t>(node), static_cast<int>(c));
      value = static_cast<std::uint16_t>(std::clamp(std::lround(value + part * (clear - value)), 0L, 255L));
    }
    if (channels == 3)
    {
      picture.grey[node] = static_cast<std::uint16_t>(
        std::lround(0.299 * values[3 * node] + 0.587 * values[3 * node + 1] + 0.114 * values[3 * node + 2]));
    }
  }
}

Sample torn(std::uint64_t seed, bool other)
{
  Dice dice(seed);
  Sample sample;
  do
  {
    sample = good(static_cast<std::uint64_t>(dice.between(1, 1e6)), other);
  } while (sample.what == "closed cells" || sample.what == "round holes");
  const auto width = static_cast<double>(sample.picture.lattice.size[0]);
  const auto height = static_cast<double>(sample.picture.lattice.size[1]);
  const Random random(seed);
  struct Tear
  {
    double x, y, cosine, sine, length, half;
  };
  std::vector<Tear> tears;
  const std::size_t count = other ? 1 : 1 + dice.of(3);
  for (std::size_t i = 0; i < count; ++i)
  {
    const double angle = dice.between(0, 3.14159);
    const double long_ = other ? 2 * width : dice.between(0.35, 0.7) * width;
    tears.push_back({ dice.between(0.2, 0.8) * width, dice.between(0.2, 0.8) * height, std::cos(angle), std::sin(angle),
      long_ / 2, dice.between(0.025, 0.05) * width });
  }
  uncover(
    sample,
    [&](double x, double y)
    {
      double most = -10;
      for (const Tear& tear : tears)
      {
        const double u = (x - tear.x) * tear.cosine + (y - tear.y) * tear.sine;
        const double v = (y - tear.y) * tear.cosine - (x - tear.x) * tear.sine;
        const double taper = std::sqrt(std::max(0.0, 1 - u * u / (tear.length * tear.length)));
        most = std::max(most,
          tear.half * taper * (1 + 0.4 * random.smooth(RandomUse::Tear, 7, u / 14)) -
            std::abs(v - 6 * random.smooth(RandomUse::Tear, 9, u / 30)));
      }
      return most / 1.5;
    },
    random);
  sample.what += other ? ", torn from side to side" : ", torn";
  return sample;
}

Sample background(std::uint64_t seed, bool other)
{
  Dice dice(seed);
  Sample sample;
  do
  {
    sample = good(static_cast<std::uint64_t>(dice.between(1, 1e6)), other);
  } while (sample.what == "closed cells" || sample.what == "round holes");
  const auto width = static_cast<double>(sample.picture.lattice.size[0]);
  const auto height = static_cast<double>(sample.picture.lattice.size[1]);
  const Random random(seed);
  const double part = dice.between(0.12, 0.4);
  const bool side = dice.often(0.5);
  uncover(
    sample,
    [&](double x, double y)
    {
      const double wavy = 10 * random.smooth(RandomUse::Tear, 3, (side ? y : x) / 25);
      if (other) // a corner, or a bent strip along two sides
      {
        const double away = std::hypot(x / width, y / height);
        return (std::sqrt(part) * 1.1 - away) * width / 2 + wavy / 3;
      }
      return part * (side ? width : height) - (side ? x : y) + wavy;
    },
    random);
  sample.what += other ? ", a corner of the slide" : ", a side of the slide";
  return sample;
}

} // namespace

std::string name(Kind kind)
{
  return std::array{ "whole tissue, foam", "half-stained cells", "rock in resin", "rock by electrons",
    "tomogram of three phases", "lumens of 2 to 4 pixels", "torn tissue", "slide background" }
    .at(static_cast<std::size_t>(kind));
}

const std::vector<Kind>& faulty()
{
  static const std::vector<Kind> all{ Kind::Pith, Kind::Rock, Kind::RockGrey, Kind::Tomogram, Kind::Coarse, Kind::Torn,
    Kind::Background };
  return all;
}

Sample draw(Kind kind, std::uint64_t seed, bool other)
{
  const auto drawn = [&]
  {
    switch (kind)
    {
      case Kind::Pith:
        return pith(seed, other);
      case Kind::Rock:
        return rock(seed, false, other);
      case Kind::RockGrey:
        return rock(seed, true, other);
      case Kind::Tomogram:
        return tomogram(seed, other);
      case Kind::Coarse:
        return coarse(seed, other);
      case Kind::Torn:
        return torn(seed, other);
      case Kind::Background:
        return background(seed, other);
      default:
        return good(seed, other);
    }
  };
  Sample sample = drawn();
  sample.kind = kind;
  return sample;
}

bool Agreement::right() const
{
  return overlap >= 0.9 && std::abs(excess) <= 0.03;
}

Agreement compare(const PhaseImage& found, const std::vector<bool>& open)
{
  double both = 0;
  double either = 0;
  double excess = 0;
  for (std::size_t i = 0; i < open.size(); ++i)
  {
    const bool lumen = found.phase[i] == 0;
    both += lumen && open[i];
    either += lumen || open[i];
    excess += static_cast<double>(lumen) - static_cast<double>(open[i]);
  }
  return { either > 0 ? both / either : 1, excess / static_cast<double>(open.size()) };
}

} // namespace lamella::kinds
