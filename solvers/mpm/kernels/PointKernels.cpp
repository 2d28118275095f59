#include "mpm/kernels/PointKernels.h"

#include "core/InstructionSet.h"

namespace lamella::mpm
{

extern const PointKernels pointKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const PointKernels pointKernelsV3;
extern const PointKernels pointKernelsV4;
#endif

const PointKernels& pointKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const PointKernels& best = fastest(pointKernelsBase, pointKernelsV3, pointKernelsV4);
  return best;
#else
  return pointKernelsBase;
#endif
}

} // namespace lamella::mpm
