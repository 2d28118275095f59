#pragma once

/// Internal: kernels are compiled for several instruction sets; which of them this processor has.
namespace lamella
{

#ifdef LAMELLA_X86_KERNELS
/// The set for the newest instructions that there are.
template <class Kernels>
[[nodiscard]] const Kernels& fastest(const Kernels& base, const Kernels& v3, const Kernels& v4)
{
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v4"))
    return v4;
  return __builtin_cpu_supports("x86-64-v3") ? v3 : base;
}
#endif

} // namespace lamella
