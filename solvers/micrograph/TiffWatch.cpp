#include "micrograph/TiffWatch.h"

#include <dlfcn.h>

#include <cstdarg>
#include <cstdio>

namespace lamella::micrograph
{
namespace
{

// As libtiff declares them (tiffio.h), the same since 1993; its headers are not needed for anything else.
using Handler = void (*)(const char* module, const char* format, va_list values);
using SetHandler = Handler (*)(Handler);

std::mutex& watchMutex()
{
  static std::mutex mutex;
  return mutex;
}

std::string& firstError()
{
  static std::string text;
  return text;
}

void listen(const char* /*module*/, const char* format, va_list values)
{
  if (firstError().empty())
  {
    char text[200];
    std::vsnprintf(text, sizeof text, format, values);
    firstError() = text;
  }
}

void* findSetHandler()
{
  for (const char* library : { "libtiff.so.6", "libtiff.so.5" })
  {
    // Only a library that is loaded already: OpenCV's.
    if (void* handle = dlopen(library, RTLD_LAZY | RTLD_NOLOAD))
    {
      void* symbol = dlsym(handle, "TIFFSetErrorHandler");
      dlclose(handle);
      return symbol;
    }
  }
  return nullptr;
}

} // namespace

TiffWatch::TiffWatch()
  : lock_(watchMutex())
  , setHandler_(findSetHandler())
{
  firstError().clear();
  if (setHandler_ != nullptr)
  {
    before_ = reinterpret_cast<void*>(reinterpret_cast<SetHandler>(setHandler_)(listen));
  }
}

TiffWatch::~TiffWatch()
{
  if (setHandler_ != nullptr)
  {
    reinterpret_cast<SetHandler>(setHandler_)(reinterpret_cast<Handler>(before_));
  }
}

const std::string& TiffWatch::error() const noexcept
{
  return firstError();
}

} // namespace lamella::micrograph
