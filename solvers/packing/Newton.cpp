#include "packing/Relaxation.h"

#include "lattice/Error.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lamella::packing
{
namespace
{

/// Unknowns: Dim a grain, then the logarithms of the box's edges (one for all with BoxMotion::Volume).
template <int Dim>
class Enthalpy
{
public:
  using Vec = typename GrainSystem<Dim>::Vec;
  using Matrix = Eigen::SparseMatrix<double>;

  Enthalpy(GrainSystem<Dim>& grains, const RelaxationOptions& options)
    : g_(grains)
    , options_(options)
    , boxUnknowns_(options.box == BoxMotion::Fixed ? 0
          : options.box == BoxMotion::Volume       ? 1
                                                   : Dim)
  {
  }

  [[nodiscard]] Eigen::Index size() const { return Dim * static_cast<Eigen::Index>(g_.count()) + boxUnknowns_; }

  double value()
  {
    g_.computeForces(0);
    return g_.energy + (boxUnknowns_ > 0 ? options_.pressure * g_.volume() : 0);
  }

  /// Downhill; computeForces() has been called.
  [[nodiscard]] Eigen::VectorXd force() const
  {
    Eigen::VectorXd f(size());
    for (std::size_t i = 0; i < g_.count(); ++i)
      f.template segment<Dim>(Dim * static_cast<Eigen::Index>(i)) = g_.force[i];
    const Vec onBox = g_.virial.array() - options_.pressure * g_.volume();
    if (boxUnknowns_ == 1)
      f[size() - 1] = onBox.sum();
    else if (boxUnknowns_ == Dim)
      f.template tail<Dim>() = onBox;
    return f;
  }

  [[nodiscard]] double pressureError() const
  {
    if (boxUnknowns_ == 0)
      return 0;
    const double pv = options_.pressure * g_.volume();
    const Vec onBox = g_.virial.array() - pv;
    return boxUnknowns_ == 1 ? std::abs(onBox.mean()) / pv : onBox.cwiseAbs().maxCoeff() / pv;
  }

  void move(const Eigen::VectorXd& step)
  {
    for (std::size_t i = 0; i < g_.count(); ++i)
      g_.position[i] += step.template segment<Dim>(Dim * static_cast<Eigen::Index>(i));
    if (boxUnknowns_ == 1)
      g_.strain(Vec::Constant(std::exp(step[size() - 1])));
    else if (boxUnknowns_ == Dim)
      g_.strain(step.template tail<Dim>().array().exp());
  }

  [[nodiscard]] Matrix hessian() const
  {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(g_.pairs().size() * 4 * (Dim + 1) * (Dim + 1));
    const Eigen::Index box = Dim * static_cast<Eigen::Index>(g_.count());
    const auto add = [&](Eigen::Index row, Eigen::Index column, double value)
    {
      if (value != 0 && row >= column)
        entries.emplace_back(row, column, value);
    };
    // The separation of a contact changes by (dx₂ − dx₁) + Q r with Q the strain: its derivatives are those of r.
    using Square = Eigen::Matrix<double, Dim, Dim>;
    const auto contact = [&](const Vec& r, const Square& k, Eigen::Index first, Eigen::Index second)
    {
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b)
        {
          if (first >= 0)
            add(first + a, first + b, k(a, b));
          if (second >= 0)
            add(second + a, second + b, k(a, b));
          if (first >= 0 && second >= 0)
          {
            add(first + a, second + b, -k(a, b));
            add(second + a, first + b, -k(a, b));
          }
          if (boxUnknowns_ == 0)
            continue;
          const Eigen::Index qa = boxUnknowns_ == 1 ? box : box + a;
          const Eigen::Index qb = boxUnknowns_ == 1 ? box : box + b;
          add(qa, qb, r[a] * k(a, b) * r[b]);
          if (first >= 0)
            add(qa, first + b, -r[a] * k(a, b));
          if (second >= 0)
            add(qa, second + b, r[a] * k(a, b));
        }
    };
    for (std::size_t index = 0; index < g_.pairs().size(); ++index)
    {
      const auto& pair = g_.pairs()[index];
      const Vec r = g_.separation(index);
      const double distance = r.norm();
      const double overlap =
        g_.radius[static_cast<std::size_t>(pair.first)] + g_.radius[static_cast<std::size_t>(pair.second)] - distance;
      if (overlap <= 0)
        continue;
      const Vec n = r / distance;
      const Square k = n * n.transpose() - overlap / distance * (Square::Identity() - n * n.transpose());
      contact(r, k, Dim * static_cast<Eigen::Index>(pair.first), Dim * static_cast<Eigen::Index>(pair.second));
    }
    for (int wall = 0; wall < GrainSystem<Dim>::walls; ++wall)
    {
      if (g_.periodic[static_cast<std::size_t>(wall / 2)])
        continue;
      const Vec n = GrainSystem<Dim>::wallNormal(wall);
      for (std::size_t i = 0; i < g_.count(); ++i)
      {
        const double overlap = g_.wallOverlap(i, wall);
        if (overlap > 0)
          contact((g_.radius[i] - overlap) * n, n * n.transpose(), Dim * static_cast<Eigen::Index>(i), -1);
      }
    }
    if (boxUnknowns_ > 0)
    {
      // second derivatives of pV, and of each contact's energy through exp(q): − force · r on the diagonal
      const double pv = options_.pressure * g_.volume();
      if (boxUnknowns_ == 1)
        add(box, box, Dim * Dim * pv - g_.virial.sum());
      else
        for (int a = 0; a < Dim; ++a)
          for (int b = 0; b < Dim; ++b)
            add(box + a, box + b, pv - (a == b ? g_.virial[a] : 0));
    }
    Matrix matrix(size(), size());
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }

private:
  GrainSystem<Dim>& g_;
  const RelaxationOptions& options_;
  int boxUnknowns_;
};

} // namespace

template <int Dim>
RelaxationResult newton(GrainSystem<Dim>& g, const RelaxationOptions& options)
{
  Enthalpy<Dim> enthalpy(g, options);
  using Matrix = typename Enthalpy<Dim>::Matrix;
  Matrix identity(enthalpy.size(), enthalpy.size());
  identity.setIdentity();
  Eigen::SimplicialLDLT<Matrix, Eigen::Lower> factors;
  double shift = 1e-6;
  enthalpy.value();
  RelaxationResult result;
  for (; result.steps < options.maxSteps; ++result.steps)
  {
    const Eigen::VectorXd force = enthalpy.force();
    if (g.unbalanced() <= options.tolerance && enthalpy.pressureError() <= options.tolerance)
    {
      result.atRest = true;
      break;
    }
    if (options.interrupted && options.interrupted())
      throw Cancelled();
    const Matrix hessian = enthalpy.hessian();
    for (;; shift *= 10)
    {
      factors.compute(Matrix(hessian + shift * identity));
      if (factors.info() == Eigen::Success && factors.vectorD().minCoeff() > 0)
        break;
      if (shift > 1e3)
        return result;
    }
    Eigen::VectorXd step = factors.solve(force);
    // no grain further than a tenth of a diameter
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > 0.1)
      step *= 0.1 / longest;

    // Contacts open and close on the way: find where the slope along the step vanishes, nearly.
    const auto start = g;
    const double slope = force.dot(step);
    double low = 0;
    double high = 0;
    double slopeLow = slope;
    double slopeHigh = 0;
    double length = 1;
    for (int trial = 0; trial < 12; ++trial)
    {
      g = start;
      enthalpy.move(length * step);
      enthalpy.value();
      const double here = enthalpy.force().dot(step);
      if (std::abs(here) <= 0.3 * slope)
        break;
      if (here > 0)
      {
        low = length;
        slopeLow = here;
        if (high == 0 && length >= 4)
          break;
      }
      else
      {
        high = length;
        slopeHigh = here;
      }
      length = high == 0 ? 2 * length : low + (high - low) * std::clamp(slopeLow / (slopeLow - slopeHigh), 0.1, 0.9);
    }
    shift = length >= 0.5 ? std::max(shift * 0.1, 1e-12) : std::min(shift * 3, 1e3);
  }
  if (!result.atRest)
    enthalpy.value();
  return result;
}

template RelaxationResult newton<2>(GrainSystem<2>&, const RelaxationOptions&);
template RelaxationResult newton<3>(GrainSystem<3>&, const RelaxationOptions&);

} // namespace lamella::packing
