// Is a raw picture segmented right, or is the user warned? Every kind of tests/MicrographKinds.h, by seeds.
//   segmentation-kinds [PICTURES A KIND] [FIRST SEED] [other] [good|faulty] [--list] [--write FOLDER]
#include "../tests/MicrographKinds.h"

#include "pictures/WritePicture.h"
#include "segmentation/Segmentation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

using namespace lamella;

int main(int argc, char** argv)
{
  std::vector<std::string> words(argv + 1, argv + argc);
  const auto flag = [&](const std::string& name)
  {
    const auto at = std::find(words.begin(), words.end(), name);
    const bool there = at != words.end();
    if (there)
      words.erase(at);
    return there;
  };
  const bool other = flag("other");
  const bool good = flag("good");
  const bool faulty = flag("faulty");
  const bool list = flag("--list");
  std::filesystem::path folder;
  if (const auto at = std::find(words.begin(), words.end(), "--write"); at != words.end() && at + 1 != words.end())
  {
    folder = *(at + 1);
    words.erase(at, at + 2);
    std::filesystem::create_directories(folder);
  }
  const int count = words.empty() ? 12 : std::atoi(words[0].c_str());
  const int first = words.size() < 2 ? 1 : std::atoi(words[1].c_str());

  std::vector<kinds::Kind> all;
  if (!faulty)
    all.push_back(kinds::Kind::Good);
  if (!good)
    all.insert(all.end(), kinds::faulty().begin(), kinds::faulty().end());
  fmt::print("{:<26} {:>8} {:>14} {:>14} {:>14} {:>14}\n", "kind", "pictures", "right, silent", "right, warned",
    "wrong, warned", "wrong, silent");
  for (const kinds::Kind kind : all)
  {
    std::array<int, 4> numbers{};
    for (int i = 0; i < count; ++i)
    {
      const auto seed = static_cast<std::uint64_t>(first + i);
      const kinds::Sample sample = kinds::draw(kind, seed, other);
      const micrograph::Segmentation found = micrograph::segment(sample.picture);
      const kinds::Agreement agreement = kinds::compare(found.image, sample.open);
      const std::size_t which =
        agreement.right() ? (found.warnings.empty() ? 0U : 1U) : (found.warnings.empty() ? 3U : 2U);
      ++numbers.at(which);
      if (list)
      {
        fmt::print("  {} {} ({}): overlap {:.3f}, excess {:+.3f}, {}, D {}{}\n", seed, kinds::name(kind), sample.what,
          agreement.overlap, agreement.excess, found.report.channel, found.report.brightLumen ? "bright" : "dark",
          which == 3     ? " SILENT"
            : which == 1 ? " ALARM"
                         : "");
        for (const std::string& warning : found.warnings)
          fmt::print("      {}\n", warning);
      }
      if (!folder.empty())
      {
        const std::string stem = fmt::format("{}-{}{}", static_cast<int>(kind), seed, other ? "o" : "");
        micrograph::writePicture(sample.picture, folder / (stem + ".png"), {}, 1);
        micrograph::writeLabels(found.image, folder / (stem + "-found.png"));
      }
    }
    fmt::print("{:<26} {:>8} {:>14} {:>14} {:>14} {:>14}\n", kinds::name(kind), count, numbers[0], numbers[1],
      numbers[2], numbers[3]);
  }
  return 0;
}
