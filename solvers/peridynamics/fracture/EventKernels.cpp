#include "peridynamics/fracture/EventKernels.h"

namespace lamella::peridynamics
{

extern const EventKernels eventKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const EventKernels eventKernelsV3;
extern const EventKernels eventKernelsV4;
#endif

const EventKernels& eventKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const EventKernels& best = []() -> const EventKernels&
  {
    __builtin_cpu_init();
    if (__builtin_cpu_supports("x86-64-v4"))
      return eventKernelsV4;
    return __builtin_cpu_supports("x86-64-v3") ? eventKernelsV3 : eventKernelsBase;
  }();
  return best;
#else
  return eventKernelsBase;
#endif
}

} // namespace lamella::peridynamics
