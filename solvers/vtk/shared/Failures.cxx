#include "Failures.h"

#include "core/Error.h"

#include <mutex>
#include <new>
#include <utility>

namespace lamella
{
namespace
{

struct Kept
{
  std::mutex mutex;
  std::exception_ptr error;
};

Kept& kept()
{
  static Kept instance;
  return instance;
}

template <class... Kinds>
bool isAny(const std::exception& error)
{
  return ((dynamic_cast<const Kinds*>(&error) != nullptr) || ...);
}

} // namespace

Failure kindOf(const std::exception& error)
{
  if (isAny<ParameterError>(error))
    return Failure::Parameter;
  if (isAny<NoPathError>(error))
    return Failure::NoPath;
  if (isAny<MemoryError, std::bad_alloc>(error))
    return Failure::Memory;
  if (isAny<DivergenceError>(error))
    return Failure::Divergence;
  return isAny<Error>(error) ? Failure::Input : Failure::Other;
}

void keepFailure(const std::exception_ptr& error)
{
  const std::scoped_lock lock(kept().mutex);
  if (!kept().error)
    kept().error = error;
}

std::exception_ptr takeFailure()
{
  const std::scoped_lock lock(kept().mutex);
  return std::exchange(kept().error, nullptr);
}

std::exception_ptr lastFailure()
{
  const std::scoped_lock lock(kept().mutex);
  return kept().error;
}

} // namespace lamella
