#pragma once

#include "mpm/PointStiffness.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace lamella::mpm::samples
{

/// Points in a box, evenly spread, `per` a cell and direction; the phase by the place, 0: none.
template <int Dim>
struct Body
{
  std::array<double, Dim> length{};
  std::array<int, Dim> cells{};
  MaterialPoints<Dim> points;

  Body(const std::array<double, Dim>& size, const std::array<int, Dim>& n, int per,
    const std::function<int(const std::array<double, Dim>&)>& phase, const Vector<Dim>& axis = along())
    : length(size)
    , cells(n)
  {
    std::vector<std::array<double, Dim>> places;
    std::vector<int> phases;
    std::array<int, Dim> i{};
    while (i[Dim - 1] < n[Dim - 1] * per)
    {
      std::array<double, Dim> x;
      for (std::size_t a = 0; a < Dim; ++a)
        x[a] = size[a] * (i[a] + 0.5) / (n[a] * per);
      if (const int p = phase(x); p != 0)
      {
        places.push_back(x);
        phases.push_back(p);
      }
      for (std::size_t a = 0; a < Dim; ++a)
        if (++i[a] < n[a] * per || a + 1 == Dim)
          break;
        else
          i[a] = 0;
    }
    points = MaterialPoints<Dim>(places.size());
    double volume = 1;
    for (std::size_t a = 0; a < Dim; ++a)
      volume *= size[a] / (n[a] * per);
    for (std::size_t p = 0; p < places.size(); ++p)
    {
      for (int a = 0; a < Dim; ++a)
        points.column(MaterialPoints<Dim>::positions + a)[p] = places[p][static_cast<std::size_t>(a)];
      points.column(MaterialPoints<Dim>::volumes)[p] = volume;
      points.setVector(MaterialPoints<Dim>::axes, p, axis);
      points.phase()[p] = static_cast<std::uint8_t>(phases[p]);
    }
  }
  static Vector<Dim> along()
  {
    Vector<Dim> v{};
    v[0] = 1;
    return v;
  }

  [[nodiscard]] PointStiffnessOptions<Dim> options(const std::array<BoxSides, Dim>& sides) const
  {
    PointStiffnessOptions<Dim> o;
    o.upper = length;
    o.spacing = length[0] / cells[0];
    o.sides = sides;
    return o;
  }
  [[nodiscard]] PointStiffness<Dim> solve(const PointLaw<Dim>& law, const std::array<BoxSides, Dim>& sides) const
  {
    return pointStiffness(points, law, options(sides));
  }
};

} // namespace lamella::mpm::samples
