// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Decomposition.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Assembly.hpp"
#include "Harmos_BoundaryRules.hpp"
#include "Harmos_CompactOrder.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Loads.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_SubdomainEffects.hpp"
#include "Harmos_TornBody.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace Harmos::scene {
namespace {

// What subdomains of the same mesh and body share.
struct SharedParts {
  SubdomainEffects::Stiffness elastic;
  std::shared_ptr<const std::vector<int>> interface;
  fem::Point centre{}; ///< of the nodes, relative to the anchor
};

fem::Point centreOf(const fem::Mesh& mesh) {
  fem::Point centre{};
  const auto d = static_cast<std::size_t>(mesh.dimension());
  for (std::size_t k = 0; k < mesh.coordinates.size(); ++k)
    centre[k % d] += mesh.coordinates[k] / mesh.numberOfNodes();
  return centre;
}

SharedParts sharedParts(const Scene& scene, const Body& body, const std::shared_ptr<const fem::Mesh>& mesh) {
  const int components = scene.components();
  SharedParts parts;
  parts.centre = centreOf(*mesh);
  if (scene.physics == Physics::Membrane) {
    parts.elastic.matrix = std::make_shared<LocalMatrix>(fem::assembleLaplace(*mesh));
    parts.elastic.motions = std::make_shared<feti::Kernel>(feti::constantKernel(mesh->numberOfNodes()));
    parts.interface = {mesh, &mesh->boundary};
    return parts;
  }
  parts.elastic.matrix =
      std::make_shared<LocalMatrix>(fem::assembleElasticity(*mesh, elasticityOf(scene, body)));
  parts.elastic.motions = std::make_shared<feti::Kernel>(
      mesh->isAxisymmetric ? feti::translationKernel(mesh->numberOfNodes() * components, components, 1)
                           : feti::rigidBodyKernel(mesh->coordinates, mesh->dimension()));
  const auto interface = std::make_shared<std::vector<int>>();
  for (int node : mesh->boundary)
    for (int c = 0; c < components; ++c)
      interface->push_back(node * components + c);
  parts.interface = interface;
  return parts;
}

void checkBody(const Scene& scene, const Body& body, const fem::Mesh& mesh) {
  const int dimension = scene.physics == Physics::Solid ? 3 : 2;
  if (mesh.dimension() != dimension)
    throw InputError("body \"" + body.name + "\" has cells of " + std::to_string(mesh.dimension()) +
                         " dimensions in a scene of dimension " + std::to_string(dimension) +
                         "; change the physics or the mesh",
                     {{"body", body.name}});
  if (scene.physics == Physics::Membrane)
    return;
  int regions = 1;
  for (int region : mesh.regions)
    regions = std::max(regions, region + 1);
  if (static_cast<int>(body.materials.size()) < regions)
    throw InputError("body \"" + body.name + "\" has " + std::to_string(regions) +
                         " regions, but materials for " + std::to_string(body.materials.size()) +
                         "; name a material for each",
                     {{"body", body.name}});
  for (const fem::Material& material : body.materials)
    material.check("of body " + body.name);
}

} // namespace

Share shareOf(int rank, int ranks, long long subdomains) {
  return {subdomains * rank / ranks, subdomains * (rank + 1) / ranks};
}

namespace {

fem::Point centreOf(const fem::PlacedMesh& placed, std::map<const fem::Mesh*, fem::Point>& known) {
  const auto [place, isNew] = known.emplace(placed.mesh.get(), fem::Point());
  if (isNew)
    place->second = centreOf(*placed.mesh);
  fem::Point centre = place->second;
  for (std::size_t d = 0; d < 3; ++d)
    centre[d] += placed.anchor[d];
  return centre;
}

// Part of a body by number. Each rank looks at those that it would have anyway, rank 0 at meshes that it
// alone has.
std::vector<int> orderOf(const Teuchos::Comm<int>& comm, const Body& body, long long first, long long total) {
  const int ranks = comm.getSize();
  std::vector<long long> sizes;
  const auto within = [&](int rank) {
    const Share share = shareOf(rank, ranks, total);
    const long long begin = std::clamp(share.begin, first, first + body.subdomains);
    return Share{begin, std::clamp(share.end, begin, first + body.subdomains)};
  };
  for (int r = 0; r < ranks; ++r)
    if (const Share share = within(r); share.end > share.begin)
      sizes.push_back(share.end - share.begin);
  std::vector<fem::Point> centres;
  std::map<const fem::Mesh*, fem::Point> known;
  agree(comm, [&] {
    const Share mine = within(comm.getRank());
    if (body.subdomain)
      for (long long number = mine.begin; number < mine.end; ++number)
        centres.push_back(centreOf(body.subdomain(static_cast<int>(number - first)), known));
    else if (body.onRoot)
      for (const fem::PlacedMesh& placed : *body.onRoot)
        centres.push_back(centreOf(placed, known));
  });
  return compactOrder(gatherAll(comm, centres), sizes);
}

// Moves the anchors of meridian planes onto the axis: matrices depend on the distance from it. Subdomains of
// one mesh at one distance still share it.
void placeAroundAxis(const Scene& scene, std::vector<OwnedSubdomain>& owned) {
  std::map<std::pair<const fem::Mesh*, double>, std::shared_ptr<const fem::Mesh>> made;
  std::vector<std::shared_ptr<const fem::Mesh>> before; // no other mesh gets the place of one
  for (OwnedSubdomain& item : owned) {
    before.push_back(item.mesh.mesh);
    std::shared_ptr<const fem::Mesh>& mesh = made[{item.mesh.mesh.get(), item.mesh.anchor[0]}];
    if (!mesh) {
      auto copy = std::make_shared<fem::Mesh>(*item.mesh.mesh);
      copy->isAxisymmetric = true;
      double least = 0.0, most = 0.0;
      for (std::size_t k = 0; k < copy->coordinates.size(); k += 2) {
        const double x = copy->coordinates[k] += item.mesh.anchor[0];
        least = std::min(least, x);
        most = std::max(most, x);
      }
      constexpr double rounding = 1e-12;
      if (least < -rounding * most)
        throw InputError("body \"" + scene.bodies[static_cast<std::size_t>(item.body)].name +
                             "\" reaches to x = " + scientific(least) +
                             ", beyond the axis of an axisymmetric scene, x = 0; move or mirror it",
                         {{"body", scene.bodies[static_cast<std::size_t>(item.body)].name}});
      mesh = copy;
    }
    item.mesh.mesh = mesh;
    item.mesh.anchor[0] = 0.0;
  }
}

// Subdomains of one mesh and body still share it.
void takeThickness(const Scene& scene, std::vector<OwnedSubdomain>& owned) {
  std::map<std::pair<const fem::Mesh*, int>, std::shared_ptr<const fem::Mesh>> made;
  std::vector<std::shared_ptr<const fem::Mesh>> before; // no other mesh gets the place of one
  for (OwnedSubdomain& item : owned) {
    const std::vector<double>& thickness = scene.bodies[static_cast<std::size_t>(item.body)].thickness;
    if (thickness.empty())
      continue;
    before.push_back(item.mesh.mesh);
    std::shared_ptr<const fem::Mesh>& mesh = made[{item.mesh.mesh.get(), item.body}];
    if (!mesh) {
      auto copy = std::make_shared<fem::Mesh>(*item.mesh.mesh);
      copy->thickness = thickness;
      mesh = copy;
    }
    item.mesh.mesh = mesh;
  }
}

// OwnedSubdomain::ownNodes of the parts that effects count. @note Collective.
void findOwnNodes(const Teuchos::Comm<int>& comm, const Scene& scene, std::vector<OwnedSubdomain>& owned) {
  std::set<std::pair<int, std::string>> counted;
  for (const auto& effect : scene.effects)
    for (const Effect::BoundaryPart& part : effect->boundaryParts())
      if (part.countsNodes)
        counted.emplace(part.body, part.set);
  if (counted.empty())
    return;
  std::vector<std::pair<long long, long long>> known; // node, subdomain
  std::vector<long long> asked;
  const auto visit = [&](const auto& take) {
    for (OwnedSubdomain& item : owned)
      for (const auto& [name, nodes] : item.mesh.sets)
        if (counted.count({item.body, name}) > 0)
          for (int node : nodes)
            take(item, name, node);
  };
  visit([&](const OwnedSubdomain& item, const std::string&, int node) {
    known.emplace_back(item.mesh.number(node), item.number);
    asked.push_back(known.back().first);
  });
  const std::vector<std::optional<long long>> lowest =
      lookUp(comm, known, asked, [](long long next, long long present) { return next < present; });
  std::size_t k = 0;
  visit([&](OwnedSubdomain& item, const std::string& name, int node) {
    if (*lowest[k++] == item.number)
      item.ownNodes[name].push_back(node);
  });
}

} // namespace

void measureParts(const Teuchos::Comm<int>& comm, const Scene& scene, std::vector<OwnedSubdomain>& owned) {
  std::set<std::pair<int, std::string>> measured;
  for (const auto& effect : scene.effects)
    for (const Effect::BoundaryPart& part : effect->boundaryParts())
      if (part.isMeasured)
        measured.emplace(part.body, part.set);
  for (const auto& [body, set] : measured) {
    std::vector<double> sums(4, 0.0); // ∫n, area
    agree(comm, [&] {
      for (const OwnedSubdomain& item : owned) {
        const auto sides = item.mesh.sides.find(set);
        if (item.body != body || sides == item.mesh.sides.end())
          continue;
        constexpr int degree = 4;
        fem::visitSides(*item.mesh.mesh, sides->second, degree, [&](const fem::SidePoint& point) {
          for (std::size_t d = 0; d < 3; ++d)
            sums[d] += point.measure * point.normal[d];
          sums[3] += point.measure;
        });
      }
    });
    globalSum(comm, sums);
    for (OwnedSubdomain& item : owned)
      if (item.body == body)
        item.measures[set] = {sums[3], {sums[0], sums[1], sums[2]}};
  }
}

std::vector<OwnedSubdomain> decompose(const Teuchos::Comm<int>& comm, const Scene& scene,
                                      Numbering numbering) {
  const long long total = scene.subdomains();
  const int rank = comm.getRank(), ranks = comm.getSize();
  const Share share = shareOf(rank, ranks, total);
  std::vector<OwnedSubdomain> owned;
  long long first = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    const long long begin = std::max(share.begin, first), end = std::min(share.end, first + body.subdomains);
    std::vector<int> order;
    if (numbering == Numbering::Compact)
      order = orderOf(comm, body, first, total);
    const auto partOf = [&](long long number) {
      const auto place = static_cast<std::size_t>(number - first);
      return order.empty() ? static_cast<int>(place) : order[place];
    };
    if (body.subdomain) {
      agree(comm, [&] {
        for (long long number = begin; number < end; ++number)
          owned.push_back({number, static_cast<int>(b), body.subdomain(partOf(number))});
      });
    } else {
      std::vector<int> owner;
      int r = 0;
      for (long long number = first; number < first + body.subdomains; ++number) {
        while (shareOf(r, ranks, total).end <= number)
          ++r;
        owner.push_back(r);
      }
      std::vector<fem::PlacedMesh> ordered;
      if (body.onRoot && !order.empty())
        for (int part : order)
          ordered.push_back((*body.onRoot)[static_cast<std::size_t>(part)]);
      const std::vector<fem::PlacedMesh>& onRoot = body.onRoot && order.empty() ? *body.onRoot : ordered;
      std::vector<fem::PlacedMesh> mine = fem::distribute(comm, onRoot, owner);
      for (std::size_t k = 0; k < mine.size(); ++k)
        owned.push_back({begin + static_cast<long long>(k), static_cast<int>(b), std::move(mine[k])});
    }
    first += body.subdomains;
  }
  if (scene.physics == Physics::Axisymmetric)
    agree(comm, [&] { placeAroundAxis(scene, owned); });
  agree(comm, [&] { takeThickness(scene, owned); });
  chooseBoundaryParts(comm, scene, owned);
  findOwnNodes(comm, scene, owned);
  measureParts(comm, scene, owned);
  return owned;
}

std::vector<feti::Subdomain> assemble(const Scene& scene, const std::vector<OwnedSubdomain>& owned) {
  EffectCosts costs(scene);
  return assemble(scene, owned, costs);
}

std::vector<feti::Subdomain> assemble(const Scene& scene, const std::vector<OwnedSubdomain>& owned,
                                      EffectCosts& costs) {
  std::map<std::pair<const fem::Mesh*, int>, SharedParts> shared;
  SubdomainEffects effects(scene, costs);
  const int components = scene.components();
  std::vector<feti::Subdomain> result;
  for (const OwnedSubdomain& item : owned) {
    const Body& body = scene.bodies[static_cast<std::size_t>(item.body)];
    feti::Subdomain subdomain;
    subdomain.number = item.number;
    try {
      SharedParts& parts = shared[{item.mesh.mesh.get(), item.body}];
      if (!parts.elastic.matrix) {
        checkBody(scene, body, *item.mesh.mesh);
        parts = sharedParts(scene, body, item.mesh.mesh);
      }
      const SubdomainEffects::Stiffness stiffness = effects.stiffness(item, parts.elastic);
      subdomain.stiffness = stiffness.matrix;
      subdomain.motions = stiffness.motions;
      subdomain.interface = parts.interface;
      subdomain.load = effects.load(item);
      subdomain.fixed = effects.countedPrescribed(item);
      subdomain.centre = parts.centre;
      for (std::size_t d = 0; d < 3; ++d)
        (*subdomain.centre)[d] += item.mesh.anchor[d];
    } catch (const NumericalError& error) {
      const fem::Point& anchor = item.mesh.anchor;
      throw InputError("body \"" + body.name + "\", subdomain " + std::to_string(item.number) +
                           " (anchor at " + scientific(anchor[0], 6) + ", " + scientific(anchor[1], 6) +
                           ", " + scientific(anchor[2], 6) + "): " + error.what(),
                       error.data());
    }
    for (long long number : item.mesh.boundaryNumbers)
      for (int c = 0; c < components; ++c)
        subdomain.numbers.push_back(number * components + c);
    result.push_back(std::move(subdomain));
  }
  return result;
}

} // namespace Harmos::scene
