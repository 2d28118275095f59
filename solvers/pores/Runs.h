#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

/// Runs of pixels along x: the rows' arithmetic under PoreLabelling, compiled once for every instruction set.
///
/// A row is kept as one bit a node, in words of 64, and beside each word stands how many runs of the slab begin before
/// it. So the number of the run at a node is that count and the set bits of "begins here" up to the node, and which
/// runs of two rows touch is found by logic on whole words: nothing is visited a node at a time.
namespace lamella::pores
{

/// One row: `words` words each.
struct Row
{
  const std::uint64_t* bits;   ///< node x is bit x % 64 of word x / 64; 0 beyond the row
  const std::uint32_t* before; ///< runs of the slab that begin before this word
};

/// What is known of a set of nodes that hang together, or of a part of one. All sums are whole numbers, so that it
/// does not matter in which order parts are put together.
struct alignas(64) Piece
{
  std::int64_t size;   ///< nodes
  std::int64_t twiceX; ///< twice the sum of the nodes' x
  std::int64_t sumY;
  std::int64_t sumZ;
  std::array<std::int32_t, 3> low; ///< the box, in nodes of the whole lattice, both ends included
  std::array<std::int32_t, 3> high;
  std::int64_t first; ///< lowest index in the whole lattice
};
static_assert(sizeof(Piece) == 64, "one cache line; also what ranks send each other");

/// Two runs that touch.
struct Contact
{
  std::uint32_t a;
  std::uint32_t b;
};

struct RunKernels
{
  /// Bits and counts of a row of bytes.
  /// @param readable bytes that may be read from `phase` on, at least `nodes`
  /// @param runs of the slab so far
  /// @returns runs with this row's
  std::uint32_t (*scan)(const std::uint8_t* phase, std::int64_t nodes, std::int64_t readable, std::uint8_t wanted,
    std::uint64_t* bits, std::uint32_t* before, std::uint32_t runs);
  /// Unites the runs of two rows of one slab that touch. @param parent by run, never above the run itself
  void (*unite)(Row a, Row b, std::int64_t words, bool diagonal, std::uint32_t* parent);
  /// Lists the runs of two rows that touch. @param contacts room for 64 · words @returns how many
  std::int64_t (*contacts)(Row a, Row b, std::int64_t words, bool diagonal, Contact* contacts);
  /// Where the runs of a row begin and end, in turn. @param edges room for nodes + 16 @returns runs
  std::int64_t (*edges)(const std::uint64_t* bits, std::int64_t nodes, std::int32_t* edges);
  /// Adds a row's runs to the pieces they belong to. Pieces are numbered by their first runs, so that those from
  /// `known` on are new and begin here, whatever was in their place.
  /// @param piece by run of this row
  /// @param index of the row's first node in the whole lattice, (y, z) its place there
  /// @param pieces, sizes (the pieces' sizes once more) room for one more than there are
  /// @returns the pieces known now
  std::uint32_t (*measure)(const std::int32_t* edges, std::int64_t runs, const std::uint32_t* piece,
    std::uint32_t known, std::int64_t index, std::int32_t y, std::int32_t z, Piece* pieces, std::uint32_t* sizes);
  /// Writes value[piece] into the nodes of each run and `background` between them.
  /// @param room values that may be written from `out` on, at least `nodes`; those beyond the row are spoilt
  void (*fillLabels)(const std::int32_t* edges, std::int64_t runs, const std::uint32_t* piece,
    const std::int32_t* value, std::int32_t background, std::int32_t* out, std::int64_t nodes, std::int64_t room);
  void (*fillSizes)(const std::int32_t* edges, std::int64_t runs, const std::uint32_t* piece, const float* value,
    float background, float* out, std::int64_t nodes, std::int64_t room);
};

/// The fastest that this processor runs; all give the same numbers.
[[nodiscard]] const RunKernels& runKernels();

} // namespace lamella::pores
