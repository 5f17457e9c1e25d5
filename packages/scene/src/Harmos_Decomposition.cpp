// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Decomposition.hpp"

#include "Harmos_Assembly.hpp"

#include <algorithm>
#include <map>

namespace Harmos::scene {
namespace {

// Load vectors, of which those that are the same exist once: the key is what a load looks like from within
// the subdomain, the boxes cut to it, relative to its anchor.
class LoadCache {
 public:
  std::shared_ptr<const std::vector<double>> of(const fem::PlacedMesh& placed,
                                                const std::vector<fem::BoxLoad>& loads) {
    const std::vector<fem::BoxLoad> local = fem::localLoads(placed, loads);
    Key key = {placed.mesh.get(), {}};
    for (const fem::BoxLoad& load : local)
      for (double entry : {load.value, load.least[0], load.least[1], load.most[0], load.most[1]})
        key.second.push_back(entry);
    std::shared_ptr<const std::vector<double>>& load = loads_[key];
    if (!load)
      load = std::make_shared<std::vector<double>>(fem::assembleLoad(*placed.mesh, local));
    return load;
  }

 private:
  using Key = std::pair<const fem::Mesh*, std::vector<double>>;
  std::map<Key, std::shared_ptr<const std::vector<double>>> loads_;
};

} // namespace

std::vector<OwnedSubdomain> decompose(const Scene& scene, int rank, int ranks) {
  const long long total = scene.subdomains();
  const long long begin = total * rank / ranks, end = total * (rank + 1) / ranks;
  std::vector<OwnedSubdomain> owned;
  long long first = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    for (long long number = std::max(begin, first); number < std::min(end, first + body.subdomains); ++number)
      owned.push_back({number, static_cast<int>(b), body.subdomain(static_cast<int>(number - first))});
    first += body.subdomains;
  }
  return owned;
}

std::vector<feti::Subdomain> assemble(const Scene& scene, const std::vector<OwnedSubdomain>& owned) {
  std::map<const fem::Mesh*, std::shared_ptr<const LocalMatrix>> matrices;
  std::map<int, std::shared_ptr<const feti::Kernel>> kernels;
  LoadCache loads;
  std::vector<feti::Subdomain> result;
  for (const OwnedSubdomain& item : owned) {
    const Body& body = scene.bodies[static_cast<std::size_t>(item.body)];
    std::shared_ptr<const LocalMatrix>& matrix = matrices[item.mesh.mesh.get()];
    if (!matrix)
      matrix = std::make_shared<LocalMatrix>(fem::assembleLaplace(*item.mesh.mesh));
    const int nodes = item.mesh.mesh->numberOfNodes();
    std::shared_ptr<const feti::Kernel>& kernel = kernels[nodes];
    if (!kernel)
      kernel = std::make_shared<feti::Kernel>(feti::constantKernel(nodes));

    feti::Subdomain subdomain;
    subdomain.number = item.number;
    subdomain.stiffness = matrix;
    subdomain.motions = kernel;
    subdomain.load = loads.of(item.mesh, body.bodyForce);
    subdomain.interface = {item.mesh.mesh, &item.mesh.mesh->boundary};
    subdomain.numbers = item.mesh.boundaryNumbers;
    for (const Body::PrescribedDisplacement& prescribed : body.prescribed) {
      const auto set = item.mesh.sets.find(prescribed.set);
      if (set != item.mesh.sets.end())
        for (int node : set->second)
          subdomain.fixed.push_back({node, prescribed.value});
    }
    result.push_back(std::move(subdomain));
  }
  return result;
}

} // namespace Harmos::scene
