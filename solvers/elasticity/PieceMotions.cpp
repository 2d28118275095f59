#include "elasticity/PieceMotions.h"

#include "core/Communicator.h"
#include "pores/PoreLabelling.h"

#include <algorithm>
#include <cmath>

namespace lamella::elasticity
{
namespace
{

// Copies of a periodic box in one number, 10 bits an axis; 0: none is told.
constexpr std::int32_t imageStep(int axis)
{
  return 1 << (10 * axis);
}
constexpr std::int32_t firstImage = 512 * (imageStep(0) + imageStep(1) + imageStep(2));
constexpr int imageOf(std::int32_t code, int axis)
{
  return (code >> (10 * axis) & 1023) - 512;
}

} // namespace

template <int D>
typename PieceMotions<D>::Affine PieceMotions<D>::affineOf(const Motions& rigid)
{
  Affine a;
  a.shift = rigid.template head<D>();
  if constexpr (D == 2)
  {
    a.slope(0, 1) = -rigid(2);
    a.slope(1, 0) = rigid(2);
  }
  else
    for (int k = 0; k < 3; ++k)
    {
      a.slope((k + 1) % 3, (k + 2) % 3) = -rigid(3 + k);
      a.slope((k + 2) % 3, (k + 1) % 3) = rigid(3 + k);
    }
  return a;
}

template <int D>
typename PieceMotions<D>::Motions PieceMotions<D>::workOf(const Affine& forces)
{
  Motions m;
  m.template head<D>() = forces.shift;
  if constexpr (D == 2)
    m(2) = forces.slope(1, 0) - forces.slope(0, 1);
  else
    for (int k = 0; k < 3; ++k)
      m(3 + k) = forces.slope((k + 2) % 3, (k + 1) % 3) - forces.slope((k + 1) % 3, (k + 2) % 3);
  return m;
}

template <int D>
PieceMotions<D>::PieceMotions(const ElasticGrid<D>& grid, std::span<const std::uint8_t> phase,
  const std::vector<bool>& chosen, std::int64_t leastVoxels, std::size_t mostPieces)
  : grid_(grid)
{
  std::array<std::int64_t, 3> size{ 1, 1, 1 };
  std::copy(grid_.elements.begin(), grid_.elements.end(), size.begin());
  for (std::size_t a = 0; a < D; ++a)
    edge_[a] = static_cast<double>(grid_.widthOf(static_cast<int>(a), 0));
  std::vector<std::uint8_t> mask(phase.size());
  for (std::size_t i = 0; i < phase.size(); ++i)
    mask[i] = chosen[phase[i]] ? 1 : 0;
  pores::LabelOptions options;
  options.connectivity = D == 3 ? 26 : 8;
  for (std::size_t a = 0; a < D; ++a)
    options.periodic[a] = grid_.periodic[a];
  options.minimumSize = leastVoxels;
  const Communicator alone;
  const pores::PoreLabelling labelling(makeLattice(size[0], size[1], size[2], D, 1.0), alone, mask, 1, options);
  mask = {};
  for (const pores::Pore& found : labelling.pores().first(std::min(mostPieces, labelling.pores().size())))
  {
    Piece& piece = pieces_.emplace_back();
    piece.endless = found.percolates != 0;
    for (std::size_t a = 0; a < D; ++a)
    {
      piece.low[a] = found.low[a];
      piece.centre[a] = 0.5 * edge_[a] * (found.high[a] - found.low[a] + 1);
      for (const int side : { 0, 1 })
        piece.held = piece.held ||
          ((found.touches >> (2 * a + static_cast<std::size_t>(side)) & 1) != 0 && !grid_.periodic[a] &&
            std::ranges::any_of(grid_.held[a], [](bool h) { return h; }));
      piece.endless = piece.endless && !piece.held;
    }
  }
  std::vector<std::int32_t> labels(phase.size());
  labelling.labels(labels);
  Images images;
  labelImages(images, labels);
  const std::int64_t nx = grid_.nodes(0);
  std::vector<std::int32_t> owner(static_cast<std::size_t>(nx));
  std::vector<std::int32_t> image(static_cast<std::size_t>(nx));
  begin_.push_back(0);
  for (std::int64_t k = 0; k < grid_.planes(); ++k)
    for (std::int64_t j = 0; j < grid_.rows(); ++j)
    {
      // a node belongs to the piece of any voxel around it
      std::ranges::fill(owner, -1);
      for (int side = 0; side < corners / 2; ++side)
      {
        const auto beside = [](std::int64_t node, int lower, std::int64_t count, bool around) -> std::int64_t
        {
          const std::int64_t e = node - lower;
          return e < 0 ? (around ? count - 1 : -1) : e < count ? e : -1;
        };
        const std::int64_t row = D == 3 ? beside(j, side & 1, grid_.elements[1], grid_.periodic[1]) : 0;
        const std::int64_t plane = beside(k, D == 3 ? side >> 1 : side, grid_.elements[D - 1], grid_.periodic[D - 1]);
        if (row < 0 || plane < 0)
          continue;
        const std::int64_t begin = grid_.elements[0] * (row + grid_.elementRows() * plane);
        const std::int32_t* const from = labels.data() + begin;
        for (std::int64_t i = 0; i < grid_.elements[0]; ++i)
        {
          if (from[i] <= 0 || static_cast<std::size_t>(from[i]) > pieces_.size())
            continue;
          const std::int64_t next = i + 1 == nx ? 0 : i + 1;
          owner[static_cast<std::size_t>(i)] = owner[static_cast<std::size_t>(next)] = from[i] - 1;
          if (images.code.empty() || !images.along[static_cast<std::size_t>(from[i] - 1)])
            continue;
          // a first node that is its upper one is a node of the next copy
          std::int32_t code = images.code[static_cast<std::size_t>(begin + i)];
          if (D == 3 && row > j)
            code += imageStep(1);
          if (plane > k)
            code += imageStep(D - 1);
          image[static_cast<std::size_t>(i)] = code;
          image[static_cast<std::size_t>(next)] = code + (next == 0 ? imageStep(0) : 0);
        }
      }
      for (int c = 0; c < D; ++c)
        grid_.forHeld(j, k, c,
          [&](std::int64_t first, std::int64_t count)
          {
            for (std::int64_t i = first; i < std::min(first + count, nx); ++i)
              owner[static_cast<std::size_t>(i)] = -1;
          });
      for (std::int64_t i = 0; i < nx; ++i)
      {
        const std::int32_t o = owner[static_cast<std::size_t>(i)];
        if (o < 0)
          continue;
        const bool several = !images.code.empty() && images.along[static_cast<std::size_t>(o)];
        const bool goesOn = i > 0 && owner[static_cast<std::size_t>(i - 1)] == o &&
          (several ? image[static_cast<std::size_t>(i)] == image[static_cast<std::size_t>(i - 1)]
                   : static_cast<double>(i) != pieces_[static_cast<std::size_t>(o)].low[0]);
        if (!goesOn)
        {
          runs_.push_back({ o, static_cast<std::int32_t>(i), 0, 0 });
          if (!images.code.empty())
            images_.push_back(several ? image[static_cast<std::size_t>(i)] : 0);
        }
        ++runs_.back().count;
      }
      begin_.push_back(runs_.size());
    }
  lists_.resize(static_cast<std::size_t>(grid_.planes()));
  std::vector<std::int32_t> place(pieces_.size(), -1);
  for (std::size_t plane = 0; plane < lists_.size(); ++plane)
  {
    const auto rows = static_cast<std::size_t>(grid_.rows());
    for (std::size_t r = begin_[plane * rows]; r < begin_[(plane + 1) * rows]; ++r)
    {
      std::int32_t& local = place[static_cast<std::size_t>(runs_[r].piece)];
      if (local < 0)
      {
        local = static_cast<std::int32_t>(lists_[plane].size());
        lists_[plane].push_back(runs_[r].piece);
      }
      runs_[r].local = local;
    }
    for (const std::int32_t piece : lists_[plane])
      place[static_cast<std::size_t>(piece)] = -1;
  }
}

template <int D>
void PieceMotions<D>::labelImages(Images& images, std::span<const std::int32_t> labels)
{
  images.along.assign(pieces_.size(), false);
  bool any = false;
  for (std::size_t p = 0; p < pieces_.size(); ++p)
    for (std::size_t a = 0; a < D && !pieces_[p].endless; ++a)
      if (grid_.periodic[a] && 2 * pieces_[p].centre[a] >= edge_[a] * static_cast<double>(grid_.elements[a]))
        images.along[p] = any = true;
  if (!any)
    return;
  images.code.assign(labels.size(), 0);
  std::vector<std::array<std::int64_t, D>> low(pieces_.size());
  std::vector<std::array<std::int64_t, D>> high(pieces_.size());
  std::vector<std::int64_t> open;
  for (std::size_t first = 0; first < labels.size(); ++first)
  {
    const std::int32_t label = labels[first];
    const auto p = static_cast<std::size_t>(label - 1);
    if (label <= 0 || p >= pieces_.size() || !images.along[p] || images.code[first] != 0)
      continue;
    low[p].fill(std::numeric_limits<std::int64_t>::max());
    high[p].fill(std::numeric_limits<std::int64_t>::min());
    images.code[first] = firstImage;
    open.assign(1, static_cast<std::int64_t>(first));
    while (!open.empty())
    {
      const std::int64_t at = open.back();
      open.pop_back();
      std::array<std::int64_t, D> voxel{};
      std::int64_t rest = at;
      for (std::size_t a = 0; a < D; ++a)
      {
        voxel[a] = rest % grid_.elements[a];
        rest /= grid_.elements[a];
        const std::int64_t place =
          voxel[a] + grid_.elements[a] * imageOf(images.code[static_cast<std::size_t>(at)], static_cast<int>(a));
        low[p][a] = std::min(low[p][a], place);
        high[p][a] = std::max(high[p][a], place);
      }
      for (int k = 0; k < (D == 3 ? 27 : 9); ++k)
      {
        std::int32_t code = images.code[static_cast<std::size_t>(at)];
        std::int64_t to = 0;
        std::int64_t stride = 1;
        bool outside = false;
        for (int a = 0, digits = k; a < D; ++a, digits /= 3)
        {
          const std::int64_t n = grid_.elements[static_cast<std::size_t>(a)];
          std::int64_t v = voxel[static_cast<std::size_t>(a)] + digits % 3 - 1;
          const int beyond = v < 0 ? -1 : v == n ? 1 : 0;
          outside = outside || (beyond != 0 && !grid_.periodic[static_cast<std::size_t>(a)]);
          v -= beyond * n;
          code += beyond * imageStep(a);
          to += stride * v;
          stride *= n;
        }
        if (outside || labels[static_cast<std::size_t>(to)] != label || images.code[static_cast<std::size_t>(to)] != 0)
          continue;
        images.code[static_cast<std::size_t>(to)] = code;
        open.push_back(to);
      }
    }
    for (std::size_t a = 0; a < D; ++a)
    {
      pieces_[p].low[a] = static_cast<double>(low[p][a]);
      pieces_[p].centre[a] = 0.5 * edge_[a] * static_cast<double>(high[p][a] - low[p][a] + 1);
    }
  }
}

template <int D>
std::size_t PieceMotions<D>::bytes() const noexcept
{
  return runs_.size() * sizeof(Run) + images_.size() * sizeof(images_[0]) + begin_.size() * sizeof(begin_[0]) +
    pieces_.size() * sizeof(Piece);
}

template <int D>
Eigen::Matrix<double, D, 1> PieceMotions<D>::fromCentre(
  std::int32_t owner, const std::array<std::int64_t, D>& node) const
{
  const auto run = static_cast<std::size_t>(owner);
  const Piece& piece = pieces_[static_cast<std::size_t>(runs_[run].piece)];
  const std::int32_t image = images_.empty() ? 0 : images_[run];
  Eigen::Matrix<double, D, 1> d;
  for (std::size_t a = 0; a < D; ++a)
  {
    double n = static_cast<double>(node[a]) - piece.low[a];
    if (image != 0 || (n < 0 && grid_.periodic[a]))
      n += static_cast<double>(grid_.elements[a]) * (image == 0 ? 1 : imageOf(image, static_cast<int>(a)));
    d(static_cast<Eigen::Index>(a)) = n * edge_[a] - piece.centre[a];
  }
  return d;
}

// f(run, its first value among one component's, d of its first node)
template <int D>
template <class F>
void PieceMotions<D>::forRuns(std::int64_t plane, F&& f) const
{
  for (std::int64_t j = 0; j < grid_.rows(); ++j)
    forRunsOfRow(j, plane, f);
}

template <int D>
template <class F>
void PieceMotions<D>::forRunsOfRow(std::int64_t j, std::int64_t plane, F&& f) const
{
  const auto row = static_cast<std::size_t>(j + grid_.rows() * plane);
  for (std::size_t r = begin_[row]; r < begin_[row + 1]; ++r)
  {
    const Run& run = runs_[r];
    std::array<std::int64_t, D> node{};
    node[0] = run.first;
    node[D - 1] = plane;
    if constexpr (D == 3)
      node[1] = j;
    f(run, grid_.at(j, plane) + run.first, fromCentre(static_cast<std::int32_t>(r), node));
  }
}

template <int D>
template <class Real>
void PieceMotions<D>::addMoments(
  const Run& run, const Eigen::Matrix<double, D, 1>& d, const std::array<const Real*, D>& forces, Affine& sum) const
{
  for (int c = 0; c < D; ++c)
  {
    const Real* const f = forces[static_cast<std::size_t>(c)];
    double whole = 0;
    double along = 0;
    for (std::int32_t i = 0; i < run.count; ++i)
    {
      whole += static_cast<double>(f[i]);
      along += static_cast<double>(i) * static_cast<double>(f[i]);
    }
    sum.shift(c) += whole;
    sum.slope.row(c) += whole * d.transpose();
    sum.slope(c, 0) += edge_[0] * along;
  }
}

template <int D>
PieceMotions<D>::Sums::Sums(const PieceMotions& pieces)
  : pieces_(pieces)
{
  for (const auto& list : pieces.lists_)
    planes_.emplace_back(list.size());
}

template <int D>
void PieceMotions<D>::Sums::add(std::int64_t row, std::int64_t plane, const float* const* forces)
{
  pieces_.forRunsOfRow(
    row, plane,
    [&](const Run& run, std::int64_t, const Eigen::Matrix<double, D, 1>& d)
    {
      std::array<const float*, D> f{};
      for (std::size_t c = 0; c < D; ++c)
        f[c] = forces[c] + run.first;
      pieces_.addMoments(run, d, f, planes_[static_cast<std::size_t>(plane)][static_cast<std::size_t>(run.local)]);
    });
}

template <int D>
std::vector<typename PieceMotions<D>::Affine> PieceMotions<D>::Sums::total() const
{
  std::vector<Affine> sums(pieces_.pieces_.size());
  pieces_.grid_.parts.inOrder(std::as_writable_bytes(std::span(sums)),
    [&]
    {
      for (std::size_t plane = 0; plane < planes_.size(); ++plane) // others' planes have no forces
        for (std::size_t i = 0; i < planes_[plane].size(); ++i)
        {
          Affine& sum = sums[static_cast<std::size_t>(pieces_.lists_[plane][i])];
          sum.shift += planes_[plane][i].shift;
          sum.slope += planes_[plane][i].slope;
        }
    });
  return sums;
}

template <int D>
template <class Real>
std::vector<typename PieceMotions<D>::Affine> PieceMotions<D>::moments(const Real* forces) const
{
  std::vector<Affine> sums(pieces_.size());
  grid_.parts.inOrder(std::as_writable_bytes(std::span(sums)),
    [&]
    {
      for (std::int64_t k = grid_.first(); k < grid_.last(); ++k)
        forRuns(k,
          [&](const Run& run, std::int64_t at, const Eigen::Matrix<double, D, 1>& d)
          {
            std::array<const Real*, D> f{};
            for (int c = 0; c < D; ++c)
              f[static_cast<std::size_t>(c)] = forces + c * grid_.componentStride() + at;
            addMoments(run, d, f, sums[static_cast<std::size_t>(run.piece)]);
          });
    });
  return sums;
}

template <int D>
std::vector<typename PieceMotions<D>::Inertia> PieceMotions<D>::inertia() const
{
  std::vector<Inertia> sums(pieces_.size());
  for (std::int64_t k = 0; k < grid_.planes(); ++k)
    forRuns(k,
      [&](const Run& run, std::int64_t, Eigen::Matrix<double, D, 1> d)
      {
        Inertia& sum = sums[static_cast<std::size_t>(run.piece)];
        for (std::int32_t i = 0; i < run.count; ++i, d(0) += edge_[0])
        {
          sum.nodes += 1;
          sum.first += d;
          sum.second += d * d.transpose();
        }
      });
  return sums;
}

template <int D>
template <class Real>
void PieceMotions<D>::place(std::span<const Affine> motion, bool add, int threads, Real* u) const
{
#pragma omp parallel for num_threads(threads) if (threads > 1) schedule(static)
  for (std::int64_t k = grid_.first(); k < grid_.last(); ++k)
    forRuns(k,
      [&](const Run& run, std::int64_t at, const Eigen::Matrix<double, D, 1>& d)
      {
        const Affine& m = motion[static_cast<std::size_t>(run.piece)];
        const Eigen::Matrix<double, D, 1> first = m.shift + m.slope * d;
        for (int c = 0; c < D; ++c)
        {
          Real* const out = u + c * grid_.componentStride() + at;
          const double step = m.slope(c, 0) * edge_[0];
          for (std::int32_t i = 0; i < run.count; ++i)
            out[i] = static_cast<Real>((add ? static_cast<double>(out[i]) : 0.0) + first(c) + step * i);
          if (run.first == 0 && grid_.periodic[0]) // the first node's copy
            out[grid_.elements[0]] = out[0];
        }
      });
}

template <int D>
std::vector<std::int32_t> PieceMotions<D>::owners() const
{
  std::vector<std::int32_t> owner(static_cast<std::size_t>(grid_.ownNodes()), -1);
  for (std::size_t row = 0; row + 1 < begin_.size(); ++row)
    for (std::size_t r = begin_[row]; r < begin_[row + 1]; ++r)
      std::fill_n(owner.begin() + static_cast<std::int64_t>(row) * grid_.nodes(0) + runs_[r].first, runs_[r].count,
        static_cast<std::int32_t>(r));
  return owner;
}

template class PieceMotions<2>;
template class PieceMotions<3>;
template std::vector<PieceMotions<2>::Affine> PieceMotions<2>::moments(const double*) const;
template std::vector<PieceMotions<3>::Affine> PieceMotions<3>::moments(const double*) const;
template std::vector<PieceMotions<2>::Affine> PieceMotions<2>::moments(const float*) const;
template std::vector<PieceMotions<3>::Affine> PieceMotions<3>::moments(const float*) const;
template void PieceMotions<2>::place(std::span<const Affine>, bool, int, float*) const;
template void PieceMotions<3>::place(std::span<const Affine>, bool, int, float*) const;
template void PieceMotions<2>::place(std::span<const Affine>, bool, int, double*) const;
template void PieceMotions<3>::place(std::span<const Affine>, bool, int, double*) const;

} // namespace lamella::elasticity
