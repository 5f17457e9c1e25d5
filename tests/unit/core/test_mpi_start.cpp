// SPDX-License-Identifier: BSD-3-Clause
// What a start on one machine proposes to Open MPI, by what the launcher and the user say.
#include "Harmos_MpiStart.hpp"

#include <array>
#include <cstdlib>
#include <gtest/gtest.h>
#include <map>
#include <mpi.h>
#include <optional>
#include <string>

namespace test_mpi_start {

using Variables = std::map<std::string, std::string>;

class MpiStart : public testing::Test {
 protected:
  MpiStart() {
    for (const char* name : names) {
      if (const char* value = std::getenv(name))
        before_[name] = value;
      unsetenv(name);
    }
  }
  ~MpiStart() override {
    for (const char* name : names) {
      const auto found = before_.find(name);
      found == before_.end() ? unsetenv(name) : setenv(name, found->second.c_str(), 1);
    }
  }

  // What is set besides what was given.
  static Variables proposed(const Variables& given) {
    for (const auto& [name, value] : given)
      setenv(name.c_str(), value.c_str(), 1);
    Harmos::prepareMpiStart();
    Variables result;
    for (const char* name : names) {
      const char* value = std::getenv(name);
      if (value != nullptr && (given.count(name) == 0 || given.at(name) != value))
        result[name] = value;
      unsetenv(name);
    }
    return result;
  }

 private:
  static constexpr std::array<const char*, 13> names = {"OMPI_COMM_WORLD_SIZE",
                                                        "OMPI_COMM_WORLD_LOCAL_SIZE",
                                                        "PMIX_RANK",
                                                        "PMIX_NAMESPACE",
                                                        "PMI_RANK",
                                                        "SLURM_PROCID",
                                                        "PBS_JOBID",
                                                        "OMPI_MCA_pml",
                                                        "OMPI_MCA_mtl",
                                                        "OMPI_MCA_ess_singleton_isolated",
                                                        "OMPI_MCA_btl",
                                                        "OMPI_MCA_orte_create_session_dirs",
                                                        "OMPI_MCA_sharedfp"};
  Variables before_;
};

#ifdef OPEN_MPI
TEST_F(MpiStart, SharedMemoryWhereAllRanksAreOnOneMachine) {
  const Variables here = proposed({{"OMPI_COMM_WORLD_SIZE", "2"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"}});
  EXPECT_EQ(here.size(), 2U);
  EXPECT_EQ(here.at("OMPI_MCA_pml"), "ob1");
  EXPECT_EQ(here.at("OMPI_MCA_btl").rfind("self,", 0), 0U);
  const Variables alone = proposed({});
  EXPECT_EQ(alone.size(), 5U);
  EXPECT_EQ(alone.at("OMPI_MCA_ess_singleton_isolated"), "1");
  EXPECT_EQ(alone.at("OMPI_MCA_orte_create_session_dirs"), "0");
  EXPECT_EQ(alone.at("OMPI_MCA_sharedfp"), "^sm");
}

TEST_F(MpiStart, LeavesOtherStartsAlone) {
  EXPECT_TRUE(proposed({{"OMPI_COMM_WORLD_SIZE", "4"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"}}).empty());
  for (const char* launcher : {"PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK", "SLURM_PROCID", "PBS_JOBID"})
    EXPECT_TRUE(proposed({{launcher, "0"}}).empty()) << launcher;
}

TEST_F(MpiStart, KeepsWhatTheUserHasChosen) {
  for (const char* choice : {"OMPI_MCA_pml", "OMPI_MCA_mtl", "OMPI_MCA_btl"}) {
    const Variables here =
        proposed({{"OMPI_COMM_WORLD_SIZE", "2"}, {"OMPI_COMM_WORLD_LOCAL_SIZE", "2"}, {choice, "mine"}});
    EXPECT_TRUE(here.empty()) << choice;
  }
}
#else
TEST_F(MpiStart, SaysNothingToOtherLibraries) {
  EXPECT_TRUE(proposed({}).empty());
}
#endif

} // namespace test_mpi_start
