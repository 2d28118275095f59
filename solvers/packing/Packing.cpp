#include "packing/Packing.h"

#include "core/Error.h"
#include "core/Random.h"
#include "packing/Grading.h"
#include "packing/GrainSystem.h"
#include "packing/Relaxation.h"
#include "packing/Texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lamella::packing
{
namespace
{

template <int Dim>
class Compaction
{
public:
  using System = GrainSystem<Dim>;
  using Vec = typename System::Vec;

  explicit Compaction(const PackingOptions& options)
    : o_(options)
  {
    relaxation_.interrupted = [this]
    {
      report(reported_);
      return o_.interrupted && o_.interrupted();
    };
    if (o_.every > 0 && o_.state)
      relaxation_.watch = [this](std::int64_t steps) { tell(steps); };
    relaxation_.aspect = o_.aspect;
    relaxation_.shapeShare = shapeShare;
  }

  Packing run()
  {
    start();
    if (o_.packingFraction)
    {
      loosely();
      return result(0);
    }
    compact();
    double scale = 0; // contact stiffness × ... that gives the pressure
    const double target = o_.softness;
    if (o_.friction > 0)
      rubbing(target);
    else
      smooth(target);
    scale = o_.pressure / (grains_.virial.mean() / grains_.volume());
    Packing packing = result(scale);
    packing.warnings = shortcomings(packing);
    return packing;
  }

private:
  static constexpr double shapeShare = Dim == 2 ? 0.02 : 0; ///< while the network can still change its shape

  void report(double share)
  {
    reported_ = std::max(reported_, share); // attempts are repeated
    if (o_.progress)
      o_.progress(std::min(reported_, 1.0), stage_);
  }

  // States that are due. @param steps of the relaxation that runs
  void tell(std::int64_t steps)
  {
    if (steps_ + steps < next_)
      return;
    next_ = ((steps_ + steps) / o_.every + 1) * o_.every;
    Packing packing = result(o_.pressure / o_.softness);
    packing.steps += steps;
    o_.state({ packing, stage_ });
    if (o_.interrupted && o_.interrupted()) // who sees states may end it
      throw Cancelled();
  }

  RelaxationResult rest(BoxMotion box, double pressure, double tolerance, std::int64_t most)
  {
    relaxation_.box = box;
    relaxation_.pressure = pressure;
    relaxation_.tolerance = tolerance;
    relaxation_.maxSteps = most;
    const RelaxationResult r = relax(grains_, relaxation_);
    steps_ += r.steps;
    return r;
  }

  void start()
  {
    const auto n = static_cast<std::size_t>(o_.count);
    const Random random(o_.seed);
    grains_.resize(n);
    std::vector<double> d = diameters(o_);
    for (std::size_t i = n; i-- > 1;)
      std::swap(d[i],
        d[static_cast<std::size_t>(
          random.uniform(RandomUse::GrainOrder, static_cast<std::int64_t>(i)) * static_cast<double>(i + 1))]);
    for (std::size_t i = 0; i < n; ++i)
      grains_.radius[i] = 0.5 * d[i];
    grains_.friction = o_.friction;
    grains_.periodic.fill(o_.periodic);
    const double loose = Dim == 2 ? 0.70 : 0.50;
    const double fraction = o_.packingFraction ? std::min(loose, *o_.packingFraction) : loose;
    const double edge = std::pow(grains_.grainVolume() / fraction / o_.aspect, 1.0 / Dim);
    grains_.box.setConstant(edge);
    grains_.box[Dim - 1] = edge * o_.aspect;
    const double largest = 2 * *std::max_element(grains_.radius.begin(), grains_.radius.end());
    if (grains_.box.minCoeff() < (o_.periodic ? 3 : 2) * largest)
      throw ParameterError(
        fmt::format("the largest of {} grains is {:.2g} of the box across", o_.count, largest / grains_.box.minCoeff()),
        "more grains, a smaller ratio of their diameters, or an aspect nearer to 1");
    for (std::size_t i = 0; i < n; ++i)
      for (int a = 0; a < Dim; ++a)
        grains_.position[i][a] =
          random.uniform(RandomUse::GrainPlace, static_cast<std::int64_t>(i), a) * grains_.box[a];
  }

  // Much friction locks grains that overlap at their random places, far below any density at which they would jam:
  // they are let go without it, once.
  // @returns they were
  bool unlock()
  {
    if (o_.friction == 0 || unlocked_)
      return false;
    unlocked_ = true;
    const double negligible = std::exchange(relaxation_.negligible, 1e-12);
    grains_.rub(0);
    rest(BoxMotion::Fixed, 0, 1e-8, 100'000);
    grains_.rub(o_.friction);
    relaxation_.negligible = negligible;
    return true;
  }

  [[nodiscard]] double fraction() const { return grains_.grainVolume() / grains_.volume(); }
  [[nodiscard]] double pressure() const { return grains_.virial.mean() / grains_.volume(); }
  void compressTo(double fractionWanted)
  {
    grains_.strain(Vec::Constant(std::pow(fraction() / fractionWanted, 1.0 / Dim)));
  }

  // in small steps until the grains jam
  void compact()
  {
    relaxation_.negligible = 1e-4;
    const double first = fraction();
    for (double step = 0.01;;)
    {
      RelaxationResult r = rest(BoxMotion::Fixed, 0, 1e-2, 20'000);
      if (fraction() == first && pressure() > 1e-4 && unlock())
        r = rest(BoxMotion::Fixed, 0, 1e-2, 20'000);
      if (pressure() > (o_.friction > 0 ? 1e-4 : 1e-3) && r.atRest)
        return;
      if (fraction() > 0.98)
        throw DivergenceError("the grains did not jam", "try another seed");
      report(0.2 * (fraction() - 0.5) / 0.4);
      compressTo(fraction() + step);
    }
  }

  void loosely()
  {
    relaxation_.negligible = 1e-12;
    const double wanted = *o_.packingFraction;
    for (;;)
    {
      const RelaxationResult r = rest(BoxMotion::Fixed, 0, 1e-8, 100'000);
      if (grains_.forceSum > relaxation_.negligible * static_cast<double>(o_.count) && unlock())
        continue;
      if (grains_.forceSum > relaxation_.negligible * static_cast<double>(o_.count))
        throw ParameterError(
          fmt::format("the grains jam at a packing fraction of {:.3f}, before {:.3f}", fraction(), wanted),
          fmt::format("ask for less than {:.2f}, or leave it out for a jammed sample", fraction() - 0.01));
      (void)r;
      if (fraction() >= wanted * (1 - 1e-12))
        return;
      report((fraction() - 0.5) / (wanted - 0.5));
      compressTo(std::min(wanted, fraction() + 0.01));
    }
  }

  [[nodiscard]] double aspectError() const { return grains_.box[Dim - 1] / grains_.box[0] / o_.aspect - 1; }

  // Multiplies the aspect by 1 + change and keeps the volume.
  void shear(double change)
  {
    Vec stretch = Vec::Constant(std::pow(1 + change, -1.0 / Dim));
    stretch[Dim - 1] = std::pow(1 + change, 1 - 1.0 / Dim);
    grains_.strain(stretch);
  }

  // The shape as it should be at equal stresses: sheared beyond the target and released until that is so.
  void settle(double p, double allowed, int attempts)
  {
    stage_ = "settling";
    double amplitude = 0;
    double side = 0;
    System best = grains_;
    double least = std::numeric_limits<double>::infinity();
    for (int attempt = 0; attempt < attempts; ++attempt)
    {
      rest(BoxMotion::EachAxis, p, 1e-3, Dim == 2 ? 6'000 : 200'000);
      const double shape = std::abs(aspectError()) / allowed;
      if (shape < least)
      {
        least = shape;
        best = grains_;
      }
      if (shape <= 1)
        return;
      // Small shears are elastic and come back: they grow until the shape falls on the other side, then shrink.
      const double sideNow = aspectError() > 0 ? 1 : -1;
      amplitude = side * sideNow >= 0 ? std::max(2 * std::abs(aspectError()), 1.5 * amplitude) : 0.6 * amplitude;
      amplitude = std::clamp(amplitude, 0.003, 0.12);
      side = sideNow;
      shear((1 - side * amplitude) / (1 + aspectError()) - 1);
      rest(BoxMotion::Volume, p, 1e-2, Dim == 2 ? 4'000 : 200'000);
      report(0.2 + 0.02 * attempt);
    }
    grains_ = best;
    grains_.computeForces(0);
  }

  struct Limits
  {
    double fabric;
    double stress;
    double shape;
  };

  // 1 at most where all is within the limits.
  [[nodiscard]] double misfit(const PackingStatistics& s, const Limits& limits) const
  {
    return std::max({ s.fabricAnisotropy / limits.fabric, s.stressAnisotropy / limits.stress,
      std::abs(aspectError()) / limits.shape });
  }

  // Regions are turned (see Texture) until all is within the limits; what makes it worse is undone.
  // @param anew even if it is within them already: the first turn stays, whatever comes of it
  void evenOut(double p, const Limits& limits, int attempts, bool anew)
  {
    stage_ = "turning";
    Packing packing = result(1);
    PackingStatistics now = statistics(packing);
    double least = anew ? std::numeric_limits<double>::infinity() : misfit(now, limits);
    std::vector<std::size_t> tried;
    for (int attempt = 0; attempt < attempts && least > 1; ++attempt)
    {
      const System before = grains_;
      const Texture<Dim> texture(before, packing, now);
      tried.push_back(texture.regionToTurn(tried));
      texture.turn(grains_, tried.back());
      // a turned sample is soft: most of a shear stays
      shear(std::clamp(0.006 - 2 * aspectError(), -0.03, 0.03));
      rest(BoxMotion::Volume, p, 5e-2, Dim == 2 ? 1'000 : 200'000);
      rest(BoxMotion::EachAxis, p, 1e-3, Dim == 2 ? 2'000 : 200'000);
      Packing after = result(1);
      PackingStatistics then = statistics(after);
      if (const double score = misfit(then, limits); score < least)
      {
        least = score;
        packing = std::move(after);
        now = std::move(then);
        tried.clear();
      }
      else
        grains_ = before;
    }
    grains_.computeForces(0);
  }

  // Softly first, where stresses even out and shapes can be changed; then down to the pressure asked for. What comes of
  // it there is not quite what it was: where it is too much, other regions are turned, from before.
  void smooth(double target)
  {
    // Spheres have so many contacts that there is seldom anything to even out.
    constexpr Limits whenSoft = Dim == 2 ? Limits{ 0.015, 0.028, 0.012 } : Limits{ 0.025, 0.028, 0.012 };
    constexpr Limits whenFirm = Dim == 2 ? Limits{ 0.02, 0.028, 0.0095 } : Limits{ 0.028, 0.028, 0.0095 };
    const double soft = std::max(1e-2, target);
    settle(soft, 0.006, 14);
    evenOut(soft, whenSoft, 6, false);
    report(0.4);
    const double firm = std::max(1e-3, target);
    if (firm < soft)
      settle(firm, 0.008, 8);
    report(0.5);
    System best = grains_;
    double least = std::numeric_limits<double>::infinity();
    // few grains have few shapes to come to rest in, and are quick to try
    const int rounds = Dim == 2 ? std::clamp(2400 / static_cast<int>(grains_.count()), 6, 40) : 2;
    for (int round = 0; round < rounds && least > 1; ++round)
    {
      evenOut(firm, whenFirm, 10, round > 0);
      const System before = grains_;
      if (!harden(firm, target, round + 1 < rounds))
      {
        grains_ = before;
        grains_.computeForces(0);
        continue;
      }
      const double score = misfit(statistics(result(1)), { 0.03, 0.03, 0.01 });
      if (score < least)
      {
        least = score;
        best = grains_;
      }
      grains_ = before;
      grains_.computeForces(0);
    }
    grains_ = best;
    grains_.computeForces(0);
    if (std::isinf(least) || grains_.unbalanced() > o_.tolerance)
      throw DivergenceError(
        fmt::format(
          "the packing did not come to rest at a softness of {:g} with a tolerance of {:g}", target, o_.tolerance),
        "try another seed, a larger softness or a larger tolerance");
  }

  // What is stated, and was not reached.
  [[nodiscard]] std::vector<std::string> shortcomings(const Packing& p) const
  {
    std::vector<std::string> found;
    if (o_.packingFraction)
      return found;
    const PackingStatistics s = statistics(p, o_.friction > 0);
    if (2 * s.rattlers > o_.count)
      found.push_back(
        fmt::format("{} of {} grains carry nothing: a few are locked across the box; try another seed, less "
                    "friction or a larger softness",
          s.rattlers, o_.count));
    if (o_.friction > 0)
    {
      // the box keeps its shape, and friction what the way there left
      constexpr double much = 0.1;
      for (const auto& [what, value] :
        { std::pair{ "the stress is", s.stressAnisotropy }, { "the directions of contacts are", s.fabricAnisotropy } })
        if (value > much)
          found.push_back(fmt::format("{} {:.0f} % anisotropic: grains with friction keep what the way to their places "
                                      "left; try more grains, another seed or less friction",
            what, 100 * value));
      return found;
    }
    const auto say = [&](const std::string& what)
    {
      found.push_back(
        what + ": so few grains, or such a box, have no shape that is better; try another seed or more grains");
    };
    if (std::abs(s.aspect / o_.aspect - 1) > 0.02)
      say(fmt::format("the aspect is {:.3f} in place of {:g}", s.aspect, o_.aspect));
    if (s.fabricAnisotropy > 0.03)
      say(fmt::format("the directions of contacts are {:.1f} % anisotropic", 100 * s.fabricAnisotropy));
    if (s.stressAnisotropy > 0.03)
      say(fmt::format("the stress is {:.1f} % anisotropic", 100 * s.stressAnisotropy));
    return found;
  }

  // From one pressure to a lower one. Which contacts stay changes all the way: Newton's method is quick at that only if
  // they do not open and close at once. So the forces of disks are smoothed over a gap in proportion to the overlaps,
  // and the smoothing is taken away at the end.
  // @param choosy gives up where it can be seen early that another shape comes of it, or where it takes long
  // @returns it is at rest at the lower pressure
  bool harden(double firm, double target, bool choosy)
  {
    stage_ = "hardening";
    if constexpr (Dim == 2)
    {
      const auto smoothed = [&](double p, double gap)
      {
        relaxation_.smoothing = gap * gap;
        solve(p, 1e-2, 40);
        relaxation_.smoothing = 0;
      };
      for (double p = firm;; p = std::max(target, p / 3))
      {
        relaxation_.shapeShare = p > 1e-4 ? shapeShare : 0;
        smoothed(p, p);
        if (choosy && p < 1e-4 && std::abs(aspectError()) > 0.011)
        {
          relaxation_.shapeShare = shapeShare;
          return false;
        }
        report(0.6 + 0.4 * std::log(p / firm) / std::log(std::min(target / firm, 0.5)));
        if (p <= target)
          break;
      }
      for (double gap = 0.3 * target; gap > 0.01 * target; gap *= 0.3)
        smoothed(target, gap);
    }
    else
      for (double p = firm; p > target;)
      {
        p = std::max(target, p / 10);
        polish(p, false);
        if (choosy && p > 5e-5 && p > target && misfit(statistics(result(1)), { 0.0285, 0.028, 0.0099 }) > 1)
          return false;
        report(0.6 + 0.4 * std::log(p / firm) / std::log(target / firm));
      }
    relaxation_.shapeShare = 0; // at last all walls carry the same
    const bool done = polish(target, choosy);
    relaxation_.shapeShare = shapeShare;
    return done;
  }

  RelaxationResult solve(double p, double tolerance, std::int64_t most)
  {
    relaxation_.tolerance = tolerance;
    relaxation_.maxSteps = most;
    relaxation_.pressure = p;
    relaxation_.box = BoxMotion::EachAxis;
    const RelaxationResult r = newton(grains_, relaxation_);
    steps_ += r.steps;
    if (relaxation_.watch)
      relaxation_.watch(0); // its steps are few: told at its end, where forces are those of the law without smoothing
    return r;
  }

  // To rest at a pressure. Where the network gives way, so that Newton's method does not get there, damped dynamics
  // take it to the other side of that.
  // @param choosy gives up where it takes long
  // @returns it is at rest
  bool polish(double p, bool choosy)
  {
    const double goal = 1e-3 * o_.tolerance;
    // Overlaps are differences of places: 1e-15 of a place is as much of a force as 1e-15 over the overlap.
    const double good = std::max(0.01 * o_.tolerance, std::min(o_.tolerance, 1e-14 / p));
    std::int64_t most = Dim == 2 ? 1'000 : 50'000;
    const int attempts = Dim == 3 ? 8 : choosy ? 2 : 14;
    for (int attempt = 0; attempt < attempts; ++attempt)
    {
      if (Dim == 3 || attempt > 0)
      {
        rest(BoxMotion::EachAxis, p, attempt == 0 ? 1e-4 : 1e-5, most);
        if (Dim == 2)
          most = std::min<std::int64_t>(2 * most, 200'000);
      }
      if (solve(p, goal, Dim == 2 ? 60 : 30).atRest || grains_.unbalanced() <= good)
        return true;
    }
    return false;
  }

  void rubbing(double target)
  {
    stage_ = "squeezing";
    const double first = std::max(1e-4, target);
    for (double p = first;; p = std::max(target, p / 10))
    {
      const bool done = creep(p, p > target ? 10 * o_.tolerance : o_.tolerance);
      if (p <= target)
      {
        if (!done)
          throw DivergenceError(
            fmt::format("the packing did not come to rest: unbalanced force {:.1e} of the mean contact force",
              grains_.unbalanced()),
            "try another seed, less friction or a larger softness");
        return;
      }
      report(0.2 + 0.8 * std::log(p / 10 / first) / std::log(target / 10 / first));
    }
  }

  // To rest at a pressure, with contacts that slide. Some samples are held by so little that they give way again and
  // again for 1e6 steps: these are squeezed at higher pressures first, where they give way at once.
  // @returns it is at rest
  bool creep(double p, double tolerance)
  {
    constexpr int attempts = 20;
    for (int attempt = 0; attempt < attempts; ++attempt)
    {
      if (attempt > 0)
        for (double more = std::max(1e-4, 10 * p); more > 1.5 * p; more /= 10)
          rest(BoxMotion::Volume, more, 10 * o_.tolerance, 20'000);
      const bool last = attempt + 1 == attempts;
      if (rest(BoxMotion::Volume, p, tolerance, last ? 400'000 : attempt == 0 ? 35'000 : 12'000).atRest)
        return true;
    }
    return false;
  }

  [[nodiscard]] Packing result(double stress) const
  {
    const double d = o_.meanDiameter;
    const double unitForce = stress * std::pow(d, Dim - 1);
    Packing p;
    p.dimension = Dim;
    const auto wide = [](const Vec& v, double scale)
    {
      std::array<double, 3> w{ 0, 0, 0 };
      for (int a = 0; a < Dim; ++a)
        w[static_cast<std::size_t>(a)] = v[a] * scale;
      return w;
    };
    p.size = wide(grains_.box, d);
    for (int a = 0; a < Dim; ++a)
      p.periodic[static_cast<std::size_t>(a)] = grains_.periodic[static_cast<std::size_t>(a)];
    for (std::size_t i = 0; i < grains_.count(); ++i)
    {
      Vec x = grains_.position[i];
      for (int a = 0; a < Dim; ++a)
        if (o_.periodic)
          x[a] -= grains_.box[a] * std::floor(x[a] / grains_.box[a]);
      p.centre.push_back(wide(x, d));
      p.radius.push_back(grains_.radius[i] * d);
    }
    for (std::size_t index = 0; index < grains_.pairs().size(); ++index)
    {
      const auto& pair = grains_.pairs()[index];
      const Vec r = grains_.separation(index);
      const double distance = r.norm();
      const double overlap = grains_.radius[static_cast<std::size_t>(pair.first)] +
        grains_.radius[static_cast<std::size_t>(pair.second)] - distance;
      if (overlap <= 0)
        continue;
      const Vec n = r / distance;
      Vec f = overlap * n;
      if (o_.friction > 0)
        f -= tangentialStiffness * grains_.spring(index);
      p.contacts.push_back({ pair.first, pair.second, wide(r, d), wide(n, 1), wide(f, unitForce), overlap * d });
    }
    for (int wall = 0; wall < System::walls; ++wall)
      for (std::size_t i = 0; i < grains_.count(); ++i)
      {
        const double overlap = grains_.wallOverlap(i, wall);
        if (grains_.periodic[static_cast<std::size_t>(wall / 2)] || overlap <= 0)
          continue;
        const Vec n = System::wallNormal(wall);
        Vec f = overlap * n;
        if (o_.friction > 0)
          f -= tangentialStiffness * grains_.wallSpring(i, wall);
        p.contacts.push_back({ static_cast<std::int32_t>(i), -1 - wall, wide((grains_.radius[i] - overlap) * n, d),
          wide(n, 1), wide(f, unitForce), overlap * d });
      }
    p.pressure = stress * pressure();
    p.unbalanced = grains_.unbalanced();
    p.steps = steps_;
    return p;
  }

  const PackingOptions& o_;
  RelaxationOptions relaxation_;
  System grains_;
  std::int64_t steps_ = 0;
  std::int64_t next_ = 0; ///< steps at which a state is due
  const char* stage_ = "compressing";
  bool unlocked_ = false;
  double reported_ = 0;
};

} // namespace

Packing pack(const PackingOptions& options)
{
  check(options);
  return options.dimension == 2 ? Compaction<2>(options).run() : Compaction<3>(options).run();
}

} // namespace lamella::packing
