// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_Comm.hpp>

#include <array>
#include <vector>

namespace Harmos {

/// Compared entry by entry.
using OrderKey = std::array<long long, 2>;

/// Of each of this rank's keys the sum of the weights of all keys, on any rank, that come before it: with
/// weights of one its place among all. Equal keys follow each other by rank. No rank sees all keys: they meet
/// in shares that samples cut, of about the same size (sample sort; Frazer, McKellar: J. ACM 17, 1970).
/// @param keys rising. @param weights of each, ≥ 0.
/// @note Collective. Guarded by tests/unit/core/test_rendezvous.cpp.
std::vector<long long> sumsBefore(const Teuchos::Comm<int>& comm, const std::vector<OrderKey>& keys,
                                  const std::vector<long long>& weights);

} // namespace Harmos
