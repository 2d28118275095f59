#pragma once

#include <cstdint>

/// The loops over the bonds from one row of nodes to another, compiled once for every instruction set and chosen at run
/// time. As in lbm/multigrid/Kernels.h no standard library type crosses this interface.
///
/// A bond is computed once, at its first node i. Two passes a pair of rows: push() adds its force to i, in registers
/// over all bonds of the chunk, and leaves it in a row buffer; pull() takes it from there and adds the opposite to the
/// second nodes. No node is written twice within a pass, so both are free of store-to-load hazards, every store is
/// aligned, and the order of the sum at a node does not depend on how rows are shared out.
namespace lamella::peridynamics
{

/// Bonds of a chunk: all of one row pair and of one 32-bit word.
inline constexpr int maxChunk = 5;
inline constexpr int maxPlanes = 8;

/// Numbers of a bond of the stencil; the spring and stiffness are of one kind of bond, or of k = 1.
template <class Real>
struct OffsetNumbers
{
  Real step[3];       ///< in spacings
  Real xi[3];         ///< ξ [m]
  Real inverseSquare; ///< 1/|ξ|²
  Real linear[3];     ///< k/(δx L³) n, n the steps and L their length: f = (linear·η) n
  Real spring;        ///< k/|ξ|
  Real halfSquare[3]; ///< half of the squares of ξ/|ξ|
};

template <class Real>
struct RowJob
{
  int count;                             ///< bonds, 1 … maxChunk
  int bit;                               ///< of the first bond in its word
  std::int64_t stepX;                    ///< of the first bond; the others follow one by one
  int planes;                            ///< bits a bond
  const std::uint32_t* words[maxPlanes]; ///< of row i, at x = 0, likewise all rows below
  const Real* u[3];                      ///< displacement of row i
  const Real* v[3];                      ///< of the row of the second nodes
  Real* f[3];                            ///< force on row i, added to; on the second nodes for pull()
  Real* t;                               ///< buffers: bond b, component c at t + (b parts + c) pitch; parts is 1 where
  std::int64_t pitch;                    ///< the force is linearised (its multiple of the step), else the dimension
  const float* shareI[3];                ///< with surface correction: BondLattice::shares() of both rows
  const float* shareJ[3];
  const OffsetNumbers<Real>* unit; ///< of the chunk's bonds for k = 1
  const OffsetNumbers<Real>* kind; ///< for the kind of a uniform run, or for the only kind
  const Real* stiffness;           ///< k of each kind; [0] = 0
  const Real* critical;            ///< (1 + s₀)² − 1 of each kind: the q beyond which a bond is critical
  Real safe;                       ///< a q below the least critical one and within the series' range
  int uniformKind;                 ///< of a uniform run
  unsigned char* marks;            ///< bit b of marks[x]: bond b from x is critical; cleared by the caller
  bool marked;                     ///< set when any mark was
};

/// How push() finds the kind of a bond.
enum Path : int
{
  Uniform,  ///< all bonds are there and of one kind
  OnePlane, ///< one kind
  TwoPlanes,
  ThreePlanes,
  ManyPlanes,
  paths
};

template <class Real>
struct RealRowKernels
{
  using Push = void (*)(RowJob<Real>& job, std::int64_t x0, std::int64_t x1);
  /// By dimension - 2, path, surface correction, and bonds of the chunk - 1 (4 is not used). x0, x1: multiples of
  /// a cache line.
  Push linear[2][paths][2][maxChunk];
  Push nonlinear[2][paths][2][maxChunk];
  /// Adds the energy of the bonds from a node to f[0] at it, ½ k/|ξ| (|ξ+η| − |ξ|)²; nothing is marked. By dimension -
  /// 2, path and surface correction, for any number of bonds.
  Push energy[2][paths][2];
  /// Subtracts the buffers from the second nodes x0 … x1. By dimension - 2 and bonds - 1.
  Push pullLinear[2][maxChunk];
  Push pullNonlinear[2][maxChunk];
};

struct RowKernels
{
  const char* name; ///< "x86-64", "x86-64-v3" (AVX2), "x86-64-v4" (AVX-512), "generic"
  RealRowKernels<double> d;
  RealRowKernels<float> f;
};

/// The fastest set that this processor can run.
[[nodiscard]] const RowKernels& rowKernels();
/// All that it can run, slowest first.
/// @param sets room for 3
/// @return how many
int rowKernelSets(const RowKernels** sets);

} // namespace lamella::peridynamics
