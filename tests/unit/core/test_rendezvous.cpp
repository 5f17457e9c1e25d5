// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GlobalOrder.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_TestComm.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace test_rendezvous {

using namespace Harmos;

// Every rank knows some keys, several of them of another rank, too; asked for are more than are known.
TEST(Rendezvous, values_are_found_wherever_they_are_known) {
  const auto comm = testComm();
  const long long rank = comm->getRank(), ranks = comm->getSize();
  std::vector<std::pair<long long, long long>> known;
  for (long long k = 0; k < 20; ++k)
    if (k % ranks == rank || k % 5 == 0)
      known.emplace_back(7 * k, 100 * k + rank);
  std::vector<long long> asked;
  for (long long k = 25; k >= 0; --k)
    asked.insert(asked.end(), {7 * k, 7 * k});
  const auto least = lookUp(*comm, known, asked, [](long long a, long long b) { return a < b; });
  const auto most = lookUp(*comm, known, asked, [](long long a, long long b) { return a > b; });
  ASSERT_EQ(least.size(), asked.size());
  for (std::size_t q = 0; q < asked.size(); ++q) {
    const long long k = asked[q] / 7;
    ASSERT_EQ(least[q].has_value(), k < 20) << k;
    if (k >= 20)
      continue;
    EXPECT_EQ(*least[q], 100 * k + (k % 5 == 0 ? 0 : k % ranks));
    EXPECT_EQ(*most[q], 100 * k + (k % 5 == 0 ? ranks - 1 : k % ranks));
  }
}

TEST(Rendezvous, who_has_nothing_to_say_takes_part) {
  const auto comm = testComm();
  std::vector<std::pair<long long, double>> known;
  std::vector<long long> asked;
  if (comm->getRank() == comm->getSize() - 1)
    known.emplace_back(3, 0.5);
  if (comm->getRank() == 0)
    asked = {4, 3};
  const auto answers = lookUp(*comm, known, asked);
  ASSERT_EQ(answers.size(), asked.size());
  if (comm->getRank() == 0) {
    EXPECT_FALSE(answers[0]);
    EXPECT_EQ(answers[1], 0.5);
  }
}

// Keys in steps, as the numbers of nodes along the side of a block are: no rank has much more than its share.
TEST(Rendezvous, homes_are_spread) {
  const auto comm = testComm();
  const auto ranks = static_cast<std::size_t>(comm->getSize());
  for (const long long step : {1LL, 2LL, 4LL, 12LL, 64LL, 1001LL}) {
    std::vector<int> counts(ranks, 0);
    for (long long k = 0; k < 4000; ++k)
      ++counts[homeOf(k * step, *comm)];
    for (int count : counts) // a binomial distribution: six standard deviations, at most 6 √(4000/4)
      EXPECT_NEAR(count, 4000.0 / static_cast<double>(ranks), 190.0) << step;
  }
}

// Against a list that is sorted as a whole; keys mixed among ranks, of very different counts, some equal.
TEST(GlobalOrder, sums_before_are_those_of_one_list) {
  const auto comm = testComm();
  const int rank = comm->getRank(), ranks = comm->getSize();
  struct Item {
    OrderKey key;
    int rank;
    long long weight;
    bool operator<(const Item& other) const { return std::tie(key, rank) < std::tie(other.key, other.rank); }
  };
  for (const int size : {0, 1, 7, 500}) {
    std::vector<Item> all;
    for (int r = 0; r < ranks; ++r)
      for (int k = 0; k < (r == 1 ? 10 * size : r == 3 ? 0 : size); ++k)
        all.push_back({{(k * 37 + r * 11) % 3, (k * k * 7919LL + r * 3) % 10007}, r, 1 + (k + r) % 4});
    std::stable_sort(all.begin(), all.end());
    std::vector<OrderKey> keys;
    std::vector<long long> weights, expected;
    long long sum = 0;
    for (const Item& item : all) {
      if (item.rank == rank) {
        keys.push_back(item.key);
        weights.push_back(item.weight);
        expected.push_back(sum);
      }
      sum += item.weight;
    }
    EXPECT_EQ(sumsBefore(*comm, keys, weights), expected) << size;
  }
}

TEST(GlobalOrder, keys_that_fall_are_refused_on_all_ranks) {
  const auto comm = testComm();
  std::vector<OrderKey> keys;
  if (comm->getRank() == 0)
    keys = {{1, 0}, {0, 0}};
  EXPECT_THROW(sumsBefore(*comm, keys, std::vector<long long>(keys.size(), 1)), InternalError);
}

} // namespace test_rendezvous
