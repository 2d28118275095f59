#include "generators/Generators.h"
#include "pictures/Picture.h"

#include <gtest/gtest.h>

#include <filesystem>

using namespace lamella;

namespace
{

/// A picture of the project's data folder as phases.
PhaseImage dataPicture(const char* name, const PhaseTable& phases)
{
  const micrograph::Picture picture = micrograph::readPicture(std::filesystem::path(LAMELLA_DATA_DIR) / name);
  EXPECT_EQ(picture.lattice.spacing, 1e-6) << name;
  EXPECT_TRUE(picture.warnings.empty()) << name;
  EXPECT_NE(picture.description.find("lamella generate"), std::string::npos) << name;
  GreyMap map;
  map.phaseOfGrey = { { 0, phases.name(0) }, { 255, phases.name(1) } };
  return map.apply(picture.lattice, picture.grey);
}

void expectSame(const char* name, const PhaseImage& made)
{
  const PhaseImage stored = dataPicture(name, made.phases);
  EXPECT_EQ(stored.lattice.dimension, made.lattice.dimension) << name;
  EXPECT_EQ(stored.lattice.size, made.lattice.size) << name;
  EXPECT_TRUE(stored.phase == made.phase) << name << " is not what data/make.sh makes: run it";
}

} // namespace

TEST(Data, IsWhatTheGeneratorsMake)
{
  generators::SoftwoodOptions early;
  expectSame("earlywood_200.png", generators::softwood(early));

  generators::SoftwoodOptions late;
  late.solidFraction = 0.78;
  late.ringPosition0 = late.ringPosition1 = 1;
  expectSame("latewood_200.png", generators::softwood(late));

  generators::SoftwoodOptions ring;
  ring.size = { 800, 400, 1 };
  ring.solidFraction = 0.45;
  ring.ringPosition1 = 1;
  ring.seed = 2;
  expectSame("ring_800x400.png", generators::softwood(ring));

  generators::SoftwoodOptions tissue;
  tissue.dimension = 3;
  tissue.size = { 64, 64, 64 };
  tissue.tracheidLength = 60e-6;
  expectSame("tissue_64.tif", generators::softwood(tissue));

  generators::HoneycombOptions honeycomb;
  honeycomb.size = { 208, 180, 1 };
  expectSame("honeycomb_208x180.png", generators::honeycomb(honeycomb));

  expectSame("disks_128.png", generators::inclusionArray(2, { 128, 128, 1 }, 1e-6, 0.5, 1));
}
