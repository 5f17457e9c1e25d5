// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CopiesOfNodes.hpp"

#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace Harmos::scene {
namespace {

struct Copies {
  std::array<double, 3> sum;
  double count;
};

// @param change(copies, values) of each copy.
template<class Change>
void changeCopies(const Teuchos::Comm<int>& comm, int components, const std::vector<OwnedSubdomain>& owned,
                  feti::TornVector& values, const Change& change) {
  const auto width = static_cast<std::size_t>(components);
  const auto visit = [&](const auto& take) {
    for (std::size_t i = 0; i < owned.size(); ++i) {
      const fem::PlacedMesh& placed = owned[i].mesh;
      for (std::size_t b = 0; b < placed.boundaryNumbers.size(); ++b)
        take(placed.boundaryNumbers[b],
             values[i].data() + static_cast<std::size_t>(placed.mesh->boundary[b]) * width);
    }
  };
  std::vector<std::pair<long long, Copies>> known;
  std::vector<long long> asked;
  visit([&](long long number, const double* mine) {
    Copies copy = {{}, 1.0};
    std::copy_n(mine, width, copy.sum.begin());
    known.emplace_back(number, copy);
    asked.push_back(number);
  });
  const auto all = lookUpMerged(comm, known, asked, [](Copies& present, const Copies& next) {
    for (std::size_t d = 0; d < 3; ++d)
      present.sum[d] += next.sum[d];
    present.count += next.count;
  });
  std::size_t place = 0;
  visit([&](long long, double* mine) { change(*all[place++], mine); });
}

} // namespace

double joinCopies(const Teuchos::Comm<int>& comm, int components, const std::vector<OwnedSubdomain>& owned,
                  feti::TornVector& values) {
  double largest = 0.0;
  changeCopies(comm, components, owned, values, [&](const Copies& copies, double* mine) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(components) && copies.count > 1.0; ++d) {
      const double mean = copies.sum[d] / copies.count;
      largest = std::max(largest, std::abs(mine[d] - mean));
      mine[d] = mean;
    }
  });
  return globalMax(comm, largest);
}

void addCopies(const Teuchos::Comm<int>& comm, int components, const std::vector<OwnedSubdomain>& owned,
               feti::TornVector& values) {
  changeCopies(comm, components, owned, values, [&](const Copies& copies, double* mine) {
    std::copy_n(copies.sum.begin(), static_cast<std::size_t>(components), mine);
  });
}

} // namespace Harmos::scene
