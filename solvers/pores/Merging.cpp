#include "pores/Merging.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace lamella::pores
{
namespace
{

using Shift = std::array<std::int32_t, 3>;

/// Sets of pieces, each piece with the number of periods that it is moved by to lie where it hangs together with the
/// root of its set.
class ShiftedSets
{
public:
  explicit ShiftedSets(std::span<const Piece> pieces)
    : pieces_(pieces)
    , parent_(pieces.size())
    , shift_(pieces.size(), Shift{ 0, 0, 0 })
    , wraps_(pieces.size(), 0)
  {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  void join(const Joint& joint)
  {
    const std::uint32_t a = root(joint.a);
    const std::uint32_t b = root(joint.b);
    Shift step{}; // of root b against root a
    for (std::size_t axis = 0; axis < 3; ++axis)
      step[axis] = shift_[joint.a][axis] + joint.shift[axis] - shift_[joint.b][axis];
    if (a == b)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
        wraps_[a] |= static_cast<std::uint8_t>(step[axis] != 0 ? 1U << axis : 0U); // it meets itself a period further
      return;
    }
    const bool keepA = pieces_[a].first < pieces_[b].first;
    const std::uint32_t top = keepA ? a : b;
    const std::uint32_t below = keepA ? b : a;
    parent_[below] = top;
    for (std::size_t axis = 0; axis < 3; ++axis)
      shift_[below][axis] = keepA ? step[axis] : -step[axis];
    wraps_[top] |= wraps_[below];
  }

  /// Afterwards every piece on the way points at the root.
  std::uint32_t root(std::uint32_t piece)
  {
    path_.clear();
    while (parent_[piece] != piece)
    {
      path_.push_back(piece);
      piece = parent_[piece];
    }
    for (std::size_t i = path_.size(); i-- > 1;) // the piece nearest the root is right already
      for (std::size_t axis = 0; axis < 3; ++axis)
        shift_[path_[i - 1]][axis] += shift_[path_[i]][axis];
    for (const std::uint32_t passed : path_)
      parent_[passed] = piece;
    return piece;
  }

  [[nodiscard]] const Shift& shift(std::uint32_t piece) const noexcept { return shift_[piece]; }
  [[nodiscard]] std::uint8_t wraps(std::uint32_t root) const noexcept { return wraps_[root]; }

private:
  std::span<const Piece> pieces_;
  std::vector<std::uint32_t> parent_;
  std::vector<Shift> shift_;
  std::vector<std::uint8_t> wraps_;
  std::vector<std::uint32_t> path_;
};

std::uint8_t touched(const Piece& piece, const Lattice& lattice)
{
  std::uint8_t bits = 0;
  for (int axis = 0; axis < lattice.dimension; ++axis)
  {
    const auto a = static_cast<std::size_t>(axis);
    bits |= static_cast<std::uint8_t>((piece.low[a] == 0 ? 1U : 0U) << (2 * axis));
    bits |= static_cast<std::uint8_t>((piece.high[a] == lattice.size[a] - 1 ? 2U : 0U) << (2 * axis));
  }
  return bits;
}

/// Sums of a pore while its pieces come in.
struct Sum
{
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  std::int64_t size = 0;
  std::array<std::int64_t, 3> twice{ 0, 0, 0 }; ///< twice the sum of the places
  std::array<std::int64_t, 3> low{ first, first, first };
  std::array<std::int64_t, 3> high{ -first, -first, -first };
  std::uint8_t touches = 0;

  void add(const Piece& piece, const Shift& shift, const Lattice& lattice)
  {
    const std::array<std::int64_t, 3> own{ piece.twiceX, 2 * piece.sumY, 2 * piece.sumZ };
    first = std::min(first, piece.first);
    size += piece.size;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const std::int64_t moved = shift[axis] * lattice.size[axis];
      twice[axis] += own[axis] + 2 * moved * piece.size;
      low[axis] = std::min(low[axis], piece.low[axis] + moved);
      high[axis] = std::max(high[axis], piece.high[axis] + moved);
    }
    touches |= touched(piece, lattice);
  }

  [[nodiscard]] Pore pore(std::uint8_t wraps, const Lattice& lattice, const LabelOptions& options) const
  {
    Pore result{ size, first, {}, low, high, touches, 0 };
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const std::int64_t n = lattice.size[axis];
      const bool wrapped = (wraps >> axis & 1U) != 0;
      const bool across = options.periodic[axis] ? wrapped : (touches >> (2 * axis) & 3U) == 3U;
      result.percolates |= static_cast<std::uint8_t>(across ? 1U << axis : 0U);
      if (wrapped)
      {
        result.low[axis] = 0;
        result.high[axis] = n - 1;
      }
      else
      {
        // into the box: the lower end of the box between 0 and n − 1, the centre between −½ and n − ½
        const std::int64_t periods = (low[axis] >= 0 ? low[axis] : low[axis] - n + 1) / n;
        result.low[axis] -= periods * n;
        result.high[axis] -= periods * n;
      }
      // whole numbers as long as it goes, so that the last digit does not depend on the period it was summed in
      const std::int64_t period = 2 * n * size;
      const std::int64_t from = -size;
      const std::int64_t inside = ((twice[axis] - from) % period + period) % period + from;
      result.centre[axis] = static_cast<double>(inside) / (2.0 * static_cast<double>(size));
    }
    return result;
  }
};

/// By size, the largest first; equal ones as they are. Most pores are small: they are counted into place.
std::vector<std::uint32_t> bySize(const std::vector<Pore>& pores)
{
  constexpr std::size_t small = 65536;
  std::vector<std::uint32_t> order(pores.size());
  std::vector<std::uint32_t> place(small + 1, 0);
  std::vector<std::uint32_t> large;
  for (std::uint32_t i = 0; i < pores.size(); ++i)
  {
    if (pores[i].size < static_cast<std::int64_t>(small))
      ++place[small - 1 - static_cast<std::size_t>(pores[i].size) + 1];
    else
      large.push_back(i);
  }
  std::stable_sort(
    large.begin(), large.end(), [&](std::uint32_t a, std::uint32_t b) { return pores[a].size > pores[b].size; });
  std::copy(large.begin(), large.end(), order.begin());
  place[0] = static_cast<std::uint32_t>(large.size());
  std::partial_sum(place.begin(), place.end(), place.begin());
  for (std::uint32_t i = 0; i < pores.size(); ++i)
    if (pores[i].size < static_cast<std::int64_t>(small))
      order[place[small - 1 - static_cast<std::size_t>(pores[i].size)]++] = i;
  return order;
}

/// The pores in the order of their first nodes, and by piece which of them it belongs to.
std::vector<Pore> put(const Lattice& lattice, std::span<const Piece> pieces, std::span<const Joint> joints,
  bool inOrder, const LabelOptions& options, std::vector<std::uint32_t>& poreOf)
{
  std::vector<Pore> pores;
  poreOf.resize(pieces.size());
  if (joints.empty() && inOrder) // every piece is a pore
  {
    std::iota(poreOf.begin(), poreOf.end(), 0U);
    pores.reserve(pieces.size());
    for (const Piece& piece : pieces)
    {
      Sum sum;
      sum.add(piece, Shift{ 0, 0, 0 }, lattice);
      pores.push_back(sum.pore(0, lattice, options));
    }
    return pores;
  }
  ShiftedSets sets(pieces);
  for (const Joint& joint : joints)
    sets.join(joint);
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < pieces.size(); ++i)
    if (sets.root(i) == i)
      roots.push_back(i);
  if (!inOrder)
    std::sort(
      roots.begin(), roots.end(), [&](std::uint32_t a, std::uint32_t b) { return pieces[a].first < pieces[b].first; });
  for (std::uint32_t i = 0; i < roots.size(); ++i)
    poreOf[roots[i]] = i;
  std::vector<Sum> sums(roots.size());
  for (std::uint32_t i = 0; i < pieces.size(); ++i)
  {
    const std::uint32_t root = sets.root(i);
    Shift shift = sets.shift(i);
    for (std::size_t axis = 0; axis < 3; ++axis)
      shift[axis] = (sets.wraps(root) >> axis & 1U) != 0 ? 0 : shift[axis]; // without an end: as it lies in the box
    poreOf[i] = poreOf[root];
    sums[poreOf[i]].add(pieces[i], shift, lattice);
  }
  pores.reserve(sums.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
    pores.push_back(sums[i].pore(sets.wraps(roots[i]), lattice, options));
  return pores;
}

} // namespace

Merged merge(const Lattice& lattice, std::span<const Piece> pieces, std::span<const Joint> joints, bool inOrder,
  const LabelOptions& options)
{
  Merged merged;
  std::vector<std::uint32_t> poreOf;
  std::vector<Pore> all = put(lattice, pieces, joints, inOrder, options, poreOf);
  std::vector<std::uint32_t> order;
  if (options.sortBySize)
    order = bySize(all);
  PoreSummary& sum = merged.summary;
  std::uint8_t open = 0; // sides that a pore can be open to
  for (std::size_t axis = 0; axis < 3; ++axis)
    open |= static_cast<std::uint8_t>(options.periodic[axis] ? 0U : 3U << (2 * axis));
  std::vector<std::int32_t> labelOf(all.size(), 0);
  const bool anyDropped = options.minimumSize > 1;
  if (options.sortBySize || anyDropped)
    merged.pores.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    const std::size_t at = options.sortBySize ? order[i] : i;
    const Pore& pore = all[at];
    sum.phaseNodes += pore.size;
    if (pore.size < options.minimumSize)
    {
      ++sum.dropped;
      sum.droppedNodes += pore.size;
      sum.largestDropped = std::max(sum.largestDropped, pore.size);
      continue;
    }
    ++sum.count;
    sum.total += pore.size;
    sum.largest = std::max(sum.largest, pore.size);
    sum.percolates |= pore.percolates;
    if ((pore.touches & open) != 0 || pore.percolates != 0)
    {
      ++sum.touching;
      sum.openNodes += pore.size;
    }
    if (sum.count <= options.mostLabels)
    {
      labelOf[at] = static_cast<std::int32_t>(sum.count);
      if (options.sortBySize || anyDropped)
        merged.pores.push_back(pore);
    }
  }
  if (sum.count > options.mostLabels)
  {
    merged.pores.clear();
    merged.tooMany = true;
    return merged;
  }
  merged.label.resize(pieces.size());
  merged.size.resize(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i)
  {
    const std::int32_t label = labelOf[poreOf[i]];
    merged.label[i] = label;
    merged.size[i] = label > 0 ? static_cast<float>(all[poreOf[i]].size) : std::numeric_limits<float>::quiet_NaN();
  }
  if (!options.sortBySize && !anyDropped)
    merged.pores = std::move(all);
  return merged;
}

} // namespace lamella::pores
