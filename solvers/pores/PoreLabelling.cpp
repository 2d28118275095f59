#include "pores/PoreLabelling.h"

#include "core/Error.h"
#include "core/Lower.h"
#include "core/Passes.h"
#include "pores/Forest.h"
#include "pores/Gathering.h"
#include "pores/Merging.h"
#include "pores/Seams.h"
#include "pores/Slab.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numeric>
#include <utility>

namespace lamella::pores
{
namespace
{

const ForEach inTurn = [](int count, const std::function<void(int)>& body)
{
  for (int i = 0; i < count; ++i)
    body(i);
};

} // namespace

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
    , rows_{ block.size[1], block.size[2] }
  {
  }

  void run()
  {
    cut();
    self_.forEach_(static_cast<int>(self_.slabs_.size()),
      [this](int i)
      { self_.slabs_[static_cast<std::size_t>(i)].label(lattice_, block_.start, rows_, phase_, wanted_, near_); });
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

  void cut()
  {
    // Numbers of runs are 32 bits wide: slabs of at most 2³¹ nodes.
    const std::int64_t least = block_.count() / (std::int64_t{ 1 } << 31) + 1;
    const std::int64_t count =
      std::clamp<std::int64_t>(std::max<std::int64_t>(options_.slabs, least), 1, rows_.count());
    self_.slabs_.resize(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i)
    {
      Slab& slab = self_.slabs_[static_cast<std::size_t>(i)];
      slab.firstRow = rows_.count() * i / count;
      slab.rows = rows_.count() * (i + 1) / count - slab.firstRow;
      slab.words = (block_.size[0] + 63) / 64;
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
      sizes_ = std::move(self_.slabs_.front().sizes);
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
          const std::int64_t other = rows_.inside(row, n);
          if (other < 0 || other >= slab.firstRow)
            continue;
          const Slab& there = slabOf(self_.slabs_, other);
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
    pieces_.assign(numberRoots(parent), emptyPiece());
    for (std::size_t s = 0; s < self_.slabs_.size(); ++s)
    {
      Slab& slab = self_.slabs_[s];
      slab.blockPiece.assign(parent.begin() + before[s], parent.begin() + before[s + 1]);
      for (std::uint32_t i = 0; i < slab.count; ++i)
        add(pieces_[slab.blockPiece[i]], slab.pieces[i]);
      slab.pieces = {};
      slab.sizes = {};
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
    std::vector<Joint> joints = Seams(lattice_, block_, comm_, options_, self_.slabs_, near_, offset).joints();

    Merged merged;
    const std::vector<std::int64_t> counts = gather(comm_, pieces_);
    gather(comm_, joints);
    if (comm_.rank() == 0)
      merged = merge(lattice_, pieces_, sizes_, joints, comm_.parallel(), options_);
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
    sizes_ = {};
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
  Rows rows_;
  UnfilledVector<Piece> pieces_;        ///< of the block; on rank 0, once gathered, of all
  UnfilledVector<std::uint32_t> sizes_; ///< of these; empty with several slabs
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
  countPass(Pass::Labels);
  forEach_(static_cast<int>(slabs_.size()),
    [&](int i)
    {
      const Slab& slab = slabs_[static_cast<std::size_t>(i)];
      slab.fill(labelOf_, 0, rowLength_, labels.data());
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
      slab.fill(sizeOf, std::numeric_limits<float>::quiet_NaN(), rowLength_, sizes.data());
    });
}

std::optional<std::size_t> voidPhase(std::span<const std::string> names)
{
  for (const char* const known : { "void", "pore", "lumen", "air" })
  {
    const auto same =
      std::find_if(names.begin(), names.end(), [known](const std::string& name) { return lower(name) == known; });
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
