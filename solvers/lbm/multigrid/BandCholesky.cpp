#include "lbm/multigrid/BandCholesky.h"

namespace lamella::lbm
{

BandCholesky::BandCholesky(Eigen::Index size, Eigen::Index width)
  : band_(Eigen::MatrixXd::Zero(width + 1, size))
{
}

bool BandCholesky::factorize()
{
  for (Eigen::Index k = 0; k < band_.cols(); ++k)
  {
    if (!(band_(0, k) > 0))
      return false;
    const double inverse = 1 / band_(0, k);
    const Eigen::Index count = below(k);
    const auto column = band_.col(k).segment(1, count);
    for (Eigen::Index i = 0; i < count; ++i)
      if (column[i] != 0)
        band_.col(k + 1 + i).head(count - i) -= (column[i] * inverse) * column.tail(count - i);
  }
  return true;
}

void BandCholesky::solve(Eigen::Ref<Eigen::VectorXd> x) const
{
  for (Eigen::Index k = 0; k < band_.cols(); ++k)
  {
    const Eigen::Index count = below(k);
    x[k] /= band_(0, k);
    x.segment(k + 1, count) -= x[k] * band_.col(k).segment(1, count);
  }
  for (Eigen::Index k = band_.cols(); k-- > 0;)
  {
    const Eigen::Index count = below(k);
    x[k] -= band_.col(k).segment(1, count).dot(x.segment(k + 1, count)) / band_(0, k);
  }
}

} // namespace lamella::lbm
