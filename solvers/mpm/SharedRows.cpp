#include "mpm/SharedRows.h"

#include <algorithm>
#include <cstdint>

namespace lamella::mpm
{

template <int Dim>
template <class Node, class F>
void SharedRows<Dim>::forEachShared(
  const BackgroundGrid<Dim>& grid, std::span<double> nodes, int side, Lines lines, Node* buffer, F&& f) const
{
  const int rows = count(grid.axis(axis_), side);
  const std::int64_t first = side == 0 ? 0 : grid.nodes(axis_) - rows;
  const std::int64_t stride = grid.stride(axis_);
  forEachLine(grid, axis_, lines,
    [&](std::int64_t line)
    {
      const std::int64_t number = line / (stride * grid.nodes(axis_)) * stride + line % stride; // among all lines
      for (int r = 0; r < rows; ++r)
        f(nodes.data() + (line + (first + r) * stride) * nodeValues, buffer + (number * rows + r) * nodeValues);
    });
}

template <int Dim>
void SharedRows<Dim>::swap(const Sides& out, Sides& in) const
{
  const int size = comm_->size();
  const std::array<int, 2> neighbour{ (comm_->rank() + size - 1) % size, (comm_->rank() + 1) % size };
  constexpr std::array<int, 2> tag{ 81, 82 }; // upwards, downwards
  std::vector<MPI_Request> requests;
  for (std::size_t s = 0; s < 2; ++s)
  {
    in[s].resize(out[s].size());
    if (out[s].empty())
      continue;
    const auto values = static_cast<int>(out[s].size());
    MPI_Irecv(in[s].data(), values, MPI_DOUBLE, neighbour[s], tag[s], comm_->handle(), &requests.emplace_back());
    MPI_Isend(out[s].data(), values, MPI_DOUBLE, neighbour[s], tag[1 - s], comm_->handle(), &requests.emplace_back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

template <int Dim>
WallSums SharedRows<Dim>::add(const BackgroundGrid<Dim>& grid, std::span<double> nodes, std::size_t body)
{
  const GridAxis& g = grid.axis(axis_);
  const std::int64_t lines = grid.count() / grid.nodes(axis_);
  if (in_.size() <= body)
    in_.resize(body + 1);
  for (int side = 0; side < 2; ++side)
  {
    const auto s = static_cast<std::size_t>(side);
    out_[s].resize(g.isCut(side) ? static_cast<std::size_t>(lines * count(g, side) * nodeValues) : 0);
    if (g.isCut(side))
      forEachShared(grid, nodes, side, Lines::All, out_[s].data(),
        [](const double* node, double* kept) { std::copy_n(node, nodeValues, kept); });
  }
  Sides& in = in_[body];
  swap(out_, in);

  WallSums sums;
  if (seam(g, 0))
    forEachShared(grid, nodes, 0, Lines::Own, in[0].data(),
      [&](const double* near, const double* far)
      {
        const double mass = near[0] + far[0];
        if (mass > leastMass)
        {
          sums.mass += near[0] * far[0] / mass;
          sums.momentum += (near[0] * far[1 + axis_] - far[0] * near[1 + axis_]) / mass;
        }
      });
  for (int side = 0; side < 2; ++side)
    if (g.isCut(side))
      forEachShared(grid, nodes, side, Lines::All, in[static_cast<std::size_t>(side)].data(),
        [](double* node, const double* other)
        {
          for (int i = 0; i < nodeValues; ++i)
            node[i] += other[i];
        });
  return sums;
}

template <int Dim>
void SharedRows<Dim>::shift(
  const BackgroundGrid<Dim>& grid, std::span<double> nodes, double velocity, std::size_t body) const
{
  for (int side = 0; side < 2; ++side)
    if (seam(grid.axis(axis_), side))
      forEachShared(
        grid, nodes, side, Lines::All, in_[body][static_cast<std::size_t>(side)].data(),
        [&](double* node, const double* other) { node[1 + axis_] += (side == 0 ? -velocity : velocity) * other[0]; });
}

template <int Dim>
void SharedRows<Dim>::sum(std::array<std::array<WallSums, 2>, Dim>& sums) const
{
  std::array<double, 4 * Dim> values{};
  std::size_t i = 0;
  for (const auto& ends : sums)
    for (const WallSums& s : ends)
    {
      values[i++] = s.mass;
      values[i++] = s.momentum;
    }
  comm_->sum(values);
  i = 0;
  for (auto& ends : sums)
    for (WallSums& s : ends)
    {
      s.mass = values[i++];
      s.momentum = values[i++];
    }
}

template class SharedRows<2>;
template class SharedRows<3>;

} // namespace lamella::mpm
