#include "lbm/BoxField.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lamella::lbm
{
namespace
{

constexpr std::int64_t energyLanes = 4;

} // namespace

BoxField::BoxField(const Problem& problem)
  : problem_(problem)
  , block_(problem.parts.block())
  , links_(problem.links())
  , halo_(problem.lattice.dimension, block_.size, problem.parts, problem.comm, problem.periodic())
  , phases_(block_, halo_, problem.phase, problem.lattice.dimension)
  , stride_(block_.size[0] + 2)
  , u_(static_cast<std::size_t>(halo_.rows() * stride_), 0.0)
{
}

void BoxField::setLinearProfile()
{
  for (std::int64_t z = 0; z < block_.size[2]; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
      setLinearProfile(y, z);
}

void BoxField::setLinearProfile(std::int64_t y, std::int64_t z)
{
  const int axis = problem_.axis;
  const double n = static_cast<double>(problem_.lattice.size[axis]);
  const auto at = [&](std::int64_t p)
  { return problem_.options.sides == Sides::Periodic ? 0.0 : 1.0 - (static_cast<double>(p) + 0.5) / n; };
  double* u = rowValues(y, z);
  if (axis != 0)
    std::fill_n(u, block_.size[0], at(axis == 1 ? y + block_.start[1] : z + block_.start[2]));
  else
    for (std::int64_t x = 0; x < block_.size[0]; ++x)
      u[x] = at(x);
}

void BoxField::fillGhosts()
{
  if (problem_.periodic()[0])
    for (std::int64_t z = 0; z < block_.size[2]; ++z)
      for (std::int64_t y = 0; y < block_.size[1]; ++y)
      {
        double* u = rowValues(y, z);
        u[-1] = u[block_.size[0] - 1];
        u[block_.size[0]] = u[0];
      }
  halo_.exchange(u_.data(), static_cast<std::size_t>(stride_) * sizeof(double));
}

// f(x, conductance, value here less value there) for every link of a row in one direction.
template <class F>
void BoxField::rowLinks(std::int64_t y, std::int64_t z, const Direction& d, F&& f) const
{
  rowLinks(
    y, z, d, f,
    [&](std::int64_t first, std::int64_t last, double w, double jump, const double* u, const double* v,
      const std::uint8_t* a, const std::uint8_t* b)
    {
      for (std::int64_t x = first; x < last; ++x)
        f(x, w * links_.mean(a[x], b[x], d.axis()), u[x] - v[x] + jump);
    });
}

// The same, but for the links between the ends of rows, that have one weight w and follow each other:
// run(first, last, w, jump, values here, values there, ids here, ids there), where values fall by `jump` more.
template <class F, class Run>
void BoxField::rowLinks(std::int64_t y, std::int64_t z, const Direction& d, F&& f, Run&& run) const
{
  const std::int64_t nx = block_.size[0];
  const std::array<std::int64_t, 3> p{ nx / 2, y + block_.start[1], z + block_.start[2] };
  const double jump = problem_.options.sides == Sides::Periodic
    ? d[problem_.axis] / static_cast<double>(problem_.lattice.size[problem_.axis])
    : 0.0;
  const double* u = u_.data() + halo_.row(y, z) * stride_ + 1;
  const auto at = [&](std::int64_t x, double weight)
  {
    std::int64_t other = x + d.x;
    other = other < 0 ? other + nx : other >= nx ? other - nx : other;
    const double* v = u_.data() + halo_.row(y + d.y, z + d.z) * stride_ + 1;
    f(x, weight * links_.mean(rowPhase(y, z)[x], rowPhase(y + d.y, z + d.z)[other], d.axis()),
      u[x] - v[x + d.x] + jump);
  };
  if (const double* given = links_.given(d, p[1]); given != nullptr)
  {
    const bool periodic = problem_.options.sides == Sides::Periodic;
    if (!periodic && (p[1] + d.y < 0 || p[1] + d.y >= problem_.lattice.size[1]))
      return;
    const double* v = u_.data() + halo_.row(y + d.y, z) * stride_ + 1 + d.x;
    for (std::int64_t x = d.x < 0 && !periodic ? 1 : 0; x < (d.x > 0 && !periodic ? nx - 1 : nx); ++x)
      f(x, given[x], u[x] - v[x] + jump);
    return;
  }
  // the two ends, where sides wrap or reflect, then the rest with one weight
  if (nx < 3)
  {
    for (std::int64_t x = 0; x < nx; ++x)
      if (const double w = links_.weight(d, { x, p[1], p[2] }); w != 0.0)
        at(x, w);
    return;
  }
  if (const double w = links_.weight(d, { 0, p[1], p[2] }); w != 0.0)
    at(0, w);
  if (const double w = links_.weight(d, { nx - 1, p[1], p[2] }); w != 0.0)
    at(nx - 1, w);
  const double w = links_.weight(d, { 1, p[1], p[2] });
  if (w == 0.0)
    return;
  const double* v = u_.data() + halo_.row(y + d.y, z + d.z) * stride_ + 1 + d.x;
  const std::uint8_t* a = rowPhase(y, z);
  const std::uint8_t* b = rowPhase(y + d.y, z + d.z) + d.x;
  run(1, nx - 1, w, jump, u, v, a, b);
}

std::size_t BoxField::planeCount() const noexcept
{
  const std::int64_t n = problem_.lattice.size[static_cast<std::size_t>(problem_.axis)];
  return static_cast<std::size_t>(problem_.options.sides == Sides::Periodic ? n : n + 1);
}

void BoxField::addToPlanes(std::int64_t y, std::int64_t z, PlaneSums& planes) const
{
  const int axis = problem_.axis;
  const std::int64_t n = problem_.lattice.size[static_cast<std::size_t>(axis)];
  const bool periodic = problem_.options.sides == Sides::Periodic;
  const std::int64_t row = axis == 1 ? y + block_.start[1] : z + block_.start[2];
  for (const Direction& d : links_.forward())
  {
    if (d[axis] == 0)
      continue;
    const double sign = d[axis];
    const auto add = [&](std::size_t plane, double g, double q)
    {
      planes.conductance[plane] += g;
      planes.flux[plane] += sign * q;
    };
    std::array<double, 2> all{ 0, 0 }; // conductance and flux of a whole row, when it crosses one plane
    const std::int64_t above = d[axis] > 0 ? 1 : 0;
    if (axis == 0)
      rowLinks(y, z, d,
        [&](std::int64_t x, double g, double du)
        {
          const std::int64_t plane = x + above;
          add(static_cast<std::size_t>(periodic && plane == n ? 0 : plane), g, g * du);
        });
    else
    {
      rowLinks(y, z, d,
        [&](std::int64_t, double g, double du)
        {
          all[0] += g;
          all[1] += g * du;
        });
      const std::int64_t plane = row + above;
      add(static_cast<std::size_t>(periodic && plane == n ? 0 : plane), all[0], all[1]);
    }
  }
  if (periodic)
    return;
  const double* u = u_.data() + halo_.row(y, z) * stride_ + 1;
  const std::uint8_t* phase = rowPhase(y, z);
  const auto wall = [&](std::int64_t x, double fall, std::int64_t plane)
  {
    const double g = links_.wall(phase[x], { x, y + block_.start[1], z + block_.start[2] }, axis, plane == n);
    planes.conductance[static_cast<std::size_t>(plane)] += g;
    planes.flux[static_cast<std::size_t>(plane)] += g * fall;
  };
  for (const bool high : { false, true })
  {
    if (axis == 0)
    {
      const std::int64_t x = high ? n - 1 : 0;
      wall(x, high ? u[x] : 1.0 - u[x], high ? n : 0);
    }
    else if (row == (high ? n - 1 : 0))
      for (std::int64_t x = 0; x < block_.size[0]; ++x)
        wall(x, high ? u[x] : 1.0 - u[x], high ? n : 0);
  }
}

void BoxField::apply(const PlaneBalance& balance)
{
  const int axis = problem_.axis;
  for (std::int64_t z = 0; z < block_.size[2]; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
    {
      double* u = rowValues(y, z);
      const double* shift = balance.shift.data();
      if (axis != 0)
        shift += axis == 1 ? y + block_.start[1] : z + block_.start[2];
      for (std::int64_t x = 0; x < block_.size[0]; ++x)
        u[x] = balance.factor * u[x] + shift[axis == 0 ? x : 0];
    }
}

FieldSums BoxField::evaluate(const RowSink& sink, PlaneSums* planes)
{
  fillGhosts();
  const int axis = problem_.axis;
  const std::int64_t n = problem_.lattice.size[axis];
  const std::int64_t nx = block_.size[0];
  const bool periodic = problem_.options.sides == Sides::Periodic;
  FieldSums s;
  std::vector<double> r(static_cast<std::size_t>(nx));
  for (std::int64_t z = 0; z < block_.size[2]; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
    {
      std::fill(r.begin(), r.end(), 0.0);
      double* out = r.data();
      const std::int64_t rowPosition = axis == 1 ? y + block_.start[1] : z + block_.start[2];
      for (const Direction& d : links_.all())
      {
        const bool forward = d.z > 0 || (d.z == 0 && (d.y > 0 || (d.y == 0 && d.x > 0)));
        if (!forward)
        {
          rowLinks(y, z, d, [out](std::int64_t x, double g, double du) { out[x] -= g * du; });
          continue;
        }
        double energy = 0;
        double flux = 0;
        rowLinks(y, z, d,
          [&](std::int64_t x, double g, double du)
          {
            const double q = g * du;
            out[x] -= q;
            energy += q * du;
            flux += q;
          });
        s.energy += energy;
        for (int a = 0; a < 3; ++a)
          s.flux[a] += flux * d[a];
      }
      if (periodic)
        for (const Direction& d : links_.all())
          if (d[axis] > 0 && (axis == 0 || rowPosition == n - 1 || rowPosition == std::max<std::int64_t>(n / 2 - 1, 0)))
            rowLinks(y, z, d,
              [&](std::int64_t x, double g, double du)
              {
                const std::int64_t p = axis == 0 ? x : rowPosition;
                if (p == n - 1)
                  s.inlet += g * du;
                if (p == std::max<std::int64_t>(n / 2 - 1, 0))
                  s.outlet += g * du;
              });
      if (!periodic)
      {
        const double* u = rowValues(y, z);
        const std::uint8_t* phase = rowPhase(y, z);
        const auto wall = [&](std::int64_t x, double wallValue, double& face, double sign)
        {
          const double du = u[x] - wallValue;
          const double q =
            links_.wall(phase[x], { x, y + block_.start[1], z + block_.start[2] }, axis, wallValue == 0.0) * du;
          out[x] -= q;
          s.energy += q * du;
          face += sign * q;
          s.flux[axis] += 0.5 * sign * q;
        };
        if (axis == 0)
        {
          wall(0, 1.0, s.inlet, -1.0);
          wall(nx - 1, 0.0, s.outlet, 1.0);
        }
        else
        {
          if (rowPosition == 0)
            for (std::int64_t x = 0; x < nx; ++x)
              wall(x, 1.0, s.inlet, -1.0);
          if (rowPosition == n - 1)
            for (std::int64_t x = 0; x < nx; ++x)
              wall(x, 0.0, s.outlet, 1.0);
        }
      }
      double r2 = 0;
      for (std::int64_t x = 0; x < nx; ++x)
        r2 += out[x] * out[x];
      s.residual2 += r2;
      sink(y, z, out);
      if (planes != nullptr)
        addToPlanes(y, z, *planes);
    }
  if (planes != nullptr)
  {
    problem_.comm.sum(planes->conductance);
    problem_.comm.sum(planes->flux);
  }
  std::array<double, 7> all{ s.energy, s.inlet, s.outlet, s.flux[0], s.flux[1], s.flux[2], s.residual2 };
  problem_.comm.sum(all);
  return { all[0], all[1], all[2], { all[3], all[4], all[5] }, all[6] };
}

double BoxField::mean() const
{
  if (problem_.options.sides != Sides::Periodic)
    return 0;
  double sum = 0;
  for (std::int64_t z = 0; z < block_.size[2]; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
    {
      const double* u = u_.data() + halo_.row(y, z) * stride_ + 1;
      for (std::int64_t x = 0; x < block_.size[0]; ++x)
        sum += u[x];
    }
  return problem_.comm.sum(sum) / static_cast<double>(problem_.lattice.count());
}

void BoxField::value(std::span<double> out, Layers layers, double mean) const
{
  const bool periodic = problem_.options.sides == Sides::Periodic;
  const int axis = problem_.axis;
  const double n = static_cast<double>(problem_.lattice.size[axis]);
  std::size_t i = 0;
  for (std::int64_t z = layers.first; z < layers.last; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
    {
      const double* u = u_.data() + halo_.row(y, z) * stride_ + 1;
      for (std::int64_t x = 0; x < block_.size[0]; ++x, ++i)
      {
        const std::int64_t p = axis == 0 ? x : axis == 1 ? y + block_.start[1] : z + block_.start[2];
        out[i] = periodic ? u[x] - mean + 1.0 - (static_cast<double>(p) + 0.5) / n : u[x];
      }
    }
}

void BoxField::setValue(std::span<const double> value)
{
  const bool periodic = problem_.options.sides == Sides::Periodic;
  const int axis = problem_.axis;
  const double n = static_cast<double>(problem_.lattice.size[axis]);
  auto from = value.begin();
  for (std::int64_t z = 0; z < block_.size[2]; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
    {
      double* const u = rowValues(y, z);
      for (std::int64_t x = 0; x < block_.size[0]; ++x, ++from)
      {
        const std::int64_t p = axis == 0 ? x : axis == 1 ? y + block_.start[1] : z + block_.start[2];
        u[x] = periodic ? *from - 1.0 + (static_cast<double>(p) + 0.5) / n : *from;
      }
    }
}

std::vector<double> BoxField::linkEnergies() const
{
  const std::size_t ids = problem_.diffusivity.size();
  const int axis = problem_.axis;
  const std::int64_t n = problem_.lattice.size[axis];
  const std::int64_t nx = block_.size[0];
  const std::int64_t rows = block_.size[1] * block_.size[2];
  const std::int64_t parts = std::clamp<std::int64_t>(rows, 1, sumParts);
  const std::size_t pairs = links_.tables() * ids * ids;
  std::vector<double> sums(static_cast<std::size_t>(parts) * pairs, 0.0);
  const int threads = problem_.options.threads;
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t part = 0; part < parts; ++part)
  {
    double* const sum = sums.data() + static_cast<std::size_t>(part) * pairs;
    std::vector<double> lanes(pairs * energyLanes, 0.0); // additions to one place wait for each other
    for (std::int64_t row = part * rows / parts; row < (part + 1) * rows / parts; ++row)
    {
      const std::int64_t y = row % block_.size[1];
      const std::int64_t z = row / block_.size[1];
      const std::uint8_t* const here = rowPhase(y, z);
      for (const Direction& d : links_.forward())
      {
        const std::uint8_t* const there = rowPhase(y + d.y, z + d.z);
        const std::size_t table = links_.table(d.axis()) * ids * ids;
        const auto add = [&](std::int64_t x, std::uint8_t a, std::uint8_t b, double energy)
        { lanes[static_cast<std::size_t>(x % energyLanes) * pairs + table + ids * a + b] += energy; };
        rowLinks(
          y, z, d,
          [&](std::int64_t x, double g, double du)
          {
            if (!(g > 0) || std::isnan(du))
              return;
            const std::int64_t other = x + d.x < 0 ? x + d.x + nx : x + d.x >= nx ? x + d.x - nx : x + d.x;
            add(x, here[x], there[other], g * du * du);
          },
          [&](std::int64_t first, std::int64_t last, double w, double jump, const double* u, const double* v,
            const std::uint8_t* a, const std::uint8_t* b)
          {
            std::int64_t x = first;
            for (; x + 4 <= last; x += 4) // four at a time, most of which have the same ids at their ends
            {
              std::array<double, 4> squares{};
              for (int i = 0; i < 4; ++i)
              {
                const double du = u[x + i] - v[x + i] + jump;
                squares[static_cast<std::size_t>(i)] = w * du * du;
              }
              const double four = (squares[0] + squares[1]) + (squares[2] + squares[3]);
              std::array<std::uint32_t, 2> words{};
              std::memcpy(&words[0], a + x, 4);
              std::memcpy(&words[1], b + x, 4);
              if (words[0] == 0x01010101U * a[x] && words[1] == 0x01010101U * b[x] && !std::isnan(four))
                add(x / 4, a[x], b[x], links_.mean(a[x], b[x], d.axis()) * four);
              else
                for (int i = 0; i < 4; ++i)
                  if (const double square = squares[static_cast<std::size_t>(i)]; !std::isnan(square))
                    add(x + i, a[x + i], b[x + i], links_.mean(a[x + i], b[x + i], d.axis()) * square);
            }
            for (; x < last; ++x)
              if (const double du = u[x] - v[x] + jump; !std::isnan(du))
                add(x, a[x], b[x], w * links_.mean(a[x], b[x], d.axis()) * du * du);
          });
      }
      if (problem_.options.sides == Sides::Periodic)
        continue;
      const double* const u = u_.data() + halo_.row(y, z) * stride_ + 1;
      const std::int64_t rowPosition = axis == 1 ? y + block_.start[1] : z + block_.start[2];
      const auto wall = [&](std::int64_t x, double wallValue)
      {
        const double du = u[x] - wallValue;
        if (!std::isnan(du))
          sum[links_.table(axis) * ids * ids + (ids + 1) * here[x]] +=
            links_.wall(here[x], { x, y + block_.start[1], z + block_.start[2] }, axis, wallValue == 0.0) * du * du;
      };
      if (axis == 0)
      {
        wall(0, 1.0);
        wall(nx - 1, 0.0);
      }
      for (std::int64_t x = 0; x < nx && axis != 0; ++x)
      {
        if (rowPosition == 0)
          wall(x, 1.0);
        if (rowPosition == n - 1)
          wall(x, 0.0);
      }
    }
    for (std::size_t i = 0; i < lanes.size(); ++i)
      sum[i % pairs] += lanes[i];
  }
  std::vector<double> all(pairs, 0.0);
  for (std::size_t i = 0; i < sums.size(); ++i)
  {
    const std::size_t a = i % (ids * ids) / ids;
    const std::size_t b = i % ids;
    all[i % pairs / (ids * ids) * ids * ids + std::min(a, b) * ids + std::max(a, b)] += sums[i];
  }
  problem_.comm.sum(all);
  return all;
}

FieldEnergies energiesOf(const Problem& problem, const Backend& backend)
{
  BoxField field(problem);
  std::vector<double> value(problem.phase.size());
  backend.value(value, { 0, problem.parts.block().size[2] });
  field.setValue(value);
  value = {};
  field.fillGhosts();
  return { field.linkEnergies(), {}, {} };
}

void BoxField::flux(std::span<double> out, Layers layers) const
{
  std::fill(out.begin(), out.end(), 0.0);
  const int axis = problem_.axis;
  const std::array<double, 3> unit = fluxUnits(links_, problem_.lattice);
  for (std::int64_t z = layers.first; z < layers.last; ++z)
    for (std::int64_t y = 0; y < block_.size[1]; ++y)
    {
      double* row = out.data() + 3 * block_.size[0] * (y + block_.size[1] * (z - layers.first));
      for (const Direction& d : links_.all())
        rowLinks(y, z, d,
          [&](std::int64_t x, double g, double du)
          {
            for (int a = 0; a < 3; ++a)
              row[3 * x + a] += 0.5 * unit[static_cast<std::size_t>(a)] * g * du * d[a];
          });
      if (problem_.options.sides == Sides::Periodic)
        continue;
      const double* u = u_.data() + halo_.row(y, z) * stride_ + 1;
      const std::uint8_t* phase = rowPhase(y, z);
      const double half = 0.5 * unit[static_cast<std::size_t>(axis)];
      for (std::int64_t x = 0; x < block_.size[0]; ++x)
      {
        const std::int64_t p = axis == 0 ? x : axis == 1 ? y + block_.start[1] : z + block_.start[2];
        const std::array<std::int64_t, 3> node{ x, y + block_.start[1], z + block_.start[2] };
        if (p == 0)
          row[3 * x + axis] += half * links_.wall(phase[x], node, axis, false) * (1.0 - u[x]);
        if (p == problem_.lattice.size[axis] - 1)
          row[3 * x + axis] += half * links_.wall(phase[x], node, axis, true) * u[x];
      }
    }
}

} // namespace lamella::lbm
