// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FeasibleSet.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::qp {

LocalDiscs::LocalDiscs(std::vector<Disc> discs, std::size_t length)
    : discs_(std::move(discs)), length_(length) {
  std::vector<char> isTaken(length, 0);
  for (const Disc& disc : discs_)
    for (int entry : {disc.first, disc.second}) {
      const auto place = static_cast<std::size_t>(entry);
      HARMOS_REQUIRE(entry >= 0 && place < length && isTaken[place] == 0,
                     "entries of discs are local indices, each in one disc alone");
      isTaken[place] = 1;
    }
  for (std::size_t begin = 0; begin < length;) {
    std::size_t end = begin;
    while (end < length && isTaken[end] == 0)
      ++end;
    if (end > begin)
      others_.emplace_back(begin, end);
    begin = end + 1;
  }
}

double LocalDiscs::largest() const {
  double result = 0.0;
  for (const Disc& disc : discs_)
    result = std::max(result, std::abs(disc.centre[0]) + std::abs(disc.centre[1]) + disc.radius);
  return result;
}

} // namespace Harmos::qp
