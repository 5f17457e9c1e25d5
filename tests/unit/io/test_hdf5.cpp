// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Hdf5.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace test_hdf5 {

using namespace Harmos;
using namespace Harmos::io;

namespace {

// The same on all ranks; a directory of this test alone.
std::string path(const std::string& name) {
  const std::string directory = "hdf5_np" + std::to_string(testComm()->getSize());
  if (testComm()->getRank() == 0)
    std::filesystem::create_directories(directory);
  testComm()->barrier();
  return directory + "/" + name;
}

// Rank r has 3r rows, the first rank none.
std::vector<double> share(std::size_t width) {
  std::vector<double> values;
  const int rank = testComm()->getRank();
  for (std::size_t k = 0; k < 3 * static_cast<std::size_t>(rank) * width; ++k)
    values.push_back(100.0 * rank + static_cast<double>(k));
  return values;
}

void write(Hdf5Writer& file, const std::string& name, std::size_t width) {
  const std::vector<double> mine = share(width);
  const auto rows = static_cast<long long>(mine.size() / width);
  file.rows(name, mine, width, exclusiveScan(*testComm(), rows), globalSum(*testComm(), rows));
}

} // namespace

TEST(Hdf5, every_rank_reads_what_all_wrote) {
  const std::string name = path("whole.h5");
  for (std::size_t width : {std::size_t{1}, std::size_t{3}}) {
    {
      Hdf5Writer file(*testComm(), name, "the test file", 1000);
      file.group("/group");
      file.attribute("/group", "Version", std::vector<int>{1, 0});
      file.attribute("/group", "Type", std::string("test"));
      write(file, "/group/values", width);
      const std::vector<unsigned char> bytes(testComm()->getRank() == 0 ? 5 : 0, 7);
      file.rows("/bytes", bytes, 1, testComm()->getRank() == 0 ? 0 : 5, 5);
      file.commit();
    }
    const Hdf5Reader reader(name, "the test file");
    EXPECT_TRUE(reader.has("/group/values"));
    EXPECT_FALSE(reader.has("/group/other"));
    EXPECT_EQ(reader.shape("/group/values").width, width);
    EXPECT_EQ(reader.all<double>("/group/values"), gatherAll(*testComm(), share(width)));
    EXPECT_EQ(reader.all<unsigned char>("/bytes"), std::vector<unsigned char>(5, 7));
    testComm()->barrier();
  }
}

// Whole or not at all: what was there before stays until the new file is complete.
TEST(Hdf5, a_file_that_is_given_up_leaves_nothing) {
  const std::string name = path("given_up.h5");
  if (testComm()->getRank() == 0)
    std::ofstream(name) << "before";
  testComm()->barrier();
  {
    Hdf5Writer file(*testComm(), name, "the test file", 1000);
    write(file, "/values", 1);
  }
  testComm()->barrier();
  EXPECT_FALSE(std::filesystem::exists(name + ".part"));
  std::string text;
  std::ifstream(name) >> text;
  EXPECT_EQ(text, "before");
}

TEST(Hdf5, faults_name_the_file) {
  const std::string unwritable =
      inputErrorOf([&] { Hdf5Writer(*testComm(), "no/such/place.h5", "the test file", 1000); });
  EXPECT_TRUE(contains(unwritable, "the file \"no/such/place.h5\" cannot be written")) << unwritable;
  EXPECT_TRUE(contains(unwritable, "directory is writable")) << unwritable;
  const std::string name = path("text.h5");
  if (testComm()->getRank() == 0)
    std::ofstream(name) << "not HDF5";
  testComm()->barrier();
  const std::string unreadable = inputErrorOf([&] { Hdf5Reader(name, "the test file"); });
  EXPECT_TRUE(contains(unreadable, "the test file \"" + name + "\" cannot be read")) << unreadable;
}

} // namespace test_hdf5
