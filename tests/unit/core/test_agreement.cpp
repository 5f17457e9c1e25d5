// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <new>
#include <numeric>

namespace test_agreement {

using namespace Harmos;

TEST(Agreement, success_throws_nowhere) {
  EXPECT_NO_THROW(agree(*testComm(), [] {}));
}

// A failure on the last rank alone must reach all, with its type, text and data: otherwise the others would
// go on into the next collective call and wait for ever.
TEST(Agreement, failure_of_one_rank_is_thrown_on_all) {
  const auto comm = testComm();
  const int last = comm->getSize() - 1;
  try {
    agree(*comm, [&] {
      if (comm->getRank() == last)
        throw NumericalError("pivot 7 is zero", {{"subdomain", "42"}, {"pivot", "7"}});
    });
    FAIL() << "nothing was thrown";
  } catch (const NumericalError& error) {
    EXPECT_EQ(error.kind(), Error::Kind::Numerical);
    EXPECT_TRUE(error.isAgreed());
    EXPECT_EQ(std::string(error.what()).find("pivot 7 is zero"), 0u);
    if (comm->getSize() > 1)
      EXPECT_NE(std::string(error.what()).find("[on rank " + std::to_string(last) + "]"), std::string::npos);
    ASSERT_EQ(error.data().size(), 2u);
    EXPECT_EQ(error.data()[0].first, "subdomain");
    EXPECT_EQ(error.data()[0].second, "42");
    EXPECT_EQ(error.data()[1].second, "7");
  }
}

TEST(Agreement, the_lowest_of_several_failing_ranks_speaks) {
  const auto comm = testComm();
  try {
    agree(*comm, [&] { throw InternalError("rank " + std::to_string(comm->getRank())); });
    FAIL() << "nothing was thrown";
  } catch (const InternalError& error) {
    EXPECT_EQ(std::string(error.what()).find("rank 0"), 0u);
    if (comm->getSize() > 1)
      EXPECT_NE(std::string(error.what()).find("and on " + std::to_string(comm->getSize() - 1) + " more"),
                std::string::npos);
  }
}

TEST(Agreement, foreign_exceptions_become_internal_errors) {
  const auto comm = testComm();
  EXPECT_THROW(agree(*comm, [] { throw std::out_of_range("index 3"); }), InternalError);
  EXPECT_THROW(agree(*comm, [] { throw std::bad_alloc(); }), InternalError);
  EXPECT_THROW(agree(*comm, [] { throw 5; }), InternalError);
}

TEST(Agreement, input_errors_of_rank_0_are_told_without_its_number) {
  const auto comm = testComm();
  try {
    agree(*comm, [&] {
      if (comm->getRank() == 0)
        throw InputError("no such file");
    });
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "no such file");
  }
}

TEST(Agreement, requirement_names_file_and_condition) {
  try {
    HARMOS_REQUIRE(1 + 1 == 3, "arithmetic failed");
    FAIL() << "nothing was thrown";
  } catch (const InternalError& error) {
    EXPECT_NE(std::string(error.what()).find("arithmetic failed (test_agreement.cpp:"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("1 + 1 == 3"), std::string::npos);
  }
}

TEST(Exchange, items_arrive_in_order_and_from_the_right_rank) {
  const auto comm = testComm();
  const int me = comm->getRank(), ranks = comm->getSize();
  // Rank r sends r + s items (1000 r + 10 s + k) to rank s: sizes differ, some parts are empty.
  std::vector<std::vector<int>> sends(static_cast<std::size_t>(ranks));
  for (int s = 0; s < ranks; ++s)
    for (int k = 0; k < me + s; ++k)
      sends[static_cast<std::size_t>(s)].push_back(1000 * me + 10 * s + k);
  const auto received = exchangeItems(*comm, sends);
  ASSERT_EQ(received.size(), static_cast<std::size_t>(ranks));
  for (int r = 0; r < ranks; ++r) {
    ASSERT_EQ(received[static_cast<std::size_t>(r)].size(), static_cast<std::size_t>(me + r));
    for (int k = 0; k < me + r; ++k)
      EXPECT_EQ(received[static_cast<std::size_t>(r)][static_cast<std::size_t>(k)], 1000 * r + 10 * me + k);
  }
}

TEST(Exchange, reductions_and_scan) {
  const auto comm = testComm();
  const long long me = comm->getRank(), ranks = comm->getSize();
  EXPECT_EQ(globalSum(*comm, me), ranks * (ranks - 1) / 2);
  EXPECT_EQ(globalMax(*comm, me), ranks - 1);
  EXPECT_EQ(globalMin(*comm, me + 3), 3);
  EXPECT_EQ(exclusiveScan(*comm, me + 1), me * (me + 1) / 2);
  EXPECT_EQ(gatherAll(*comm, std::vector<long long>(static_cast<std::size_t>(me), me)).size(),
            static_cast<std::size_t>(ranks * (ranks - 1) / 2));
}

} // namespace test_agreement
