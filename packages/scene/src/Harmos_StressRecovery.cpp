// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StressRecovery.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <map>

namespace Harmos::scene {
namespace {

struct NodalShare {
  long long node;
  fem::Voigt weighted;
  double size;
};

} // namespace

std::vector<std::vector<fem::Voigt>> recoverStress(const Teuchos::Comm<int>& comm, const Scene& scene,
                                                   const std::vector<OwnedSubdomain>& owned,
                                                   const feti::TornVector& displacement) {
  std::vector<fem::StressSums> sums;
  agree(comm, [&] {
    std::vector<double> temperature(scene.bodies.size(), 0.0);
    for (const auto& effect : scene.effects)
      for (int b : effect->bodies())
        temperature[static_cast<std::size_t>(b)] += effect->temperatureRise(b);
    for (std::size_t i = 0; i < owned.size(); ++i) {
      const auto b = static_cast<std::size_t>(owned[i].body);
      sums.push_back(fem::stressSums(*owned[i].mesh.mesh, elasticityOf(scene, scene.bodies[b]),
                                     displacement[i], temperature[b]));
    }
  });
  // Copies meet on the rank that their number names, and the sums go back.
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  std::vector<std::vector<NodalShare>> sends(ranks);
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (std::size_t k = 0; k < owned[i].mesh.boundaryNumbers.size(); ++k) {
      const long long number = owned[i].mesh.boundaryNumbers[k];
      const auto node = static_cast<std::size_t>(owned[i].mesh.mesh->boundary[k]);
      sends[static_cast<std::size_t>(number) % ranks].push_back(
          {number, sums[i].weighted[node], sums[i].size[node]});
    }
  std::vector<std::vector<NodalShare>> received = exchangeItems(comm, sends);
  std::map<long long, NodalShare> total;
  for (const std::vector<NodalShare>& part : received)
    for (const NodalShare& share : part) {
      NodalShare& sum = total.emplace(share.node, NodalShare{share.node, {}, 0.0}).first->second;
      sum.size += share.size;
      for (std::size_t r = 0; r < 6; ++r)
        sum.weighted[r] += share.weighted[r];
    }
  for (std::vector<NodalShare>& part : received)
    for (NodalShare& share : part)
      share = total.at(share.node);
  const std::vector<std::vector<NodalShare>> answers = exchangeItems(comm, received);
  std::vector<std::size_t> next(ranks, 0); // answers come in the order of the questions
  for (std::size_t i = 0; i < owned.size(); ++i)
    for (std::size_t k = 0; k < owned[i].mesh.boundaryNumbers.size(); ++k) {
      const std::size_t r = static_cast<std::size_t>(owned[i].mesh.boundaryNumbers[k]) % ranks;
      const NodalShare& share = answers[r][next[r]++];
      const auto node = static_cast<std::size_t>(owned[i].mesh.mesh->boundary[k]);
      sums[i].weighted[node] = share.weighted;
      sums[i].size[node] = share.size;
    }
  std::vector<std::vector<fem::Voigt>> result;
  for (fem::StressSums& sum : sums) {
    for (std::size_t node = 0; node < sum.weighted.size(); ++node)
      for (double& entry : sum.weighted[node])
        entry /= sum.size[node];
    result.push_back(std::move(sum.weighted));
  }
  return result;
}

} // namespace Harmos::scene
