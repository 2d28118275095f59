#include "CallRedirection.h"

#include "vtk_glew.h"

#include <cstdint>
#include <cstring>
#include <link.h>
#include <string_view>
#include <sys/mman.h>
#include <unistd.h>

namespace lamella::rendering
{
namespace
{

GLenum GLEWAPIENTRY InitWithoutDisplay()
{
  const GLenum result = glewInit();
  return result == GLEW_ERROR_NO_GLX_DISPLAY ? GLEW_OK : result;
}

int SomeDisplay = 0;
void* OpenNoDisplay(const char*)
{
  return &SomeDisplay;
}
int CloseNoDisplay(void*)
{
  return 0;
}

struct Redirection
{
  std::string_view library; ///< how the file's name begins
  const char* function;
  void* target;
};

/// The relocation tables of a loaded library, from its dynamic section (the C library has made them absolute).
struct Tables
{
  const ElfW(Sym) * symbols = nullptr;
  const char* names = nullptr;
  const ElfW(Rela) * calls = nullptr;
  std::size_t callBytes = 0;
  const ElfW(Rela) * data = nullptr;
  std::size_t dataBytes = 0;
};

Tables ReadDynamic(const ElfW(Dyn) * entry)
{
  Tables tables;
  for (; entry->d_tag != DT_NULL; ++entry)
  {
    switch (entry->d_tag)
    {
      case DT_SYMTAB:
        tables.symbols = reinterpret_cast<const ElfW(Sym)*>(entry->d_un.d_ptr);
        break;
      case DT_STRTAB:
        tables.names = reinterpret_cast<const char*>(entry->d_un.d_ptr);
        break;
      case DT_JMPREL:
        tables.calls = reinterpret_cast<const ElfW(Rela)*>(entry->d_un.d_ptr);
        break;
      case DT_PLTRELSZ:
        tables.callBytes = entry->d_un.d_val;
        break;
      case DT_RELA:
        tables.data = reinterpret_cast<const ElfW(Rela)*>(entry->d_un.d_ptr);
        break;
      case DT_RELASZ:
        tables.dataBytes = entry->d_un.d_val;
        break;
      default:
        break;
    }
  }
  return tables;
}

void WriteSlot(void** slot, void* value)
{
  const auto pageSize = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  void* page = reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(slot) & ~(pageSize - 1));
  if (mprotect(page, pageSize, PROT_READ | PROT_WRITE) == 0) // the linker may have sealed it
    *slot = value;
}

bool Redirect(ElfW(Addr) base, const Tables& tables, const ElfW(Rela) * relocation, std::size_t bytes,
  const Redirection& redirection)
{
  for (std::size_t i = 0; i < bytes / sizeof(ElfW(Rela)); ++i)
  {
    // A relocation that bears a function's name has one purpose: the slot through which the function is called.
    const ElfW(Sym)& symbol = tables.symbols[ELF64_R_SYM(relocation[i].r_info)];
    if (std::strcmp(tables.names + symbol.st_name, redirection.function) == 0)
    {
      WriteSlot(reinterpret_cast<void**>(base + relocation[i].r_offset), redirection.target);
      return true;
    }
  }
  return false;
}

int Visit(dl_phdr_info* library, std::size_t, void*)
{
  static const Redirection redirections[] = {
    { "libvtkRenderingOpenGL2", "glewInit", reinterpret_cast<void*>(&InitWithoutDisplay) },
    { "libvtkRemotingViews-", "XOpenDisplay", reinterpret_cast<void*>(&OpenNoDisplay) },
    { "libvtkRemotingViews-", "XCloseDisplay", reinterpret_cast<void*>(&CloseNoDisplay) },
  };
  std::string_view name = library->dlpi_name ? library->dlpi_name : "";
  name.remove_prefix(name.rfind('/') + 1); // npos + 1 is 0
  for (const Redirection& redirection : redirections)
  {
    if (!name.starts_with(redirection.library))
      continue;
    for (int i = 0; i < library->dlpi_phnum; ++i)
    {
      const ElfW(Phdr)& header = library->dlpi_phdr[i];
      if (header.p_type == PT_DYNAMIC)
      {
        const Tables tables = ReadDynamic(reinterpret_cast<const ElfW(Dyn)*>(library->dlpi_addr + header.p_vaddr));
        if (tables.symbols && tables.names &&
          !Redirect(library->dlpi_addr, tables, tables.calls, tables.callBytes, redirection))
          Redirect(library->dlpi_addr, tables, tables.data, tables.dataBytes, redirection);
      }
    }
  }
  return 0;
}

} // namespace

void RedirectDisplayTests()
{
  if constexpr (sizeof(void*) == 8) // ELF with 64 bits and addends, as on x86-64 and ARM
    dl_iterate_phdr(&Visit, nullptr);
}

} // namespace lamella::rendering
