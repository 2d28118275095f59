#include "lbm/multigrid/Kernels.h"

namespace lamella::lbm
{

extern const Kernels kernelsBase;
#ifdef LAMELLA_X86_KERNELS
extern const Kernels kernelsV3;
extern const Kernels kernelsV4;
#endif

namespace
{

struct Choice
{
  const Kernels* kernels;
  const char* name;
};

Choice choose()
{
#ifdef LAMELLA_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4"))
    return { &kernelsV4, "x86-64-v4" };
  if (__builtin_cpu_supports("x86-64-v3"))
    return { &kernelsV3, "x86-64-v3" };
  return { &kernelsBase, "x86-64" };
#else
  return { &kernelsBase, "generic" };
#endif
}

const Choice& choice()
{
  static const Choice c = choose();
  return c;
}

} // namespace

const Kernels& kernels()
{
  return *choice().kernels;
}

const char* kernelsName()
{
  return choice().name;
}

} // namespace lamella::lbm
