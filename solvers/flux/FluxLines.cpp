#include "flux/FluxLines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lamella::flux
{
namespace
{

/// Where a line is: inside the cell of `node`, `inside` from 0 (low face) to 1 (high face) along each axis.
struct State
{
  std::int64_t line = 0;
  Node node{ 0, 0, 0 };
  std::array<double, 3> inside{ 0.5, 0.5, 0.5 };
  double length = 0;
  std::int64_t steps = 0;
};
static_assert(sizeof(State) == 9 * 8);

enum class End
{
  Arrived, ///< through the outlet
  Left,    ///< through the inlet, or stuck where nothing flows on
  Passed   ///< into another block, or round a periodic side
};

bool holds(const lbm::Block& block, const Node& node)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (node[axis] < block.start[axis] || node[axis] >= block.start[axis] + block.size[axis])
      return false;
  return true;
}

/// Time to the face that the line moves towards along one axis; infinite when it never gets there.
double timeToFace(double low, double high, double inside)
{
  const double speed = low + (high - low) * inside;
  const double change = high - low;
  const double target = speed > 0 ? high : low;
  const double way = speed > 0 ? 1 - inside : -inside;
  if (speed == 0 || target * speed <= 0)
    return std::numeric_limits<double>::infinity();
  const double ratio = change * way / speed; // log(target / speed) / change, near 1 without loss
  return std::abs(ratio) < 1e-8 ? way / speed : std::log1p(ratio) / change;
}

double placeAfter(double low, double high, double inside, double time)
{
  const double speed = low + (high - low) * inside;
  const double growth = (high - low) * time;
  const double way = std::abs(growth) < 1e-8 ? speed * time : speed * time * (std::expm1(growth) / growth);
  return std::clamp(inside + way, 0.0, 1.0);
}

class Tracer
{
public:
  Tracer(const FluxField& field, const FluxSetting& setting, const lbm::Block& block)
    : field_(field)
    , setting_(setting)
    , block_(block)
    , outward_(setting.rising ? -1 : 1)
    , most_(1000 + 50 * (setting.lattice.size[0] + setting.lattice.size[1] + setting.lattice.size[2]))
  {
  }

  /// Follows a line through this rank's block; `state` is where it goes on.
  End follow(State& state, LinePiece& piece) const
  {
    piece.line = state.line;
    const int dimension = setting_.lattice.dimension;
    int entered = setting_.axis;
    bool first = true;
    while (true)
    {
      std::array<double, 3> low{ 0, 0, 0 };
      std::array<double, 3> high{ 0, 0, 0 };
      double time = std::numeric_limits<double>::infinity();
      int exit = -1;
      for (int axis = 0; axis < dimension; ++axis)
      {
        const auto a = static_cast<std::size_t>(axis);
        low[a] = field_.face(state.node, axis);
        high[a] = field_.face(above(state.node, axis), axis);
        const double t = timeToFace(low[a], high[a], state.inside[a]);
        if (t < time)
        {
          time = t;
          exit = axis;
        }
      }
      if (first)
      {
        entered = entryAxis(state);
        addPoint(piece, state, low, high, entered);
        first = false;
      }
      if (exit < 0 || state.steps >= most_)
        return End::Left;
      std::array<double, 3> place = state.inside;
      double squared = 0;
      bool up = false;
      for (int axis = 0; axis < dimension; ++axis)
      {
        const auto a = static_cast<std::size_t>(axis);
        if (axis == exit)
        {
          up = low[a] + (high[a] - low[a]) * state.inside[a] > 0;
          place[a] = up ? 1.0 : 0.0;
        }
        else
        {
          place[a] = placeAfter(low[a], high[a], state.inside[a], time);
        }
        squared += (place[a] - state.inside[a]) * (place[a] - state.inside[a]);
      }
      state.inside = place;
      state.length += std::sqrt(squared);
      ++state.steps;
      addPoint(piece, state, low, high, exit);

      const auto e = static_cast<std::size_t>(exit);
      state.node[e] += up ? 1 : -1;
      state.inside[e] = up ? 0.0 : 1.0;
      const std::int64_t size = setting_.lattice.size[e];
      if (state.node[e] < 0 || state.node[e] >= size)
      {
        if (exit == setting_.axis)
          return (up ? 1 : -1) == outward_ ? End::Arrived : End::Left;
        if (!setting_.periodic)
          return End::Left; // no flux leads here
        state.node[e] += up ? -size : size;
        return End::Passed;
      }
      if (!holds(block_, state.node))
        return End::Passed;
    }
  }

private:
  static Node above(Node node, int axis)
  {
    ++node[static_cast<std::size_t>(axis)];
    return node;
  }

  int entryAxis(const State& state) const
  {
    for (int axis = 0; axis < setting_.lattice.dimension; ++axis)
    {
      const double place = state.inside[static_cast<std::size_t>(axis)];
      if (place == 0.0 || place == 1.0)
        return axis;
    }
    return setting_.axis;
  }

  void addPoint(LinePiece& piece, const State& state, const std::array<double, 3>& low,
    const std::array<double, 3>& high, int axis) const
  {
    std::array<double, 3> point{ 0, 0, 0 };
    double squared = 0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(setting_.lattice.dimension); ++a)
    {
      point[a] = static_cast<double>(state.node[a]) + state.inside[a] - 0.5;
      const double flux = low[a] + (high[a] - low[a]) * state.inside[a];
      squared += flux * flux;
    }
    piece.points.push_back(point);
    piece.flux.push_back(std::sqrt(squared));
    const bool onHigh = state.inside[static_cast<std::size_t>(axis)] == 1.0;
    piece.value.push_back(field_.valueAt(onHigh ? above(state.node, axis) : state.node, axis));
    piece.length.push_back(state.length);
  }

  const FluxField& field_;
  const FluxSetting& setting_;
  const lbm::Block& block_;
  int outward_;
  std::int64_t most_; ///< steps of a line; only closed loops need more
};

/// Every rank's block.
std::vector<lbm::Block> allBlocks(const lbm::Block& mine, const Communicator& ranks)
{
  std::vector<lbm::Block> blocks(static_cast<std::size_t>(ranks.size()), mine);
  if (ranks.size() > 1)
    MPI_Allgather(&mine, 6, MPI_INT64_T, blocks.data(), 6, MPI_INT64_T, ranks.handle());
  return blocks;
}

/// Collective: hands every state to the rank whose block holds its node.
std::vector<State> handOver(
  const std::vector<State>& states, const std::vector<lbm::Block>& blocks, const Communicator& ranks)
{
  if (ranks.size() == 1)
    return states;
  const auto count = static_cast<std::size_t>(ranks.size());
  constexpr int words = static_cast<int>(sizeof(State) / 8);
  std::vector<std::vector<State>> to(count);
  for (const State& state : states)
  {
    const auto owner =
      std::find_if(blocks.begin(), blocks.end(), [&](const lbm::Block& block) { return holds(block, state.node); });
    to[static_cast<std::size_t>(owner - blocks.begin())].push_back(state);
  }
  std::vector<int> sent(count);
  std::vector<int> received(count);
  std::vector<int> sentAt(count, 0);
  std::vector<int> receivedAt(count, 0);
  std::vector<State> out;
  for (std::size_t rank = 0; rank < count; ++rank)
  {
    sent[rank] = static_cast<int>(to[rank].size()) * words;
    sentAt[rank] = static_cast<int>(out.size()) * words;
    out.insert(out.end(), to[rank].begin(), to[rank].end());
  }
  MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, ranks.handle());
  std::partial_sum(received.begin(), received.end() - 1, receivedAt.begin() + 1);
  std::vector<State> in(static_cast<std::size_t>((receivedAt.back() + received.back()) / words));
  MPI_Alltoallv(out.data(), sent.data(), sentAt.data(), MPI_INT64_T, in.data(), received.data(), receivedAt.data(),
    MPI_INT64_T, ranks.handle());
  return in;
}

/// Flux into the nodes of the inlet face, on every rank; u fastest.
std::vector<double> inletFlux(const FluxField& field, const FluxSetting& setting, const lbm::Block& block,
  std::array<int, 2> across, const Communicator& ranks)
{
  const auto axis = static_cast<std::size_t>(setting.axis);
  const auto u = static_cast<std::size_t>(across[0]);
  const auto v = static_cast<std::size_t>(across[1]);
  const std::int64_t layer = setting.rising ? setting.lattice.size[axis] - 1 : 0;
  std::vector<double> inflow(static_cast<std::size_t>(setting.lattice.size[u] * setting.lattice.size[v]), 0.0);
  if (layer >= block.start[axis] && layer < block.start[axis] + block.size[axis])
  {
    Node node;
    for (node[v] = block.start[v]; node[v] < block.start[v] + block.size[v]; ++node[v])
    {
      for (node[u] = block.start[u]; node[u] < block.start[u] + block.size[u]; ++node[u])
      {
        node[axis] = setting.rising ? layer + 1 : layer;
        const double flux = field.face(node, setting.axis);
        inflow[static_cast<std::size_t>(node[u] + setting.lattice.size[u] * node[v])] =
          std::max(0.0, setting.rising ? -flux : flux);
      }
    }
  }
  ranks.sum(inflow); // one rank holds each node: adding zeros changes nothing
  return inflow;
}

/// Place between the nodes of a row where the summed weight reaches a share of the total.
double quantile(std::span<const double> weight, double total, double share)
{
  double before = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < weight.size(); ++i)
  {
    if (weight[i] > 0)
    {
      last = i;
      if (before + weight[i] >= share * total)
        return static_cast<double>(i) + std::clamp((share * total - before) / weight[i], 0.0, 1.0);
      before += weight[i];
    }
  }
  return static_cast<double>(last) + 1.0;
}

} // namespace

std::vector<std::array<double, 2>> seedInlet(
  std::span<const double> inflow, std::array<std::int64_t, 2> size, std::int64_t count)
{
  const auto nu = static_cast<std::size_t>(size[0]);
  const auto nv = static_cast<std::size_t>(size[1]);
  std::vector<double> rows(nv);
  for (std::size_t v = 0; v < nv; ++v)
  {
    const auto row = inflow.subspan(v * nu, nu);
    rows[v] = std::accumulate(row.begin(), row.end(), 0.0);
  }
  const double total = std::accumulate(rows.begin(), rows.end(), 0.0);
  std::vector<std::array<double, 2>> seeds;
  if (!(total > 0))
    return seeds;
  const double golden = (std::sqrt(5.0) - 1) / 2;
  for (std::int64_t i = 0; i < count; ++i)
  {
    const double even = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    // Along one row equal steps; over a face one step even, the other by the golden ratio.
    const double v = nv > 1 ? quantile(rows, total, even) : 0.5;
    const auto row = std::min(static_cast<std::size_t>(v), nv - 1);
    const double scattered = std::fmod((static_cast<double>(i) + 0.5) * golden, 1.0);
    const double u = quantile(inflow.subspan(row * nu, nu), rows[row], nv > 1 ? scattered : even);
    seeds.push_back({ u, v });
  }
  return seeds;
}

FluxLines traceLines(const FluxField& field, const FluxSetting& setting, const lbm::Block& block, std::int64_t count,
  const Communicator& ranks, const std::function<bool(double)>& proceed)
{
  FluxLines result;
  std::array<int, 2> across{ setting.axis == 0 ? 1 : 0, setting.axis == 2 ? 1 : 2 };
  const auto axis = static_cast<std::size_t>(setting.axis);
  const auto u = static_cast<std::size_t>(across[0]);
  const auto v = static_cast<std::size_t>(across[1]);
  const std::vector<double> inflow = inletFlux(field, setting, block, across, ranks);
  result.inflow = std::accumulate(inflow.begin(), inflow.end(), 0.0);
  const auto seeds = seedInlet(inflow, { setting.lattice.size[u], setting.lattice.size[v] }, count);
  result.length.assign(seeds.size(), 0.0);
  result.arrived.assign(seeds.size(), 0);

  std::vector<State> active;
  for (std::size_t line = 0; line < seeds.size(); ++line)
  {
    State state;
    state.line = static_cast<std::int64_t>(line);
    const std::array<std::size_t, 2> axes{ u, v };
    for (std::size_t k = 0; k < 2; ++k)
    {
      const std::int64_t last = setting.lattice.size[axes[k]] - 1;
      state.node[axes[k]] = std::min(static_cast<std::int64_t>(seeds[line][k]), last);
      // Never on a face between two cells, where the way could be either's.
      state.inside[axes[k]] = std::clamp(seeds[line][k] - static_cast<double>(state.node[axes[k]]), 1e-9, 1 - 1e-9);
    }
    state.node[axis] = setting.rising ? setting.lattice.size[axis] - 1 : 0;
    state.inside[axis] = setting.rising ? 1.0 : 0.0;
    if (holds(block, state.node))
      active.push_back(state);
  }

  const Tracer tracer(field, setting, block);
  const std::vector<lbm::Block> blocks = allBlocks(block, ranks);
  std::int64_t ended = 0;
  while (ranks.any(!active.empty()))
  {
    std::vector<LinePiece> pieces(active.size());
    std::vector<End> ends(active.size(), End::Left);
    const auto lines = static_cast<std::int64_t>(active.size());
#pragma omp parallel for schedule(dynamic, 1)
    for (std::int64_t i = 0; i < lines; ++i)
    {
      const auto at = static_cast<std::size_t>(i);
      ends[at] = tracer.follow(active[at], pieces[at]);
    }
    std::vector<State> passed;
    std::int64_t finished = 0;
    for (std::size_t i = 0; i < active.size(); ++i)
    {
      const auto line = static_cast<std::size_t>(active[i].line);
      if (ends[i] == End::Passed)
      {
        passed.push_back(active[i]);
      }
      else
      {
        result.length[line] = active[i].length;
        result.arrived[line] = ends[i] == End::Arrived ? 1 : 0;
        ++finished;
      }
      if (pieces[i].points.size() > 1)
        result.pieces.push_back(std::move(pieces[i]));
    }
    ended += ranks.sum(finished);
    active = handOver(passed, blocks, ranks);
    if (ranks.any(!proceed(static_cast<double>(ended) / static_cast<double>(std::max<std::size_t>(seeds.size(), 1)))))
      break;
  }
  ranks.sum(result.length); // one rank saw each line's end
  std::vector<double> arrived(result.arrived.begin(), result.arrived.end());
  ranks.sum(arrived);
  std::transform(
    arrived.begin(), arrived.end(), result.arrived.begin(), [](double all) { return static_cast<std::uint8_t>(all); });
  return result;
}

} // namespace lamella::flux
