// A plate of stiff disks with holes, for tests and benchmarks.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace lamella::breakable
{

/// Phases of a plate: a quarter of stiff disks (2) in a matrix (1), then holes (0), then platens of matrix.
struct DiskPlate
{
  std::int64_t nx = 64;
  std::int64_t ny = 96;
  double porosity = 0.2;    ///< of the plate without platens, more or less
  bool singleNodes = false; ///< for holes, instead of disks
  std::int64_t platen = 3;  ///< layers
};

/// The same plate of the same numbers everywhere.
inline std::vector<std::uint8_t> phasesOf(const DiskPlate& t)
{
  std::vector<std::uint8_t> phase(static_cast<std::size_t>(t.nx * t.ny), 1);
  std::mt19937 random(7);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  const auto disks = [&](double share, std::uint8_t kind)
  {
    const double target = share * static_cast<double>(t.nx * t.ny);
    double filled = 0;
    while (filled < target)
    {
      const double x = uniform() * static_cast<double>(t.nx);
      const double y = uniform() * static_cast<double>(t.ny);
      const double r = 3 + 4 * uniform();
      for (std::int64_t j = 0; j < t.ny; ++j)
        for (std::int64_t i = 0; i < t.nx; ++i)
          if (auto& p = phase[static_cast<std::size_t>(i + t.nx * j)];
              p == 1 && std::hypot(static_cast<double>(i) - x, static_cast<double>(j) - y) < r)
          {
            p = kind;
            filled += 1;
          }
    }
  };
  disks(0.25, 2);
  if (t.singleNodes)
    for (auto& p : phase)
      p = uniform() < t.porosity ? 0 : p;
  else
    disks(t.porosity, 0);
  for (std::int64_t y = 0; y < t.ny; ++y)
    if (y < t.platen || y >= t.ny - t.platen)
      for (std::int64_t x = 0; x < t.nx; ++x)
        phase[static_cast<std::size_t>(x + t.nx * y)] = 1;
  return phase;
}

} // namespace lamella::breakable
