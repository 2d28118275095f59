#pragma once

#include "outlines/Contour.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace lamella::micrograph
{

using Json = nlohmann::ordered_json;
using Polygon = std::vector<Point>;

/// Farther than this from each other no points of a micrograph lie [m].
inline constexpr double largestPicture = 1.0;
/// What to write into a polygon file, for hints.
inline constexpr const char* polygonKinds =
  "write {\"units\": \"um\", \"lumens\": [[[x, y], …], …]}, or cells with a \"lumen\" each";

/// Takes numbers, points and rings out of JSON; errors name the file.
class RingReader
{
public:
  explicit RingReader(std::string name)
    : name_(std::move(name))
  {
  }

  [[noreturn]] void fail(const std::string& what, const std::string& hint) const;
  /// The unit of the coordinates [m]: as given, or what the file says.
  [[nodiscard]] double findUnit(const Json& json, std::optional<double> given) const;
  /// A list of points, in the file's coordinates. @param what the list's name
  [[nodiscard]] Polygon points(const Json& list, const std::string& what) const;
  /// A ring made ready: one after the other no equal points, counter-clockwise, in metres. Empty if it has no area.
  [[nodiscard]] Polygon ring(const Json& list, const std::string& what, double unit, bool yDown);
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  void warn(std::string text) { warnings_.push_back(std::move(text)); }
  /// All warnings, that about repeated points last.
  [[nodiscard]] std::vector<std::string> warnings() const;

private:
  [[nodiscard]] double number(const Json& value, const std::string& what) const;

  std::string name_;
  std::size_t repeated_ = 0;
  std::vector<std::string> warnings_;
};

} // namespace lamella::micrograph
