#include "lbm/stepping/Velocities.h"

namespace lamella::lbm
{

Velocities::Velocities(Stencil stencil)
{
  const int dimension = stencil == Stencil::D2Q5 || stencil == Stencil::D2Q9 ? 2 : 3;
  const bool diagonal = stencil == Stencil::D2Q9 || stencil == Stencil::D3Q19;
  const double straight = !diagonal ? 1.0 / 6 : dimension == 2 ? 1.0 / 9 : 1.0 / 18;
  rest = stencil == Stencil::D3Q7 ? 0 : 1;
  if (rest == 1)
  {
    c.push_back({});
    weight.push_back(stencil == Stencil::D2Q9 ? 4.0 / 9 : 1.0 / 3);
  }
  const auto pair = [&](int x, int y, int z, double w)
  {
    c.push_back({ x, y, z });
    c.push_back({ -x, -y, -z });
    weight.insert(weight.end(), 2, w);
  };
  pair(1, 0, 0, straight);
  pair(0, 1, 0, straight);
  if (dimension == 3)
    pair(0, 0, 1, straight);
  if (!diagonal)
    return;
  pair(1, 1, 0, 1.0 / 36);
  pair(-1, 1, 0, 1.0 / 36);
  if (dimension == 2)
    return;
  pair(1, 0, 1, 1.0 / 36);
  pair(-1, 0, 1, 1.0 / 36);
  pair(0, 1, 1, 1.0 / 36);
  pair(0, -1, 1, 1.0 / 36);
}

int Velocities::find(const Direction& d) const noexcept
{
  for (int q = 0; q < count(); ++q)
    if (c[q].x == d.x && c[q].y == d.y && c[q].z == d.z)
      return q;
  return -1;
}

} // namespace lamella::lbm
