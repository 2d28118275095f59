#pragma once

#include "Keys.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace lamella::benchmark
{

/// Lines of a table in the file BENCH-NAME.csv of the folder output= (results/bench-BENCH unless told).
class Table
{
public:
  Table(const Keys& keys, const std::string& bench, const std::string& name, const char* columns)
  {
    const std::string folder = text(keys, "output", ("results/bench-" + bench).c_str());
    std::filesystem::create_directories(folder);
    file_.open(std::filesystem::path(folder) / fmt::format("{}-{}.csv", bench, name));
    file_ << columns << "\n";
  }
  template <class... Values>
  void line(const Values&... values)
  {
    std::string text;
    ((text += fmt::format("{},", values)), ...);
    text.pop_back();
    file_ << text << "\n" << std::flush;
  }

private:
  std::ofstream file_;
};

} // namespace lamella::benchmark
