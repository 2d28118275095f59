// Version and commit, as every output carries them.
#include "lamella/Version.h"

#include <gtest/gtest.h>

#include <regex>
#include <string>

TEST(Version, LibraryAndHeaderAgree)
{
  EXPECT_STREQ(lamella::version(), LAMELLA_VERSION);
  const std::string numbers = std::to_string(LAMELLA_VERSION_MAJOR) + "." + std::to_string(LAMELLA_VERSION_MINOR) +
    "." + std::to_string(LAMELLA_VERSION_PATCH);
  EXPECT_EQ(numbers, LAMELLA_VERSION);
}

TEST(Version, CommitIsAHashOrUnknown)
{
  EXPECT_TRUE(std::regex_match(lamella::commit(), std::regex("[0-9a-f]{12,40}(-dirty)?|unknown"))) << lamella::commit();
}
