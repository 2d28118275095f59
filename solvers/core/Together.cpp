#include "core/Together.h"

#include "core/Error.h"

#include <cstddef>
#include <exception>
#include <string>

namespace lamella
{
namespace
{

/// What tells an error to another rank.
struct Told
{
  char kind = 0; // place in the list of throwAgain(); 0: none
  std::string message;
  std::string hint;
};

Told tell(const Error& e)
{
  const char kind = dynamic_cast<const InputError*>(&e) != nullptr ? 2
    : dynamic_cast<const ParameterError*>(&e) != nullptr           ? 3
    : dynamic_cast<const NoPathError*>(&e) != nullptr              ? 4
    : dynamic_cast<const MemoryError*>(&e) != nullptr              ? 5
    : dynamic_cast<const DivergenceError*>(&e) != nullptr          ? 6
    : dynamic_cast<const Cancelled*>(&e) != nullptr                ? 7
                                                                   : 1;
  return { kind, e.what(), e.hint() };
}

[[noreturn]] void throwAgain(const Told& told)
{
  switch (told.kind)
  {
    case 2:
      throw InputError(told.message, told.hint);
    case 3:
      throw ParameterError(told.message, told.hint);
    case 4:
      throw NoPathError(told.message, told.hint);
    case 5:
      throw MemoryError(told.message, told.hint);
    case 6:
      throw DivergenceError(told.message, told.hint);
    case 7:
      throw Cancelled();
    default:
      throw Error(told.message, told.hint);
  }
}

} // namespace

void together(const Communicator& comm, const std::function<void()>& f)
{
  if (!comm.parallel())
    return f();
  Told mine;
  try
  {
    f();
  }
  catch (const Error& e)
  {
    mine = tell(e);
  }
  catch (const std::exception& e)
  {
    mine = { 1, e.what(), "it happened on one of several ranks: try one" };
  }
  const int first = static_cast<int>(-comm.max(mine.kind != 0 ? -comm.rank() : -comm.size()));
  if (first == comm.size())
    return;
  std::string bytes = mine.kind + mine.message + '\0' + mine.hint;
  auto size = static_cast<int>(bytes.size());
  MPI_Bcast(&size, 1, MPI_INT, first, comm.handle());
  bytes.resize(static_cast<std::size_t>(size));
  MPI_Bcast(bytes.data(), size, MPI_CHAR, first, comm.handle());
  const std::size_t end = bytes.find('\0', 1);
  throwAgain({ bytes[0], bytes.substr(1, end - 1), bytes.substr(end + 1) });
}

} // namespace lamella
