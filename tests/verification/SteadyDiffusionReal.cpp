// Real pictures: numbers computed by others' code (five- and seven-point finite volumes with harmonic faces, fixed
// temperatures on two opposite outer faces, the other sides insulated).
#include "Diffusion.h"

#include "pictures/Picture.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace
{

using namespace lamella;
using namespace lamella::test;

TEST(RealTissue, SpruceToTheLastDigit)
{
  const char* folder = std::getenv("LAMELLA_REAL_DATA");
  if (folder == nullptr)
    GTEST_SKIP() << "LAMELLA_REAL_DATA does not name the folder of real pictures";
  struct
  {
    const char* file;
    int refinement;
    double y, x;
  } const table[] = { { "spruce_EW_labels_0.5um.png", 1, 0.15803, 0.15774 },
    { "spruce_EW_labels_0.5um.png", 2, 0.15893, 0.15841 }, { "spruce_LW_labels_0.5um.png", 1, 0.44488, 0.48006 },
    { "spruce_LW_labels_0.5um.png", 2, 0.44713, 0.48172 } };
  for (const auto& c : table)
  {
    const auto picture = micrograph::readPicture(std::filesystem::path(folder) / c.file);
    GreyMap map;
    map.phaseOfGrey[0] = "lumen";
    map.other = "wall";
    auto image = crop(map.apply(picture.lattice, picture.grey), Window{ { 100, 20, 0 }, { 400, 400, 0 } });
    image = refine(image, c.refinement);
    EXPECT_NEAR(solve(image, { 0.05, 1.0 }, { .axis = 1 }).effective[1], c.y, 0.5e-5);
    EXPECT_NEAR(solve(image, { 0.05, 1.0 }, { .axis = 0 }).effective[0], c.x, 0.5e-5);
  }
}

} // namespace
