#include "../TemporaryFolder.h"

#include "core/Error.h"
#include "io/Checkpoint.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <limits>
#include <span>

namespace
{

using namespace lamella;
using lamella::testing::TemporaryFolder;
namespace fs = std::filesystem;

// To the last bit, and in a file that HDF5 reads where it lies.
TEST(Checkpoint, KeepsNumbersAndIsHdf5)
{
  const TemporaryFolder folder;
  io::Checkpoint c;
  c.kind = "test";
  c.scene = "nodes: 3\n" + std::string(100000, 'x') + ": long\n";
  c.provenance = "{}";
  c.numbers = { { "third", 1.0 / 3 }, { "tiny", 4e-320 }, { "infinite", std::numeric_limits<double>::infinity() } };
  c.arrays["empty"] = { { 0, 4 }, std::vector<std::int64_t>{}, "", "" };
  c.arrays["u"] = { { 1, 3 }, std::vector<double>{ 0.1, -0.0, 1e300 }, "m", "displacement" };
  c.arrays["n"] = { { 2 }, std::vector<std::int64_t>{ -1, std::int64_t{ 1 } << 60 }, "", "" };
  const fs::path file = folder / "c.h5";
  io::replaceFile(file, c);
  const io::Checkpoint back = io::readFile(file);
  EXPECT_EQ(back.kind, c.kind);
  EXPECT_EQ(back.scene, c.scene);
  EXPECT_EQ(back.provenance, c.provenance);
  EXPECT_EQ(back.numbers, c.numbers);
  ASSERT_EQ(back.arrays.size(), 3U);
  for (const auto& [name, array] : c.arrays)
  {
    EXPECT_EQ(back.arrays.at(name).shape, array.shape);
    EXPECT_EQ(back.arrays.at(name).values, array.values);
    EXPECT_EQ(back.arrays.at(name).unit, array.unit);
  }
  EXPECT_TRUE(std::signbit(back.reals("u")[1]));
  EXPECT_THROW((void)back.integers("u"), InputError);
  EXPECT_THROW((void)back.number("fourth"), InputError);

  const hid_t plain = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(plain, 0);
  const hid_t set = H5Dopen2(plain, "arrays/u", H5P_DEFAULT);
  ASSERT_GE(set, 0);
  double values[3]{};
  EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
  EXPECT_EQ(values[2], 1e300);
  H5Dclose(set);
  H5Fclose(plain);
}

// More columns than are asked for at a time, so that the parts must come to lie where they belong.
TEST(Checkpoint, AsksForColumnsAsItIsWritten)
{
  constexpr std::int64_t rows = 3;
  constexpr std::int64_t count = 150001;
  int parts = 0;
  io::Checkpoint c;
  c.arrays["table"] = { { rows, count }, {}, "m", "" };
  c.arrays["table"].columns = [&](std::int64_t begin, std::int64_t end, std::span<double> values)
  {
    ++parts;
    ASSERT_EQ(values.size(), static_cast<std::size_t>(rows * (end - begin)));
    for (std::int64_t row = 0; row < rows; ++row)
      for (std::int64_t i = begin; i < end; ++i)
        values[static_cast<std::size_t>(row * (end - begin) + i - begin)] = static_cast<double>(row * count + i);
  };
  io::Checkpoint held = c;
  held.hold();
  const TemporaryFolder folder;
  io::replaceFile(folder / "c.h5", c);
  EXPECT_GT(parts, 2); // one of them for hold()
  const io::Checkpoint back = io::readFile(folder / "c.h5");
  EXPECT_EQ(back.reals("table"), held.reals("table"));
  for (std::int64_t i = 0; i < rows * count; ++i)
    ASSERT_EQ(back.reals("table")[static_cast<std::size_t>(i)], static_cast<double>(i));
  EXPECT_EQ(back.arrays.at("table").shape, c.arrays.at("table").shape);
}

} // namespace
