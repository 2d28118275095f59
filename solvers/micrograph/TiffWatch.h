#pragma once

#include <mutex>
#include <string>

namespace lamella::micrograph
{

/// Listens to what libtiff reports while OpenCV decodes with it. OpenCV goes on after an error in a strip and hands
/// back whatever was in memory, so this is the only way to notice a damaged TIFF. Where the library cannot be found
/// nothing is heard. One watch at a time in a process; others wait.
class TiffWatch
{
public:
  TiffWatch();
  ~TiffWatch();
  TiffWatch(const TiffWatch&) = delete;
  TiffWatch& operator=(const TiffWatch&) = delete;

  /// The first error since the watch began; empty when there was none.
  [[nodiscard]] const std::string& error() const noexcept;

private:
  std::unique_lock<std::mutex> lock_;
  void* setHandler_ = nullptr;
  void* before_ = nullptr;
};

} // namespace lamella::micrograph
