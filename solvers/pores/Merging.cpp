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

/// Pores as pieces put together, in the order of their first nodes.
struct Whole
{
  UnfilledVector<Piece> pieces;
  std::vector<std::uint8_t> touches;
  std::vector<std::uint8_t> wraps;
  std::vector<std::uint32_t> of; ///< by piece: which pore it belongs to
};

Whole putTogether(const Lattice& lattice, std::span<const Piece> pieces, std::span<const Joint> joints, bool ranks)
{
  ShiftedSets sets(pieces);
  for (const Joint& joint : joints)
    sets.join(joint);
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < pieces.size(); ++i)
    if (sets.root(i) == i)
      roots.push_back(i);
  if (ranks)
    std::sort(
      roots.begin(), roots.end(), [&](std::uint32_t a, std::uint32_t b) { return pieces[a].first < pieces[b].first; });
  Whole whole;
  whole.of.resize(pieces.size());
  whole.pieces.assign(roots.size(), emptyPiece());
  whole.touches.assign(roots.size(), 0);
  whole.wraps.resize(roots.size());
  for (std::uint32_t i = 0; i < roots.size(); ++i)
  {
    whole.of[roots[i]] = i;
    whole.wraps[i] = sets.wraps(roots[i]);
  }
  for (std::uint32_t i = 0; i < pieces.size(); ++i)
  {
    const std::uint32_t root = sets.root(i);
    const std::uint32_t pore = whole.of[root];
    std::array<std::int64_t, 3> moved{};
    for (std::size_t axis = 0; axis < 3; ++axis) // without an end: as it lies in the box
      moved[axis] = (whole.wraps[pore] >> axis & 1U) != 0 ? 0 : sets.shift(i)[axis] * lattice.size[axis];
    whole.of[i] = pore;
    add(whole.pieces[pore], pieces[i], moved);
    whole.touches[pore] |= touched(pieces[i], lattice);
  }
  return whole;
}

/// In place, member by member: a pore put together elsewhere and then copied as a whole has to wait for its parts.
void write(Pore& pore, const Piece& piece, std::uint8_t touches, std::uint8_t wraps, const Lattice& lattice,
  const std::array<bool, 3>& periodic)
{
  const std::int64_t size = piece.size;
  pore.size = size;
  pore.first = piece.first;
  pore.touches = touches;
  const std::array<std::int64_t, 3> twice{ piece.twiceX, 2 * piece.sumY, 2 * piece.sumZ };
  const double scale = 0.5 / static_cast<double>(size);
  std::uint32_t percolates = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    std::int64_t inside = twice[axis];
    std::int32_t low = piece.low[axis];
    std::int32_t high = piece.high[axis];
    bool across = (touches >> (2 * axis) & 3U) == 3U;
    if (periodic[axis])
    {
      across = (wraps >> axis & 1U) != 0;
      const std::int64_t n = lattice.size[axis];
      if (across)
      {
        low = 0;
        high = static_cast<std::int32_t>(n - 1);
      }
      // into the box: the lower end of the box between 0 and n - 1, the centre between -1/2 and n - 1/2; whole numbers
      // as long as it goes, so that the last digit does not depend on the period it was summed in
      const std::int64_t periods = (low >= 0 ? low : low - n + 1) / n;
      low -= static_cast<std::int32_t>(periods * n);
      high -= static_cast<std::int32_t>(periods * n);
      const std::int64_t period = 2 * n * size;
      inside = ((inside + size) % period + period) % period - size;
    }
    pore.low[axis] = low;
    pore.high[axis] = high;
    percolates |= across ? 1U << axis : 0U;
    pore.centre[axis] = static_cast<double>(inside) * scale;
  }
  pore.percolates = static_cast<std::uint8_t>(percolates);
}

/// Pores in the order of their first nodes, cut into parts of equal length that are counted side by side: one count
/// after the other in the same place would each wait for the one before.
constexpr std::size_t parts = 4;

template <typename Action>
void forAll(std::size_t n, const Action& action)
{
  const std::size_t length = n / parts;
  for (std::size_t i = 0; i < length; ++i)
    for (std::size_t part = 0; part < parts; ++part)
      action(part * length + i, part);
  for (std::size_t i = parts * length; i < n; ++i) // the last part has what is left as well
    action(i, parts - 1);
}

/// Labels by pore, the largest first and equal ones as they are, or all as they are; 0 below the minimum size.
/// Most pores are small: they are counted into place.
/// @param sizes of the pores
/// @returns pores that would have a label
std::int64_t number(std::span<const Piece> pores, std::span<const std::uint32_t> sizes, const LabelOptions& options,
  std::span<std::int32_t> label)
{
  const std::int64_t least = std::max<std::int64_t>(options.minimumSize, 1);
  std::int64_t count = 0;
  if (!options.sortBySize)
  {
    for (std::size_t i = 0; i < pores.size(); ++i)
    {
      const bool kept = pores[i].size >= least;
      count += kept ? 1 : 0;
      label[i] = kept ? static_cast<std::int32_t>(count) : 0;
    }
    return count;
  }
  constexpr std::uint32_t small = 8192;
  // by size, then part: how many there are, then how many come before
  std::vector<std::array<std::uint32_t, parts>> place(small + 1);
  forAll(pores.size(), [&](std::size_t i, std::size_t part) { ++place[std::min(sizes[i], small)][part]; });
  std::vector<std::uint32_t> large;
  if (std::any_of(place[small].begin(), place[small].end(), [](std::uint32_t here) { return here > 0; }))
    for (std::uint32_t i = 0; i < pores.size(); ++i)
      if (sizes[i] >= small)
        large.push_back(i);
  std::stable_sort(
    large.begin(), large.end(), [&](std::uint32_t a, std::uint32_t b) { return pores[a].size > pores[b].size; });
  for (const std::uint32_t i : large)
  {
    count += pores[i].size >= least ? 1 : 0;
    label[i] = pores[i].size >= least ? static_cast<std::int32_t>(count) : 0;
  }
  for (std::uint32_t size = small - 1; size > 0; --size)
    for (std::uint32_t& before : place[size])
    {
      const std::uint32_t here = before;
      before = static_cast<std::uint32_t>(count);
      count += size >= least ? here : 0;
    }
  forAll(pores.size(),
    [&](std::size_t i, std::size_t part)
    {
      if (sizes[i] < small)
        label[i] = sizes[i] >= least ? static_cast<std::int32_t>(++place[sizes[i]][part]) : 0;
    });
  return count;
}

} // namespace

Piece emptyPiece()
{
  constexpr auto most = std::numeric_limits<std::int32_t>::max();
  return { 0, 0, 0, 0, { most, most, most }, { -most, -most, -most }, std::numeric_limits<std::int64_t>::max() };
}

void add(Piece& sum, const Piece& piece, const std::array<std::int64_t, 3>& moved)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    sum.low[axis] = std::min(sum.low[axis], static_cast<std::int32_t>(piece.low[axis] + moved[axis]));
    sum.high[axis] = std::max(sum.high[axis], static_cast<std::int32_t>(piece.high[axis] + moved[axis]));
  }
  sum.first = std::min(sum.first, piece.first);
  sum.size += piece.size;
  sum.twiceX += piece.twiceX + 2 * moved[0] * piece.size;
  sum.sumY += piece.sumY + moved[1] * piece.size;
  sum.sumZ += piece.sumZ + moved[2] * piece.size;
}

Merged merge(const Lattice& lattice, std::span<const Piece> pieces, std::span<const std::uint32_t> sizes,
  std::span<const Joint> joints, bool ranks, const LabelOptions& options)
{
  Merged merged;
  Whole whole;
  const bool apart = joints.empty() && !ranks; // every piece is a pore
  if (!apart)
    whole = putTogether(lattice, pieces, joints, ranks);
  const std::span<const Piece> pores = apart ? pieces : std::span<const Piece>(whole.pieces);
  UnfilledVector<std::int32_t> label(pores.size());
  PoreSummary& sum = merged.summary;
  UnfilledVector<std::uint32_t> own;
  if (!apart || sizes.empty())
  {
    static constexpr std::int64_t most = std::numeric_limits<std::uint32_t>::max();
    own.resize(pores.size());
    std::transform(pores.begin(), pores.end(), own.begin(),
      [](const Piece& pore) { return static_cast<std::uint32_t>(std::min(pore.size, most)); });
    sizes = own;
  }
  sum.count = number(pores, sizes, options, label);
  if (sum.count > std::min<std::int64_t>(options.mostLabels, std::numeric_limits<std::int32_t>::max()))
  {
    merged.tooMany = true;
    return merged;
  }
  std::uint8_t borders = 0; // sides that a pore can be open to
  for (std::size_t axis = 0; axis < 3; ++axis)
    borders |= static_cast<std::uint8_t>(options.periodic[axis] ? 0U : 3U << (2 * axis));
  merged.pores.resize(static_cast<std::size_t>(sum.count));
  for (std::size_t i = 0; i < pores.size(); ++i)
  {
    const std::int64_t size = pores[i].size;
    sum.phaseNodes += size;
    if (label[i] == 0)
    {
      ++sum.dropped;
      sum.droppedNodes += size;
      sum.largestDropped = std::max(sum.largestDropped, size);
      continue;
    }
    Pore& pore = merged.pores[static_cast<std::size_t>(label[i]) - 1];
    write(pore, pores[i], apart ? touched(pores[i], lattice) : whole.touches[i],
      apart ? std::uint8_t{ 0 } : whole.wraps[i], lattice, options.periodic);
    sum.largest = std::max(sum.largest, size);
    sum.percolates |= pore.percolates;
    const bool open = (pore.touches & borders) != 0 || pore.percolates != 0;
    sum.touching += open ? 1 : 0;
    sum.openNodes += open ? size : 0;
  }
  sum.total = sum.phaseNodes - sum.droppedNodes;
  if (apart)
  {
    merged.label = std::move(label);
    return merged;
  }
  merged.label.resize(pieces.size());
  std::transform(
    whole.of.begin(), whole.of.end(), merged.label.begin(), [&](std::uint32_t pore) { return label[pore]; });
  if (ranks)
  {
    merged.size.resize(pieces.size());
    std::transform(whole.of.begin(), whole.of.end(), merged.size.begin(),
      [&](std::uint32_t pore) { return static_cast<float>(pores[pore].size); });
  }
  return merged;
}

} // namespace lamella::pores
