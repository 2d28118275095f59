#include "mpm/kernels/PointKernels.h"

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
  static const PointKernels& best = []() -> const PointKernels&
  {
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4"))
      return pointKernelsV4;
    return __builtin_cpu_supports("x86-64-v3") ? pointKernelsV3 : pointKernelsBase;
  }();
  return best;
#else
  return pointKernelsBase;
#endif
}

} // namespace lamella::mpm
