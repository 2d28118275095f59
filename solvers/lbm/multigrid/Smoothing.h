#pragma once

#include "lbm/multigrid/Kernels.h"
#include "lbm/multigrid/Level.h"

#include <cstdint>
#include <functional>

namespace lamella::lbm
{

/// Links of the nodes of one parity in one row, and the neighbours at their other ends: 2 × directions of each, as the
/// kernels take them.
struct RowStencil
{
  int count;
  const float* link[2 * maxForward];
  const float* value[2 * maxForward];

  /// @param values  an array on the level's layout, or null when only links are wanted
  RowStencil(const Level& level, const float* values, std::int64_t y, std::int64_t z, int part);
};

/// Does another rank, or the other end of a periodic box, lie beyond this block along `axis`?
[[nodiscard]] bool touching(const Level& level, int axis);

/// Called for a layer of nodes (a plane; in 2D a row).
using LayerHook = std::function<void(std::int64_t)>;

/// A red–black sweep over a level with straight links in one pass over memory: the second colour follows a layer behind
/// the first, so that data is still in cache; and what comes before and after can be done layer by layer too. Where
/// blocks touch, outer layers come first and are exchanged. The numbers are those of colour after colour.
class LayerSweep
{
public:
  /// @param prepare  called, before a layer's first colour, for it and its neighbours; may be called again for a layer
  LayerSweep(const Level& level, const FloatArray& f, FloatArray& u, bool forward, bool fromZero,
    LayerHook prepare = LayerHook());
  /// Makes all layers up to this one final; the ghosts are final from the beginning.
  void finish(std::int64_t layer);
  /// One thread, and no neighbours but in layers.
  [[nodiscard]] static bool possible(const Level& level, int threads);

private:
  [[nodiscard]] bool early(std::int64_t layer) const;
  void exchange();
  void prepareAround(std::int64_t layer);
  void relax(std::int64_t layer, int pass);

  const Level& level_;
  const FloatArray& f_;
  FloatArray& u_;
  std::int64_t layers_;
  bool forward_;
  bool fromZero_;
  bool touching_;
  LayerHook prepare_;
  std::int64_t first_ = 0;
  std::int64_t second_ = 0;
};

/// One Gauss–Seidel sweep over all colours, ghosts exchanged. From zero: u need not be set.
void relax(const Level& level, const FloatArray& f, FloatArray& u, bool forward, bool fromZero, int threads);
/// f − A u of a row, split by parity like all rows. After a forward sweep one colour's is known to be zero.
void residualRow(const Level& level, const FloatArray& f, const FloatArray& u, std::int64_t y, std::int64_t z,
  float* out, bool afterForwardSweep);
/// q = A p on a row; returns p·q.
double applyRow(const Level& level, const FloatArray& p, FloatArray& q, std::int64_t y, std::int64_t z);
/// 1 / Σ links of every node, for levels whose links are not straight.
void computeInverse(Level& level);

} // namespace lamella::lbm
