// Compiled once for every instruction set, with LAMELLA_KERNELS naming the table that it defines; see ElementKernels.h.

#include "lbm/elements/ElementKernels.h"

namespace lamella::lbm
{
namespace
{

// ∫ x² and ∫ x² y² over the unit cube around 0
constexpr double square = 1.0 / 12;
constexpr double squares = 1.0 / 144;

// The coefficients of u, those of a mean profile added.
template <class Real>
struct Modes
{
  Real m100, m010, m001, m110, m101, m011, m111;

  Modes(const ElementRow<Real>& r, std::int64_t i)
  {
    const auto half = static_cast<Real>(0.5);
    // along x, then y, then z: half sums and differences
    const Real s00 = half * (r.u[0][i] + r.u[0][i + 1]);
    const Real s10 = half * (r.u[1][i] + r.u[1][i + 1]);
    const Real s01 = half * (r.u[2][i] + r.u[2][i + 1]);
    const Real s11 = half * (r.u[3][i] + r.u[3][i + 1]);
    const Real d00 = r.u[0][i + 1] - r.u[0][i];
    const Real d10 = r.u[1][i + 1] - r.u[1][i];
    const Real d01 = r.u[2][i + 1] - r.u[2][i];
    const Real d11 = r.u[3][i + 1] - r.u[3][i];
    const Real ss0 = half * (s00 + s10);
    const Real ss1 = half * (s01 + s11);
    const Real sd0 = s10 - s00;
    const Real sd1 = s11 - s01;
    const Real ds0 = half * (d00 + d10);
    const Real ds1 = half * (d01 + d11);
    const Real dd0 = d10 - d00;
    const Real dd1 = d11 - d01;
    m100 = half * (ds0 + ds1) + static_cast<Real>(r.gradient[0]);
    m010 = half * (sd0 + sd1) + static_cast<Real>(r.gradient[1]);
    m001 = ss1 - ss0 + static_cast<Real>(r.gradient[2]);
    m110 = half * (dd0 + dd1);
    m101 = ds1 - ds0;
    m011 = sd1 - sd0;
    m111 = dd1 - dd0;
  }
};

// Half the derivatives of an element's energy by its coefficients.
template <class Real>
struct Duals
{
  Real f100, f010, f001, f110, f101, f011, f111;

  Duals(const ElementRow<Real>& r, std::int64_t i, const Modes<Real>& m)
  {
    const Real xx = r.tensor[0][i];
    const Real yy = r.tensor[1][i];
    const Real zz = r.tensor[2][i];
    const Real xy = r.tensor[3][i];
    const Real xz = r.tensor[4][i];
    const Real yz = r.tensor[5][i];
    const auto w = static_cast<Real>(square);
    f100 = xx * m.m100 + xy * m.m010 + xz * m.m001;
    f010 = xy * m.m100 + yy * m.m010 + yz * m.m001;
    f001 = xz * m.m100 + yz * m.m010 + zz * m.m001;
    f110 = w * ((xx + yy) * m.m110 + xz * m.m011 + yz * m.m101);
    f101 = w * ((xx + zz) * m.m101 + xy * m.m011 + yz * m.m110);
    f011 = w * ((yy + zz) * m.m011 + xy * m.m101 + xz * m.m110);
    f111 = static_cast<Real>(squares) * (xx + yy + zz) * m.m111;
  }
};

template <class Real>
void apply(const ElementRow<Real>& row, Real* const out[4], Real* buffer)
{
  const std::int64_t n = row.count;
  Real* low[4];
  Real* high[4];
  for (int k = 0; k < 4; ++k)
  {
    low[k] = buffer + 2 * k * (n + 1);
    high[k] = buffer + (2 * k + 1) * (n + 1);
  }
  Real *l0 = low[0], *l1 = low[1], *l2 = low[2], *l3 = low[3];
  Real *h0 = high[0], *h1 = high[1], *h2 = high[2], *h3 = high[3];
  const auto half = static_cast<Real>(0.5);
#pragma omp simd
  for (std::int64_t i = 0; i < n; ++i)
  {
    const Modes<Real> m(row, i);
    const Duals<Real> f(row, i, m);
    // back: z, then y, then x
    const Real ds0 = half * f.f100 - f.f101;
    const Real ds1 = half * f.f100 + f.f101;
    const Real dd0 = half * f.f110 - f.f111;
    const Real dd1 = half * f.f110 + f.f111;
    const Real sd0 = half * f.f010 - f.f011;
    const Real sd1 = half * f.f010 + f.f011;
    const Real ss = half * f.f001;
    const Real d00 = half * ds0 - dd0;
    const Real d10 = half * ds0 + dd0;
    const Real d01 = half * ds1 - dd1;
    const Real d11 = half * ds1 + dd1;
    const Real s00 = half * (-ss - sd0);
    const Real s10 = half * (-ss + sd0);
    const Real s01 = half * (ss - sd1);
    const Real s11 = half * (ss + sd1);
    l0[i] = s00 - d00;
    h0[i] = s00 + d00;
    l1[i] = s10 - d10;
    h1[i] = s10 + d10;
    l2[i] = s01 - d01;
    h2[i] = s01 + d01;
    l3[i] = s11 - d11;
    h3[i] = s11 + d11;
  }
  for (int k = 0; k < 4; ++k)
  {
    Real* q = out[k];
    const Real* a = low[k];
    const Real* b = high[k];
#pragma omp simd
    for (std::int64_t i = 0; i < n; ++i)
      q[i] += a[i];
#pragma omp simd
    for (std::int64_t i = 0; i < n; ++i)
      q[i + 1] += b[i];
  }
}

void applySingle(const ElementRow<float>& row, float* const out[4], float* buffer)
{
  apply<float>(row, out, buffer);
}

void applyDouble(const ElementRow<double>& row, double* const out[4], double* buffer)
{
  apply<double>(row, out, buffer);
}

// A corner's hat function has the coefficients ¼, ½ and 1, their signs those of the corner.
void diagonal(const ElementRow<float>& row, float* const out[4])
{
  for (int k = 0; k < 4; ++k)
    for (int x = 0; x < 2; ++x)
    {
      const float sx = x == 0 ? -1.0F : 1.0F;
      const float sy = (k & 1) == 0 ? -1.0F : 1.0F;
      const float sz = (k & 2) == 0 ? -1.0F : 1.0F;
      float* q = out[k] + x;
      const float first = 1.0F / 16 + 2.0F / 48 + 1.0F / 144; // 1/9: of each K_aa
      const float mixed = 2.0F * (1.0F / 16 + 1.0F / 48);     // 1/6: of each K_ab
#pragma omp simd
      for (std::int64_t i = 0; i < row.count; ++i)
        q[i] += first * (row.tensor[0][i] + row.tensor[1][i] + row.tensor[2][i]) +
          mixed * (sx * sy * row.tensor[3][i] + sx * sz * row.tensor[4][i] + sy * sz * row.tensor[5][i]);
    }
}

void fluxes(const ElementRow<double>& row, double* const flux[3], double* energy)
{
  double sum = 0;
  double *qx = flux[0], *qy = flux[1], *qz = flux[2];
#pragma omp simd reduction(+ : sum)
  for (std::int64_t i = 0; i < row.count; ++i)
  {
    const Modes<double> m(row, i);
    const Duals<double> f(row, i, m);
    qx[i] = f.f100;
    qy[i] = f.f010;
    qz[i] = f.f001;
    sum += f.f100 * m.m100 + f.f010 * m.m010 + f.f001 * m.m001 + f.f110 * m.m110 + f.f101 * m.m101 + f.f011 * m.m011 +
      f.f111 * m.m111;
  }
  *energy += sum;
}

} // namespace

extern const ElementKernels LAMELLA_KERNELS;
const ElementKernels LAMELLA_KERNELS = { applySingle, applyDouble, diagonal, fluxes };

} // namespace lamella::lbm
