#include "lbm/elements/ElementKernels.h"

#include "core/InstructionSet.h"

namespace lamella::lbm
{

extern const ElementKernels elementKernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const ElementKernels elementKernelsV3;
extern const ElementKernels elementKernelsV4;
#endif

const ElementKernels& elementKernels()
{
#ifdef LAMELLA_X86_KERNELS
  static const ElementKernels& chosen = fastest(elementKernelsBase, elementKernelsV3, elementKernelsV4);
  return chosen;
#else
  return elementKernelsBase;
#endif
}

} // namespace lamella::lbm
