#include "pores/PoreLabelling.h"

#include "lattice/Error.h"
#include "pores/Gathering.h"
#include "pores/Merging.h"
#include "pores/Runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <map>
#include <numeric>

namespace lamella::pores
{
namespace
{

/// A row that touches the one at (0, 0) and comes before it in memory.
struct Neighbour
{
  int y;
  int z;
  bool diagonal; ///< also where only corners meet, x one off
};

std::vector<Neighbour> neighbours(int connectivity)
{
  switch (connectivity)
  {
    case 4:
      return { { -1, 0, false } };
    case 8:
      return { { -1, 0, true } };
    case 6:
      return { { -1, 0, false }, { 0, -1, false } };
    case 18:
      return { { -1, 0, true }, { 0, -1, true }, { -1, -1, false }, { 1, -1, false } };
    default:
      return { { -1, 0, true }, { 0, -1, true }, { -1, -1, true }, { 1, -1, true } };
  }
}

const ForEach inTurn = [](int count, const std::function<void(int)>& body)
{
  for (int i = 0; i < count; ++i)
    body(i);
};

/// In place: parents, none above its child, become numbers of their roots in rising order. @returns how many roots
std::uint32_t number(std::span<std::uint32_t> parent)
{
  std::uint32_t roots = 0;
  for (std::uint32_t i = 0; i < parent.size(); ++i)
  {
    const bool root = parent[i] == i;
    const std::uint32_t known = parent[parent[i]]; // lower ones are numbers already
    parent[i] = root ? roots : known;
    roots += root ? 1U : 0U;
  }
  return roots;
}

std::uint32_t rootOf(std::vector<std::uint32_t>& parent, std::uint32_t i)
{
  while (parent[i] != i)
  {
    parent[i] = parent[parent[i]];
    i = parent[i];
  }
  return i;
}

/// Values by piece of the block as values by piece of the slab.
template <typename Value>
std::vector<Value> bySlab(std::span<const Value> ofBlock, std::span<const std::uint32_t> blockPiece)
{
  std::vector<Value> values(blockPiece.size());
  std::transform(
    blockPiece.begin(), blockPiece.end(), values.begin(), [&](std::uint32_t piece) { return ofBlock[piece]; });
  return values;
}

} // namespace

/// Rows that one thread does by itself.
struct PoreLabelling::Slab
{
  std::int64_t firstRow = 0; ///< counted in the block, y fastest
  std::int64_t rows = 0;
  std::int64_t words = 0;                ///< a row
  UnfilledVector<std::uint64_t> bits;    ///< rows × words
  UnfilledVector<std::uint32_t> before;  ///< rows × words
  std::vector<std::uint32_t> firstRun;   ///< rows + 1
  UnfilledVector<std::uint32_t> pieceOf; ///< by run
  UnfilledVector<Piece> pieces;          ///< emptied once they are the block's
  std::uint32_t count = 0;               ///< pieces of the slab
  std::vector<std::uint32_t> blockPiece; ///< by piece of the slab; empty when there is one slab: they are the same

  [[nodiscard]] bool holds(std::int64_t row) const noexcept { return row >= firstRow && row < firstRow + rows; }
  [[nodiscard]] Row row(std::int64_t blockRow) const noexcept
  {
    const auto at = static_cast<std::size_t>((blockRow - firstRow) * words);
    return { bits.data() + at, before.data() + at };
  }
  [[nodiscard]] std::span<const std::uint32_t> piecesOfRow(std::int64_t blockRow) const noexcept
  {
    const auto r = static_cast<std::size_t>(blockRow - firstRow);
    return std::span(pieceOf).subspan(firstRun[r], firstRun[r + 1] - firstRun[r]);
  }
  /// The block's piece at a node, or −1.
  [[nodiscard]] std::int64_t at(std::int64_t blockRow, std::int64_t x) const noexcept
  {
    const Row r = row(blockRow);
    const std::int64_t w = x / 64;
    const std::uint64_t node = std::uint64_t{ 1 } << (x % 64);
    if ((r.bits[w] & node) == 0)
      return -1;
    const std::uint64_t last = w > 0 ? r.bits[w - 1] >> 63 : 0;
    const std::uint64_t begin = r.bits[w] & ~(r.bits[w] << 1 | last);
    const auto run = r.before[w] + static_cast<std::uint32_t>(std::popcount(begin & (node | (node - 1)))) - 1;
    return ofBlock(pieceOf[run]);
  }
  [[nodiscard]] std::uint32_t ofBlock(std::uint32_t piece) const noexcept
  {
    return blockPiece.empty() ? piece : blockPiece[piece];
  }
  /// Writes the value of its piece into every node of the slab's rows.
  template <typename Value, typename Kernel>
  void fill(Kernel kernel, std::span<const Value> ofBlock, Value background, std::int64_t nx, Value* block) const
  {
    std::vector<Value> own;
    if (!blockPiece.empty())
      own = bySlab<Value>(ofBlock, blockPiece);
    const Value* const value = blockPiece.empty() ? ofBlock.data() : own.data();
    std::vector<std::int32_t> edges(static_cast<std::size_t>(nx + 16));
    for (std::int64_t r = firstRow; r < firstRow + rows; ++r)
    {
      const std::int64_t runs = runKernels().edges(row(r).bits, nx, edges.data());
      kernel(
        edges.data(), runs, piecesOfRow(r).data(), value, background, block + r * nx, nx, (firstRow + rows - r) * nx);
    }
  }
};

/// What happens once: from nodes to pieces of the block, and from these to pores.
class PoreLabelling::Work
{
public:
  Work(PoreLabelling& self, const Lattice& lattice, const Block& block, const Communicator& comm,
    std::span<const std::uint8_t> phase, std::uint8_t wanted, const LabelOptions& options)
    : self_(self)
    , lattice_(lattice)
    , block_(block)
    , comm_(comm)
    , phase_(phase)
    , wanted_(wanted)
    , options_(options)
    , near_(neighbours(options.connectivity))
  {
  }

  void run()
  {
    cut();
    self_.forEach_(
      static_cast<int>(self_.slabs_.size()), [this](int i) { label(self_.slabs_[static_cast<std::size_t>(i)]); });
    proceed(0.5);
    joinSlabs();
    proceed(0.6);
    joinAll();
    proceed(0.7);
  }

private:
  void proceed(double share) const
  {
    const bool stop = options_.progress && !options_.progress(share);
    if (comm_.any(stop))
      throw Cancelled();
  }

  [[nodiscard]] std::int64_t rows() const noexcept { return block_.size[1] * block_.size[2]; }
  [[nodiscard]] std::array<std::int64_t, 2> place(std::int64_t row) const noexcept
  {
    return { row % block_.size[1], row / block_.size[1] };
  }
  /// The row of a neighbour inside the block, or −1.
  [[nodiscard]] std::int64_t inside(std::int64_t row, const Neighbour& n) const noexcept
  {
    const auto [y, z] = place(row);
    const bool in = y + n.y >= 0 && y + n.y < block_.size[1] && z + n.z >= 0;
    return in ? row + n.y + n.z * block_.size[1] : -1;
  }
  [[nodiscard]] const Slab& slabOf(std::int64_t row) const
  {
    const auto after = std::upper_bound(self_.slabs_.begin(), self_.slabs_.end(), row,
      [](std::int64_t wantedRow, const Slab& slab) { return wantedRow < slab.firstRow; });
    return *std::prev(after);
  }

  void cut()
  {
    // Numbers of runs are 32 bits wide: slabs of at most 2³¹ nodes.
    const std::int64_t least = block_.count() / (std::int64_t{ 1 } << 31) + 1;
    const std::int64_t count = std::clamp<std::int64_t>(std::max<std::int64_t>(options_.slabs, least), 1, rows());
    self_.slabs_.resize(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i)
    {
      Slab& slab = self_.slabs_[static_cast<std::size_t>(i)];
      slab.firstRow = rows() * i / count;
      slab.rows = rows() * (i + 1) / count - slab.firstRow;
      slab.words = (block_.size[0] + 63) / 64;
    }
  }

  void label(Slab& slab) const
  {
    const RunKernels& kernels = runKernels();
    const std::int64_t nx = block_.size[0];
    slab.bits.resize(static_cast<std::size_t>(slab.rows * slab.words));
    slab.before.resize(slab.bits.size());
    slab.firstRun.assign(1, 0);
    slab.firstRun.reserve(static_cast<std::size_t>(slab.rows + 1));
    std::uint32_t runs = 0;
    for (std::int64_t r = 0; r < slab.rows; ++r)
    {
      const auto at = static_cast<std::size_t>(r * slab.words);
      const std::int64_t row = slab.firstRow + r;
      const std::int64_t readable = static_cast<std::int64_t>(phase_.size()) - row * nx;
      runs = kernels.scan(
        phase_.data() + row * nx, nx, readable, wanted_, slab.bits.data() + at, slab.before.data() + at, runs);
      slab.firstRun.push_back(runs);
    }
    slab.pieceOf.resize(runs);
    for (std::int64_t r = 0; r < slab.rows; ++r)
    {
      const std::int64_t row = slab.firstRow + r;
      const auto first = slab.firstRun[static_cast<std::size_t>(r)];
      const auto own = slab.piecesOfRow(row).size();
      std::iota(slab.pieceOf.begin() + first, slab.pieceOf.begin() + first + static_cast<std::ptrdiff_t>(own), first);
      for (const Neighbour& n : near_)
        if (const std::int64_t other = inside(row, n); other >= slab.firstRow)
          kernels.unite(slab.row(row), slab.row(other), slab.words, n.diagonal, slab.pieceOf.data());
    }
    slab.count = number(slab.pieceOf);
    slab.pieces.resize(slab.count);
    std::uint32_t known = 0;
    std::vector<std::int32_t> edges(static_cast<std::size_t>(nx + 16));
    for (std::int64_t row = slab.firstRow; row < slab.firstRow + slab.rows; ++row)
    {
      const std::int64_t found = kernels.edges(slab.row(row).bits, nx, edges.data());
      const auto [y, z] = place(row);
      known = kernels.measure(edges.data(), found, slab.piecesOfRow(row).data(), known,
        lattice_.index(0, block_.start[1] + y, block_.start[2] + z), static_cast<std::int32_t>(block_.start[1] + y),
        static_cast<std::int32_t>(block_.start[2] + z), slab.pieces.data());
    }
  }

  /// From pieces of slabs to pieces of the block, which rise by their first nodes as they did.
  void joinSlabs()
  {
    std::vector<std::uint32_t> before{ 0 }; // pieces of the slabs before
    for (const Slab& slab : self_.slabs_)
      before.push_back(before.back() + slab.count);
    if (self_.slabs_.size() == 1)
    {
      pieces_ = std::move(self_.slabs_.front().pieces);
      return;
    }
    const RunKernels& kernels = runKernels();
    std::vector<std::uint32_t> parent(before.back());
    std::iota(parent.begin(), parent.end(), 0U);
    std::vector<Contact> contacts(static_cast<std::size_t>(64 * self_.slabs_.front().words));
    for (std::size_t s = 1; s < self_.slabs_.size(); ++s)
    {
      const Slab& slab = self_.slabs_[s];
      const std::int64_t end = std::min(slab.firstRow + slab.rows, slab.firstRow + block_.size[1] + 1);
      for (std::int64_t row = slab.firstRow; row < end; ++row)
        for (const Neighbour& n : near_)
        {
          const std::int64_t other = inside(row, n);
          if (other < 0 || other >= slab.firstRow)
            continue;
          const Slab& there = slabOf(other);
          const auto offset = before[static_cast<std::size_t>(&there - self_.slabs_.data())];
          const std::int64_t count =
            kernels.contacts(slab.row(row), there.row(other), slab.words, n.diagonal, contacts.data());
          for (const Contact& c : std::span(contacts).first(static_cast<std::size_t>(count)))
          {
            const std::uint32_t a = rootOf(parent, before[s] + slab.pieceOf[c.a]);
            const std::uint32_t b = rootOf(parent, offset + there.pieceOf[c.b]);
            parent[std::max(a, b)] = std::min(a, b);
          }
        }
    }
    pieces_.assign(number(parent), emptyPiece());
    for (std::size_t s = 0; s < self_.slabs_.size(); ++s)
    {
      Slab& slab = self_.slabs_[s];
      slab.blockPiece.assign(parent.begin() + before[s], parent.begin() + before[s + 1]);
      for (std::uint32_t i = 0; i < slab.count; ++i)
        add(pieces_[slab.blockPiece[i]], slab.pieces[i]);
      slab.pieces = {};
    }
  }

  /// Pieces of the row, counted over all ranks from 1, 0 outside: what ranks show each other.
  void writeRow(std::int64_t row, std::uint32_t offset, std::span<std::uint32_t> out) const
  {
    const Slab& slab = slabOf(row);
    std::vector<std::int32_t> edges(static_cast<std::size_t>(block_.size[0] + 16));
    const std::int64_t runs = runKernels().edges(slab.row(row).bits, block_.size[0], edges.data());
    std::fill(out.begin(), out.end(), 0U);
    const auto piece = slab.piecesOfRow(row);
    for (std::int64_t i = 0; i < runs; ++i)
      std::fill(out.begin() + edges[static_cast<std::size_t>(2 * i)],
        out.begin() + edges[static_cast<std::size_t>(2 * i + 1)],
        offset + slab.ofBlock(piece[static_cast<std::size_t>(i)]) + 1);
  }

  void joint(std::vector<Joint>& joints, std::uint32_t a, std::uint32_t b, int x, int y, int z) const
  {
    const Joint found{ a, b,
      { static_cast<std::int8_t>(x), static_cast<std::int8_t>(y), static_cast<std::int8_t>(z) } };
    if (joints.empty() || joints.back() != found)
      joints.push_back(found);
  }

  /// Where the block's rows touch each other over the ends of x.
  void joinEnds(std::uint32_t offset, std::vector<Joint>& joints) const
  {
    if (!options_.periodic[0])
      return;
    const std::int64_t last = block_.size[0] - 1;
    const auto touch = [&](std::int64_t pieceA, std::int64_t pieceB, int x)
    {
      if (pieceA >= 0 && pieceB >= 0)
        joint(
          joints, offset + static_cast<std::uint32_t>(pieceA), offset + static_cast<std::uint32_t>(pieceB), x, 0, 0);
    };
    for (std::int64_t row = 0; row < rows(); ++row)
    {
      const Slab& slab = slabOf(row);
      const std::int64_t begin = slab.at(row, 0);
      const std::int64_t end = slab.at(row, last);
      touch(begin, end, -1);
      for (const Neighbour& n : near_)
        if (const std::int64_t other = n.diagonal ? inside(row, n) : -1; other >= 0)
        {
          const Slab& there = slabOf(other);
          touch(begin, there.at(other, last), -1);
          touch(end, there.at(other, 0), 1);
        }
    }
  }

  /// Where rows at the block's sides touch rows beyond: other ranks', or over the ends of y and z.
  void joinSides(std::uint32_t offset, std::vector<Joint>& joints) const
  {
    const bool wraps = options_.periodic[1] || (lattice_.dimension == 3 && options_.periodic[2]);
    if (!comm_.parallel() && !wraps)
      return;
    const Decomposition parts(lattice_, comm_);
    const Halo halo(lattice_.dimension, block_.size, parts, comm_, options_.periodic);
    const auto nx = static_cast<std::size_t>(block_.size[0]);
    const std::int64_t ny = block_.size[1];
    const std::int64_t nz = block_.size[2];
    // Rows of the outer layers, ours and those beyond, by their number in the halo.
    std::map<std::int64_t, std::vector<std::uint32_t>> layer;
    const auto rowAt = [&](std::int64_t y, std::int64_t z) -> std::vector<std::uint32_t>&
    {
      std::vector<std::uint32_t>& values = layer[halo.row(y, z)];
      if (values.empty())
      {
        values.assign(nx, 0);
        if (y >= 0 && y < ny && z >= 0 && z < nz)
          writeRow(y + ny * z, offset, values);
      }
      return values;
    };
    const std::int64_t ghost = lattice_.dimension == 3 ? 1 : 0;
    halo.exchange(
      [&](std::int64_t row)
      {
        const std::int64_t y = row % (ny + 2) - 1;
        const std::int64_t z = row / (ny + 2) - ghost;
        return Halo::Segment{ reinterpret_cast<std::byte*>(rowAt(y, z).data()), nx * sizeof(std::uint32_t) };
      });
    for (std::int64_t row = 0; row < rows(); ++row)
    {
      const auto [y, z] = place(row);
      for (const Neighbour& n : near_)
      {
        if (inside(row, n) >= 0)
          continue;
        std::array<int, 3> shift{ 0, 0, 0 };
        bool exists = true;
        const std::array<std::int64_t, 3> at{ 0, block_.start[1] + y + n.y, block_.start[2] + z + n.z };
        for (std::size_t axis = 1; axis < 3; ++axis)
        {
          shift[axis] = at[axis] < 0 ? -1 : at[axis] >= lattice_.size[axis] ? 1 : 0;
          exists = exists && (shift[axis] == 0 || options_.periodic[axis]);
        }
        if (exists)
          joinRows(rowAt(y, z), rowAt(y + n.y, z + n.z), n.diagonal, shift, joints);
      }
    }
  }

  /// @param a, b pieces by node, from 1; 0 outside
  void joinRows(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b, bool diagonal,
    const std::array<int, 3>& shift, std::vector<Joint>& joints) const
  {
    const auto n = static_cast<std::int64_t>(a.size());
    const int reach = diagonal ? 1 : 0;
    for (std::int64_t x = 0; x < n; ++x)
    {
      const std::uint32_t own = a[static_cast<std::size_t>(x)];
      if (own == 0)
        continue;
      for (int step = -reach; step <= reach; ++step)
      {
        const std::int64_t other = x + step;
        const int wrap = other < 0 ? -1 : other >= n ? 1 : 0;
        if (wrap != 0 && !options_.periodic[0])
          continue;
        if (const std::uint32_t piece = b[static_cast<std::size_t>(other - wrap * n)]; piece != 0)
          joint(joints, own - 1, piece - 1, wrap, shift[1], shift[2]);
      }
    }
  }

  /// From pieces of all blocks to pores: rank 0 puts them together and tells the others their labels.
  void joinAll()
  {
    constexpr std::int64_t room = std::numeric_limits<std::uint32_t>::max() - 1; // numbers of pieces, from 1
    const auto own = static_cast<std::int64_t>(pieces_.size());
    const std::int64_t all = comm_.sum(own);
    if (all > room || own > std::numeric_limits<std::int32_t>::max())
      refuse(all);
    const auto offset = static_cast<std::uint32_t>(comm_.sumBefore(own));
    std::vector<Joint> joints;
    joinEnds(offset, joints);
    joinSides(offset, joints);
    std::sort(joints.begin(), joints.end());
    joints.erase(std::unique(joints.begin(), joints.end()), joints.end());

    Merged merged;
    const std::vector<std::int64_t> counts = gather(comm_, pieces_);
    gather(comm_, joints);
    if (comm_.rank() == 0)
      merged = merge(lattice_, pieces_, joints, comm_.parallel(), options_);
    std::int64_t tooMany = merged.tooMany ? 1 : 0;
    broadcast(comm_, tooMany);
    broadcast(comm_, merged.summary);
    if (tooMany != 0)
      refuse(merged.summary.count);
    scatter(comm_, merged.label, counts, static_cast<std::size_t>(own), self_.labelOf_);
    scatter(comm_, merged.size, counts, static_cast<std::size_t>(own), self_.sizeOf_);
    self_.pores_ = std::move(merged.pores);
    self_.summary_ = merged.summary;
    pieces_ = {};
  }

  [[noreturn]] void refuse(std::int64_t count) const
  {
    throw InputError(fmt::format("there are {} pores; {} can be told apart by their labels", count,
                       std::min<std::int64_t>(options_.mostLabels, std::numeric_limits<std::int32_t>::max())),
      "give a minimum size, which leaves the smallest out, or cut out a part of the image");
  }

  PoreLabelling& self_;
  const Lattice& lattice_;
  const Block& block_;
  const Communicator& comm_;
  std::span<const std::uint8_t> phase_;
  std::uint8_t wanted_;
  const LabelOptions& options_;
  std::vector<Neighbour> near_;
  UnfilledVector<Piece> pieces_; ///< of the block; on rank 0, once gathered, of all
};

PoreLabelling::PoreLabelling(const Lattice& lattice, const Communicator& comm, std::span<const std::uint8_t> phase,
  std::uint8_t wanted, const LabelOptions& options)
  : rowLength_(lattice.size[0])
  , forEach_(options.forEach ? options.forEach : inTurn)
{
  if (!fits(options.connectivity, lattice.dimension))
    throw ParameterError(fmt::format("connectivity {} does not fit {}", options.connectivity,
                           lattice.dimension == 3 ? "a volume" : "a picture"),
      lattice.dimension == 3 ? "use 6 (faces), 18 (and edges) or 26 (and corners)"
                             : "use 4 (sides) or 8 (and corners)");
  if (options.minimumSize < 0)
    throw ParameterError(fmt::format("a minimum size of {} is below 0", options.minimumSize),
      "give the number of nodes that the smallest pore to keep has; 0 keeps all");
  const Block block = comm.parallel() ? Decomposition(lattice, comm).block() : Block{ { 0, 0, 0 }, lattice.size };
  Work(*this, lattice, block, comm, phase, wanted, options).run();
}

PoreLabelling::~PoreLabelling() = default;

void PoreLabelling::labels(std::span<std::int32_t> labels) const
{
  forEach_(static_cast<int>(slabs_.size()),
    [&](int i)
    {
      const Slab& slab = slabs_[static_cast<std::size_t>(i)];
      slab.fill<std::int32_t>(runKernels().fillLabels, labelOf_, 0, rowLength_, labels.data());
    });
}

void PoreLabelling::sizes(std::span<float> sizes) const
{
  std::vector<float> sizeOf(labelOf_.size());
  for (std::size_t i = 0; i < sizeOf.size(); ++i)
  {
    const auto place = static_cast<std::size_t>(labelOf_[i]) - 1;
    sizeOf[i] = labelOf_[i] == 0 ? std::numeric_limits<float>::quiet_NaN()
      : sizeOf_.empty()          ? static_cast<float>(pores_[place].size)
                                 : sizeOf_[i];
  }
  forEach_(static_cast<int>(slabs_.size()),
    [&](int i)
    {
      const Slab& slab = slabs_[static_cast<std::size_t>(i)];
      slab.fill<float>(
        runKernels().fillSizes, sizeOf, std::numeric_limits<float>::quiet_NaN(), rowLength_, sizes.data());
    });
}

std::optional<std::size_t> voidPhase(std::span<const std::string> names)
{
  for (const char* const known : { "void", "pore", "lumen", "air" })
  {
    const auto same = std::find_if(names.begin(), names.end(),
      [known](std::string name)
      {
        std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
        return name == known;
      });
    if (same != names.end())
      return static_cast<std::size_t>(same - names.begin());
  }
  return std::nullopt;
}

bool fits(int connectivity, int dimension) noexcept
{
  return dimension == 3 ? connectivity == 6 || connectivity == 18 || connectivity == 26
                        : connectivity == 4 || connectivity == 8;
}

} // namespace lamella::pores
