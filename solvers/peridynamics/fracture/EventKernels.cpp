#include "peridynamics/fracture/EventKernels.h"

#include "core/InstructionSet.h"

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
  static const EventKernels& best = fastest(eventKernelsBase, eventKernelsV3, eventKernelsV4);
  return best;
#else
  return eventKernelsBase;
#endif
}

} // namespace lamella::peridynamics
