// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RigidTurns.hpp"

#include "Harmos_Exchange.hpp"

namespace Harmos::run {

void RigidTurns::add(int body, const fem::PlacedMesh& mesh, const std::vector<double>& from,
                     const std::vector<double>& change) {
  double* sums = &sums_[static_cast<std::size_t>(body) * width];
  for (std::size_t k = 0; k < from.size(); k += components_) {
    const fem::Point place = mesh.position(static_cast<int>(k / components_));
    sums[0] += 1.0;
    for (std::size_t a = 0; a < components_; ++a) {
      const double x = place[a] + from[k + a];
      sums[1 + a] += x;
      for (std::size_t b = 0; b < components_; ++b) {
        sums[4 + 3 * b + a] += x * (place[b] + from[k + b]);
        sums[13 + 3 * b + a] += x * change[k + b];
      }
      sums[22 + a] += change[k + a];
    }
  }
}

void RigidTurns::sumUp(const Teuchos::Comm<int>& comm) {
  globalSum(comm, sums_);
}

fem::Point RigidTurns::centreOf(int body) const {
  const double* sums = &sums_[static_cast<std::size_t>(body) * width];
  return {sums[1] / sums[0], sums[2] / sums[0], sums[3] / sums[0]};
}

std::optional<fem::Tensor> RigidTurns::excessOf(int body) const {
  const double* sums = &sums_[static_cast<std::size_t>(body) * width];
  const fem::Point centre = centreOf(body);
  fem::Tensor square{}, change{};
  double trace = 0.0;
  for (std::size_t a = 0; a < components_; ++a)
    for (std::size_t b = 0; b < components_; ++b) {
      square[a][b] = sums[4 + 3 * a + b] - centre[a] * centre[b] * sums[0];
      change[a][b] = sums[13 + 3 * a + b] - sums[22 + a] * centre[b];
      trace += a == b ? square[a][a] : 0.0;
    }
  if (components_ == 2)
    square[2][2] = trace;
  const double det = fem::determinant(square);
  constexpr double flat = 1e-9;
  if (!(det > flat * trace * trace * trace))
    return std::nullopt;
  const fem::Tensor inverse = fem::inverseTransposed(square, det); // symmetric
  fem::Tensor half{}, less{}, result{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 3; ++c)
        half[a][b] += 0.25 * (change[a][c] * inverse[c][b] - change[b][c] * inverse[c][a]);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      less[b][a] = (a == b ? 1.0 : 0.0) - half[a][b];
  const fem::Tensor factor = fem::inverseTransposed(less, fem::determinant(less));
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t d = 0; d < 3; ++d)
          result[a][b] += 2.0 * factor[a][c] * half[c][d] * half[d][b];
  return result;
}

} // namespace Harmos::run
