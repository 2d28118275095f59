#include "cracks/SurfaceSmoothing.h"

#include <Eigen/Geometry>
#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>

namespace lamella::cracks
{
namespace
{

constexpr double stiffest = 300; ///< λ at the beginning: stairs of up to some twenty spacings become one plane
constexpr double softer = 0.5;
constexpr int rounds = 10;
constexpr double slack = 0.2;    ///< by which the surface may miss a pair [spacings]
constexpr double loose = 0.1;    ///< weight of p₀ at a side of the lattice
constexpr double farthest = 0.9; ///< that a corner may move: half the diagonal of a voxel, and the slack

using Matrix = Eigen::SparseMatrix<double>;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// p − mean of its neighbours, a row a point; none where a point has no neighbours.
Matrix laplacian(const CrackSurface& surface)
{
  std::vector<Eigen::Triplet<double>> entries;
  const auto n = static_cast<Eigen::Index>(surface.points.size());
  for (std::size_t i = 0; i < surface.points.size(); ++i)
  {
    const std::int64_t first = surface.first[i];
    const std::int64_t count = surface.first[i + 1] - first;
    if (count == 0)
      continue;
    entries.emplace_back(i, i, 1.0);
    for (std::int64_t k = 0; k < count; ++k)
      entries.emplace_back(
        i, surface.neighbours[static_cast<std::size_t>(first + k)], -1.0 / static_cast<double>(count));
  }
  Matrix l(n, n);
  l.setFromTriplets(entries.begin(), entries.end());
  return l;
}

/// Does the plane of a face pass between its two nodes?
bool passes(const CrackFace& face, const Points& p)
{
  const auto at = [&](std::size_t k) -> Eigen::Vector3d { return p.row(static_cast<Eigen::Index>(face.corners[k])); };
  const Eigen::Vector3d normal = (at(2) - at(0)).cross(at(3) - at(1));
  const Eigen::Vector3d centre = 0.25 * (at(0) + at(1) + at(2) + at(3));
  Eigen::Vector3d middle(
    static_cast<double>(face.pair.x), static_cast<double>(face.pair.y), static_cast<double>(face.pair.z));
  middle[face.pair.axis] += 0.5;
  const double along = normal[face.pair.axis];
  return std::abs((centre - middle).dot(normal)) <= (0.5 + slack) * std::abs(along) + 1e-3 * normal.norm();
}

} // namespace

std::vector<std::array<double, 3>> smoothSurface(const CrackSurface& surface)
{
  const auto n = static_cast<Eigen::Index>(surface.points.size());
  if (n == 0)
    return {};
  Points start(n, 3);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index c = 0; c < 3; ++c)
      start(i, c) = surface.points[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
  const Matrix bend = laplacian(surface);
  const Matrix bendOf = bend.transpose(); // rows of points by column
  // Rims within are lines of their own, which the rest must not draw in. At a side of the lattice the surface goes on
  // straight for the last half spacing, and stays on the side.
  Points hold = Points::Ones(n, 3);
  Eigen::VectorXd lambda = Eigen::VectorXd::Constant(n, stiffest);
  for (Eigen::Index i = 0; i < n; ++i)
  {
    const unsigned sides = surface.onSides[static_cast<std::size_t>(i)];
    if (surface.onRim[static_cast<std::size_t>(i)] == 0)
      continue;
    if (sides == 0)
      lambda[i] *= stiffest;
    for (unsigned c = 0; c < 3; ++c)
      hold(i, c) = sides == 0 || (sides >> c & 1U) != 0 ? stiffest : loose;
  }
  Eigen::SimplicialLDLT<Matrix> solver;
  Points p(n, 3);
  for (int round = 0;; ++round)
  {
    const Matrix stiff = bendOf * lambda.asDiagonal() * bend;
    for (Eigen::Index c = 0; c < 3; ++c)
    {
      Matrix a = stiff;
      a += Matrix(Eigen::VectorXd(hold.col(c)).asDiagonal());
      if (round == 0 && c == 0)
        solver.analyzePattern(a);
      solver.factorize(a);
      const auto answer = [&](const Eigen::VectorXd& to) -> Eigen::VectorXd
      { return solver.solve(Eigen::VectorXd(hold.col(c).cwiseProduct(to))); };
      p.col(c) = answer(start.col(c));
      p.col(c) += answer(start.col(c) - p.col(c));
    }
    if (round == rounds)
      break;
    std::vector<char> wrong(static_cast<std::size_t>(n), 0);
    bool any = false;
    for (const CrackFace& face : surface.faces)
      if (!passes(face, p))
        for (const std::int64_t corner : face.corners)
          wrong[static_cast<std::size_t>(corner)] = 1;
    for (Eigen::Index i = 0; i < n; ++i)
      if ((p.row(i) - start.row(i)).norm() > farthest)
        wrong[static_cast<std::size_t>(i)] = 1;
    // the rows that such a point takes part in
    for (Eigen::Index i = 0; i < n; ++i)
    {
      bool soft = wrong[static_cast<std::size_t>(i)] != 0;
      for (std::int64_t k = surface.first[static_cast<std::size_t>(i)];
           k < surface.first[static_cast<std::size_t>(i) + 1]; ++k)
        soft = soft || wrong[static_cast<std::size_t>(surface.neighbours[static_cast<std::size_t>(k)])] != 0;
      if (soft)
        lambda[i] *= softer;
      any = any || soft;
    }
    if (!any)
      break;
  }
  std::vector<std::array<double, 3>> points(surface.points.size());
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index c = 0; c < 3; ++c)
      points[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)] = p(i, c);
  return points;
}

} // namespace lamella::cracks
