#include "peridynamics/multigrid/Agglomeration.h"

#include <algorithm>
#include <cstddef>

namespace lamella::peridynamics
{
namespace
{

constexpr int leastHalvings = 2; // that a slab allows
constexpr int mostHalvings = 6;  // that are looked for
constexpr std::int64_t even =
  4; // as many of the layers that allow so many, and no slab is more than a fourth too thick

std::size_t slowest(const NodeLayout& l)
{
  return l.dimension == 3 ? 2 : 1;
}

/// Nodes in memory of a layer.
std::int64_t layerLength(const NodeLayout& l)
{
  return (l.dimension == 3 ? l.rowsY() : 1) * l.pitch;
}

/// Position of a layer of the whole lattice in a rank's field.
std::int64_t layerBegin(const NodeLayout& l, std::int64_t layer)
{
  return l.begin(0) + (l.ghost + layer - l.start[slowest(l)]) * layerLength(l);
}

} // namespace

std::int64_t Agglomeration::slabs(std::int64_t layers, int reach, const Communicator& comm) noexcept
{
  return std::clamp<std::int64_t>((layers >> leastHalvings) / reach, 1, comm.size());
}

Agglomeration::Agglomeration(const NodeLayout& part, const Communicator& comm, std::int64_t slabs)
  : part_(part)
  , all_(comm)
{
  const std::size_t a = slowest(part);
  const std::int64_t layers = part.global[a];
  const std::int64_t ranks = comm.size();
  const std::int64_t own = part.start[a];
  std::vector<std::int64_t> begins(static_cast<std::size_t>(ranks) + 1, layers); // of the thin slabs
  MPI_Allgather(&own, 1, MPI_INT64_T, begins.data(), 1, MPI_INT64_T, comm.handle());

  int halvings = mostHalvings;
  while (halvings > leastHalvings && (layers >> halvings) / slabs < even)
    --halvings;
  const auto begin = [&](std::int64_t s)
  { return s == slabs ? layers : ((layers >> halvings) * s / slabs) << halvings; };
  const auto leader = [&](std::int64_t s) { return static_cast<int>(s * ranks / slabs); };
  for (std::int64_t s = 0; s < slabs; ++s)
  {
    const int lead = leader(s);
    const bool mine = lead == comm.rank();
    if (mine)
      thick_ = { begin(s), begin(s + 1) };
    for (int r = 0; r < comm.size(); ++r)
    {
      const auto at = static_cast<std::size_t>(r);
      const Layers common{ r, std::max(begins[at], begin(s)), std::min(begins[at + 1], begin(s + 1)) };
      if (common.first >= common.last)
        continue;
      if (mine)
        take_.push_back(common);
      if (r == comm.rank())
        give_.push_back({ lead, common.first, common.last });
    }
  }
  MPI_Comm leaders = MPI_COMM_NULL;
  MPI_Comm_split(comm.handle(), thick_[1] > 0 ? 0 : MPI_UNDEFINED, comm.rank(), &leaders);
  comm_ = Communicator(leaders);
}

Agglomeration::~Agglomeration()
{
  int over = 0;
  MPI_Finalized(&over);
  MPI_Comm leaders = comm_.handle();
  if (over == 0 && leaders != MPI_COMM_NULL)
    MPI_Comm_free(&leaders);
}

NodeLayout Agglomeration::layout() const
{
  const std::size_t a = slowest(part_);
  std::array<std::int64_t, 3> size = part_.size;
  std::array<std::int64_t, 3> start = part_.start;
  size[a] = thick_[1] - thick_[0];
  start[a] = thick_[0];
  return NodeLayout::make(part_.dimension, part_.ghost, size, start, part_.global, part_.before > 0);
}

void Agglomeration::gather(const NodeField<float>& part, NodeField<float>* whole, int first, int count) const
{
  send(&part, give_, whole, take_, first, count);
}

void Agglomeration::spread(const NodeField<float>* whole, NodeField<float>& part) const
{
  send(whole, take_, &part, give_, 0, part.components());
}

// A message has all components of its layers, one after the other. A layer is as long in both fields.
void Agglomeration::send(const NodeField<float>* from, const std::vector<Layers>& out, NodeField<float>* to,
  const std::vector<Layers>& in, int first, int count) const
{
  constexpr int tag = 75;
  const std::int64_t layer = layerLength(part_);
  const auto length = [&](const Layers& l) { return count * (l.last - l.first) * layer; };
  const auto each = [&](const Layers& l, const auto& f) // of the message, of the field
  {
    for (int c = 0; c < count; ++c)
      f(c * (l.last - l.first) * layer, first + c, (l.last - l.first) * layer);
  };
  const auto buffers = [&](const std::vector<Layers>& all)
  {
    std::vector<std::vector<float>> made;
    made.reserve(all.size());
    for (const Layers& l : all)
      made.emplace_back(static_cast<std::size_t>(length(l)));
    return made;
  };
  std::vector<std::vector<float>> given = buffers(out);
  std::vector<std::vector<float>> taken = buffers(in);
  std::vector<MPI_Request> requests;
  for (std::size_t k = 0; k < in.size(); ++k)
    if (in[k].rank != all_.rank())
      MPI_Irecv(taken[k].data(), static_cast<int>(taken[k].size()), MPI_FLOAT, in[k].rank, tag, all_.handle(),
        &requests.emplace_back());
  std::size_t kept = 0; // what stays on this rank
  for (std::size_t k = 0; k < out.size(); ++k)
  {
    const std::int64_t begin = layerBegin(from->layout(), out[k].first);
    each(out[k],
      [&](std::int64_t at, int c, std::int64_t n)
      { std::copy_n(from->component(c) + begin, n, given[k].data() + at); });
    if (out[k].rank == all_.rank())
      kept = k;
    else
      MPI_Isend(given[k].data(), static_cast<int>(given[k].size()), MPI_FLOAT, out[k].rank, tag, all_.handle(),
        &requests.emplace_back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  for (std::size_t k = 0; k < in.size(); ++k)
  {
    const std::vector<float>& come = in[k].rank == all_.rank() ? given[kept] : taken[k];
    const std::int64_t begin = layerBegin(to->layout(), in[k].first);
    each(in[k],
      [&](std::int64_t at, int c, std::int64_t n) { std::copy_n(come.data() + at, n, to->component(c) + begin); });
  }
}

} // namespace lamella::peridynamics
