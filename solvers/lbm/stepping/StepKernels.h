#pragma once

#include <cstdint>

/// The loops of lattice Boltzmann stepping, compiled once for every instruction set and chosen at run time. Double
/// precision, structure of arrays, in place.
///
/// Every population has a slot. In an even step a node reads the populations that have arrived in its own slots and
/// leaves there, in the slot of the opposite direction, those that depart; in an odd step it reads and writes where its
/// neighbours left theirs (Bailey et al., ICPP 2009: the AA pattern). So one lattice does, nothing is copied, and a
/// pair of steps needs each slot once from memory when the odd step follows the even one while the rows are in cache.
/// With two relaxation times and Λ⁺Λ⁻ = ¼ the two rates add up to 2, and a departing population is
/// (1 − s) × the one that arrived from where it goes to, plus s w u: it takes the very slot that was read.
///
/// No standard library type crosses this interface or appears in the implementation: a template instantiated there
/// with wide instructions could be picked by the linker for the whole program.
namespace lamella::lbm
{

/// Largest number of populations.
inline constexpr int maxPopulations = 19;

/// What is done, besides colliding, at nodes where the box ends.
struct SlotPattern
{
  std::uint8_t slot[maxPopulations];   ///< odd steps: direction whose slot of the source node is read
  bool special;                        ///< false: nothing of what follows
  double sign[maxPopulations];         ///< odd steps: arriving = sign × slot + shift (faces half-way, mean gradients)
  double shift[maxPopulations];        ///<
  std::uint8_t mirror[maxPopulations]; ///< population that is taken instead (mirrors on the nodes)
  bool fixed[maxPopulations];          ///< unknown: so chosen that the node takes `value` (faces on the nodes)
  double value;                        ///<
  double share;                        ///< 1 / Σ w of the unknown ones; 0: there are none
};

/// Consecutive nodes of a row whose populations come from consecutive places.
struct SlotRun
{
  std::int32_t first;
  std::int32_t count;
  std::int32_t pattern;
  std::uint32_t own; ///< bit q: population q comes back from the node itself (void or wall beyond), from its slot q
};

/// What the loops work on.
struct SlotArrays
{
  double* f;                  ///< population q of node i at f[q × stride + i]
  std::int64_t stride;        ///<
  const std::uint8_t* phase;  ///< of the stored nodes
  const double* rate;         ///< 256 relaxation rates s, one a phase id
  bool fewPhases;             ///< no id above 7 occurs
  const SlotPattern* pattern; ///<
  const std::int32_t* source; ///< of each run: the nodes that the moving populations of its first node come from
};

/// One collision model on one lattice. Each returns Σ u² over its nodes, not finite when one is not.
struct StepLoops
{
  int populations; ///< that are stored: D3Q7's at rest has weight 0 and stays empty
  /// Even step of nodes first … first + count − 1.
  double (*even)(const SlotArrays& a, std::int64_t first, std::int64_t count);
  /// Even step of some runs, mirrors and fixed values included.
  double (*evenRuns)(const SlotArrays& a, const SlotRun* runs, std::int64_t count);
  /// Odd step of some runs; `number` is that of the first.
  double (*oddRuns)(const SlotArrays& a, const SlotRun* runs, std::int64_t number, std::int64_t count);
};

struct StepKernels
{
  /// [0: one rate (BGK), 1: two rates, Λ⁺Λ⁻ = ¼][D2Q5, D2Q9, D3Q7, D3Q19]
  StepLoops loops[2][4];
  const char* name; ///< of the instruction set
};

/// The fastest set that this processor can run.
[[nodiscard]] const StepKernels& stepKernels();

} // namespace lamella::lbm
