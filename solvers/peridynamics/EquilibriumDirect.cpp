// Equilibrium by sparse Cholesky: to check the others with.
#include "peridynamics/Equilibrium.h"

#include "core/Error.h"

#include <Eigen/SparseCholesky>

#include <fmt/format.h>

namespace lamella::peridynamics
{
namespace
{

constexpr std::int64_t directLimit = 200'000; // unknowns

} // namespace

void Equilibrium::solveDirectly(NodeField<double>& u, const NodeField<double>* load, EquilibriumResult& result)
{
  const NodeLayout& l = bonds_.layout();
  const int d = l.dimension;
  if (bonds_.communicator().parallel())
    throw ParameterError("the direct solver runs on one rank", "use the multigrid solver");
  std::vector<int> unknown(static_cast<std::size_t>(l.count() * d), -1);
  int n = 0;
  const auto number = [&](std::int64_t i, int c) -> int& { return unknown[static_cast<std::size_t>(i * d + c)]; };
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        if (bonds_.degree(i) > 0)
          for (int c = 0; c < d; ++c)
            if ((fixed_[i] >> c & 1U) == 0)
              number(i, c) = n++;
  if (n > directLimit)
    throw ParameterError(fmt::format("{} unknowns are too many for the direct solver (at most {})", n, directLimit),
      "use the multigrid solver");
  // nodes of the rim are images of own ones
  const auto own = [&](std::int64_t i)
  {
    std::array<std::int64_t, 3> x = l.node(i);
    for (std::size_t a = 0; a < 3; ++a)
      x[a] = ((x[a] % l.size[a]) + l.size[a]) % l.size[a];
    return l.index(x[0], x[1], x[2]);
  };
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::int64_t z = 0; z < l.size[2]; ++z)
    for (std::int64_t y = 0; y < l.size[1]; ++y)
      for (std::int64_t i = l.index(0, y, z); i < l.index(l.size[0], y, z); ++i)
        for (std::size_t o = 0; o < bonds_.stencil().half().size(); ++o)
        {
          const double k = bonds_.springConstant(i, static_cast<int>(o));
          if (k == 0)
            continue;
          const std::int64_t j = own(i + bonds_.jump(static_cast<int>(o)));
          const Offset& offset = bonds_.stencil().half()[o];
          for (int p = 0; p < d; ++p)
            for (int q = 0; q < d; ++q)
            {
              const double v = k * offset.step[static_cast<std::size_t>(p)] * offset.step[static_cast<std::size_t>(q)] /
                (offset.length * offset.length);
              const int ip = number(i, p);
              const int iq = number(i, q);
              const int jp = number(j, p);
              const int jq = number(j, q);
              if (ip >= 0 && iq >= 0)
                triplets.emplace_back(ip, iq, v);
              if (jp >= 0 && jq >= 0)
                triplets.emplace_back(jp, jq, v);
              if (ip >= 0 && jq >= 0)
                triplets.emplace_back(ip, jq, -v);
              if (jp >= 0 && iq >= 0)
                triplets.emplace_back(jp, iq, -v);
            }
        }
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(triplets.begin(), triplets.end());
  NodeField<double> r(l);
  residual(u, load, r, false);
  Eigen::VectorXd b(n);
  const auto each = [&](const auto& f)
  {
    for (std::int64_t i = 0; i < l.count(); ++i)
      for (int c = 0; c < d; ++c)
        if (number(i, c) >= 0)
          f(c, i, number(i, c));
  };
  each([&](int c, std::int64_t i, int k) { b[k] = r.component(c)[i]; });
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(a);
  if (factors.info() != Eigen::Success)
    throw DivergenceError("the stiffness matrix is singular", "use the multigrid solver, which can do with that");
  const Eigen::VectorXd x = factors.solve(b);
  each([&](int c, std::int64_t i, int k) { u.component(c)[i] += x[k]; });
  result.iterations = 1;
  residual(u, load, r, false);
  result.residual = norm(r) / forcing(u, load);
}

} // namespace lamella::peridynamics
