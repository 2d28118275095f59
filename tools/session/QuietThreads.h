#pragma once

namespace lamella::cli
{

/// Threads that wait for others soon sleep. GNU's OpenMP library spins for milliseconds at the end of
/// each loop, and where other programs use the processors too, the thread that is waited for is the one that does not
/// run: two threads were then slower than one by any factor. The library takes the number of spins from the
/// environment, as it is loaded, before main(): so where `arguments` may ask for threads the program begins anew with
/// GOMP_SPINCOUNT set. It does nothing where that or OMP_WAIT_POLICY is set, and returns only where it does nothing.
void beginWithQuietThreads(char** arguments);

} // namespace lamella::cli
