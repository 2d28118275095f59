#include "BoxExchange.h"

#include "core/Error.h"

#include <algorithm>
#include <cstring>

namespace lamella
{
namespace
{

using lbm::Block;

/// What two boxes share; size zero when they are apart.
Block intersect(const Block& a, const Block& b)
{
  Block shared;
  for (int axis = 0; axis < 3; ++axis)
  {
    shared.start[axis] = std::max(a.start[axis], b.start[axis]);
    const std::int64_t end = std::min(a.start[axis] + a.size[axis], b.start[axis] + b.size[axis]);
    shared.size[axis] = end - shared.start[axis];
    if (shared.size[axis] <= 0)
      return {};
  }
  return shared;
}

bool contains(const Block& outer, const Block& inner)
{
  return intersect(outer, inner).count() == inner.count();
}

Block moved(Block box, const std::array<std::int64_t, 3>& shift)
{
  for (int axis = 0; axis < 3; ++axis)
    box.start[axis] += shift[axis];
  return box;
}

/// Calls action(offset in the box, bytes) for every row of `part` inside `whole`.
template <typename Action>
void forRows(const Block& whole, const Block& part, std::size_t bytes, const Action& action)
{
  const std::size_t length = static_cast<std::size_t>(part.size[0]) * bytes;
  for (std::int64_t z = 0; z < part.size[2]; ++z)
  {
    for (std::int64_t y = 0; y < part.size[1]; ++y)
    {
      const std::int64_t node = (part.start[0] - whole.start[0]) +
        whole.size[0] * ((part.start[1] + y - whole.start[1]) + whole.size[1] * (part.start[2] + z - whole.start[2]));
      action(static_cast<std::size_t>(node) * bytes, length);
    }
  }
}

struct Boxes
{
  Block held;
  Block needed;
};

} // namespace

BoxExchange::BoxExchange(const Lattice& lattice, const Block& held, const Block& needed, std::array<bool, 3> periodic,
  MPI_Comm comm, int ranks)
  : comm_(comm)
  , held_(held)
  , needed_(needed)
{
  std::vector<Boxes> all(static_cast<std::size_t>(ranks));
  all[0] = { held, needed };
  if (ranks > 1)
  {
    MPI_Comm_rank(comm, &rank_);
    const Boxes mine{ held, needed };
    static_assert(sizeof(Boxes) == 12 * sizeof(std::int64_t));
    MPI_Allgather(&mine, 12, MPI_INT64_T, all.data(), 12, MPI_INT64_T, comm);
  }
  identity_ = std::all_of(all.begin(), all.end(),
    [](const Boxes& boxes) { return boxes.held.start == boxes.needed.start && boxes.held.size == boxes.needed.size; });

  // Every rank knows all boxes, so both sides list the same parts in the same order.
  int tag = 0;
  std::array<int, 3> reach{ 0, 0, 0 };
  for (int axis = 0; axis < 3; ++axis)
    reach[axis] = periodic[axis] ? 1 : 0;
  for (int to = 0; to < ranks; ++to)
  {
    const Block& wanted = all[static_cast<std::size_t>(to)].needed;
    const bool alone = contains(all[static_cast<std::size_t>(to)].held, wanted); // nobody else need send anything
    for (int from = 0; from < ranks; ++from)
    {
      if (alone && from != to)
        continue;
      for (int k = -reach[2]; k <= reach[2]; ++k)
      {
        for (int j = -reach[1]; j <= reach[1]; ++j)
        {
          for (int i = -reach[0]; i <= reach[0]; ++i)
          {
            const std::array<std::int64_t, 3> shift{ i * lattice.size[0], j * lattice.size[1], k * lattice.size[2] };
            const Block there = intersect(moved(all[static_cast<std::size_t>(from)].held, shift), wanted);
            if (there.count() == 0)
              continue;
            const Block here = moved(there, { -shift[0], -shift[1], -shift[2] });
            ++tag;
            if (from == rank_)
              sent_.push_back({ to, tag, here, shift });
            if (to == rank_)
              received_.push_back({ from, tag, here, shift });
          }
        }
      }
    }
  }

  std::int64_t missing = 0;
  if (!contains(held_, needed_))
  {
    std::vector<std::uint8_t> covered(static_cast<std::size_t>(needed_.count()), 0);
    for (const Part& part : received_)
    {
      forRows(
        needed_, moved(part.box, part.shift), 1,
        [&](std::size_t offset, std::size_t length)
        { std::fill_n(covered.begin() + static_cast<std::ptrdiff_t>(offset), length, std::uint8_t{ 1 }); });
    }
    missing = std::count(covered.begin(), covered.end(), std::uint8_t{ 0 });
  }
  if (ranks > 1)
    MPI_Allreduce(MPI_IN_PLACE, &missing, 1, MPI_INT64_T, MPI_SUM, comm);
  if (missing > 0)
  {
    throw InputError("the pieces of the image leave out " + std::to_string(missing) + " of " +
        std::to_string(lattice.count()) + " nodes",
      "let every rank hold its share of the whole image: update the pipeline with as many pieces as there are ranks");
  }
}

void BoxExchange::move(const std::byte* held, std::byte* needed, std::size_t bytes) const
{
  std::vector<std::vector<std::byte>> outgoing;
  std::vector<std::vector<std::byte>> incoming;
  std::vector<MPI_Request> requests;
  outgoing.reserve(sent_.size());
  incoming.reserve(received_.size());
  MPI_Datatype node = MPI_DATATYPE_NULL; // counts of nodes, not bytes: 2^31 bytes are soon reached
  const bool alone = std::all_of(sent_.begin(), sent_.end(), [this](const Part& part) { return part.rank == rank_; }) &&
    std::all_of(received_.begin(), received_.end(), [this](const Part& part) { return part.rank == rank_; });
  if (!alone)
  {
    MPI_Type_contiguous(static_cast<int>(bytes), MPI_BYTE, &node);
    MPI_Type_commit(&node);
  }
  for (const Part& part : received_)
  {
    auto& buffer = incoming.emplace_back();
    if (part.rank != rank_)
    {
      buffer.resize(static_cast<std::size_t>(part.box.count()) * bytes);
      MPI_Irecv(
        buffer.data(), static_cast<int>(part.box.count()), node, part.rank, part.tag, comm_, &requests.emplace_back());
    }
  }
  for (const Part& part : sent_)
  {
    auto& buffer = outgoing.emplace_back();
    buffer.resize(static_cast<std::size_t>(part.box.count()) * bytes);
    std::size_t filled = 0;
    forRows(held_, part.box, bytes,
      [&](std::size_t offset, std::size_t length)
      {
        std::memcpy(buffer.data() + filled, held + offset, length);
        filled += length;
      });
    if (part.rank != rank_)
    {
      MPI_Isend(
        buffer.data(), static_cast<int>(part.box.count()), node, part.rank, part.tag, comm_, &requests.emplace_back());
    }
    else // to itself: the part with the same tag on the receiving side
    {
      const auto same =
        std::find_if(received_.begin(), received_.end(), [&](const Part& other) { return other.tag == part.tag; });
      incoming[static_cast<std::size_t>(same - received_.begin())].swap(buffer);
    }
  }
  if (!requests.empty())
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  for (std::size_t index = 0; index < received_.size(); ++index)
  {
    const Part& part = received_[index];
    std::size_t taken = 0;
    forRows(needed_, moved(part.box, part.shift), bytes,
      [&](std::size_t offset, std::size_t length)
      {
        std::memcpy(needed + offset, incoming[index].data() + taken, length);
        taken += length;
      });
  }
  if (!alone)
    MPI_Type_free(&node);
}

} // namespace lamella
