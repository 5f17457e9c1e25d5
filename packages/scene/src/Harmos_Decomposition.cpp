// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Decomposition.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Assembly.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_TornBody.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace Harmos::scene {
namespace {

// Load vectors of membranes, of which those that are the same exist once: the key is what a load looks like
// from within the subdomain, the boxes cut to it, relative to its anchor.
class BoxLoads {
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

void addTo(std::vector<double>& sum, const std::vector<double>& more) {
  for (std::size_t k = 0; k < sum.size(); ++k)
    sum[k] += more[k];
}

// All loads of an elastic subdomain; those without any share a vector of zeros.
class ElasticLoads {
 public:
  std::shared_ptr<const std::vector<double>> of(const fem::PlacedMesh& placed, const Body& body,
                                                const fem::Elasticity& elasticity) {
    const fem::Mesh& mesh = *placed.mesh;
    const auto dofs = static_cast<std::size_t>(mesh.numberOfNodes() * mesh.dimension());
    const auto hasSides = [&](const Body::Traction& traction) {
      return placed.sides.count(traction.set) > 0;
    };
    if (body.forces.empty() && body.temperature == 0.0 &&
        std::none_of(body.tractions.begin(), body.tractions.end(), hasSides)) {
      std::shared_ptr<const std::vector<double>>& zero = zeros_[dofs];
      if (!zero)
        zero = std::make_shared<std::vector<double>>(dofs, 0.0);
      return zero;
    }
    const auto load = std::make_shared<std::vector<double>>(dofs, 0.0);
    for (const fem::VectorField& force : body.forces)
      addTo(*load, fem::assembleBodyForce(mesh, placed.anchor, force));
    for (const Body::Traction& traction : body.tractions)
      if (hasSides(traction))
        addTo(*load,
              fem::assembleTraction(mesh, placed.anchor, placed.sides.at(traction.set), traction.density));
    if (body.temperature != 0.0)
      addTo(*load, fem::assembleThermalLoad(mesh, elasticity, body.temperature));
    return load;
  }

 private:
  std::map<std::size_t, std::shared_ptr<const std::vector<double>>> zeros_;
};

// What subdomains of the same mesh and body share.
struct SharedParts {
  std::shared_ptr<const LocalMatrix> stiffness;
  std::shared_ptr<const feti::Kernel> motions;
  std::shared_ptr<const std::vector<int>> interface;
};

SharedParts sharedParts(const Scene& scene, const Body& body, const std::shared_ptr<const fem::Mesh>& mesh) {
  const int components = scene.components();
  SharedParts parts;
  if (scene.physics == Physics::Membrane) {
    parts.stiffness = std::make_shared<LocalMatrix>(fem::assembleLaplace(*mesh));
    parts.motions = std::make_shared<feti::Kernel>(feti::constantKernel(mesh->numberOfNodes()));
    parts.interface = {mesh, &mesh->boundary};
    return parts;
  }
  parts.stiffness = std::make_shared<LocalMatrix>(fem::assembleElasticity(*mesh, elasticityOf(scene, body)));
  parts.motions = std::make_shared<feti::Kernel>(feti::rigidBodyKernel(mesh->coordinates, mesh->dimension()));
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
                         " dimensions in a scene of " + std::to_string(dimension) +
                         "; choose another physics or another mesh",
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

fem::Elasticity elasticityOf(const Scene& scene, const Body& body) {
  return {kinematicsOf(scene.physics), body.dilatation, body.materials};
}

Share shareOf(int rank, int ranks, long long subdomains) {
  return {subdomains * rank / ranks, subdomains * (rank + 1) / ranks};
}

std::vector<OwnedSubdomain> decompose(const Teuchos::Comm<int>& comm, const Scene& scene) {
  const long long total = scene.subdomains();
  const int rank = comm.getRank(), ranks = comm.getSize();
  const Share share = shareOf(rank, ranks, total);
  std::vector<OwnedSubdomain> owned;
  long long first = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    const long long begin = std::max(share.begin, first), end = std::min(share.end, first + body.subdomains);
    if (body.subdomain) {
      agree(comm, [&] {
        for (long long number = begin; number < end; ++number)
          owned.push_back({number, static_cast<int>(b), body.subdomain(static_cast<int>(number - first))});
      });
    } else {
      std::vector<int> owner;
      int r = 0;
      for (long long number = first; number < first + body.subdomains; ++number) {
        while (shareOf(r, ranks, total).end <= number)
          ++r;
        owner.push_back(r);
      }
      static const std::vector<fem::PlacedMesh> none;
      std::vector<fem::PlacedMesh> mine = fem::distribute(comm, body.onRoot ? *body.onRoot : none, owner);
      for (std::size_t k = 0; k < mine.size(); ++k)
        owned.push_back({begin + static_cast<long long>(k), static_cast<int>(b), std::move(mine[k])});
    }
    first += body.subdomains;
  }
  return owned;
}

namespace {

// Names of boundary parts, body after body: all, and those that have sides.
struct PartNames {
  std::vector<std::set<std::string>> all, withSides;
};

// Collective: names travel as text, a line each.
PartNames gatherPartNames(const Teuchos::Comm<int>& comm, std::size_t bodies,
                          const std::vector<OwnedSubdomain>& owned) {
  std::set<std::string> lines;
  for (const OwnedSubdomain& item : owned) {
    for (const auto& set : item.mesh.sets)
      lines.insert(std::to_string(item.body) + " n" + set.first + '\n');
    for (const auto& sides : item.mesh.sides)
      lines.insert(std::to_string(item.body) + " s" + sides.first + '\n');
  }
  std::vector<char> text;
  for (const std::string& line : lines)
    text.insert(text.end(), line.begin(), line.end());
  PartNames names;
  names.all.resize(bodies);
  names.withSides.resize(bodies);
  const std::vector<char> all = gatherAll(comm, text);
  for (auto begin = all.begin(); begin != all.end();) {
    const auto space = std::find(begin, all.end(), ' '), end = std::find(begin, all.end(), '\n');
    const std::size_t body = std::stoul(std::string(begin, space));
    names.all[body].insert(std::string(space + 2, end));
    if (*(space + 1) == 's')
      names.withSides[body].insert(std::string(space + 2, end));
    begin = end + 1;
  }
  return names;
}

void requireBody(const Scene& scene, int body, const std::string& what) {
  if (body < 0 || body >= static_cast<int>(scene.bodies.size()))
    throw InputError(what + " names body number " + std::to_string(body) + ", but the scene has " +
                     std::to_string(scene.bodies.size()) + " bodies");
}

void requirePart(const Scene& scene, const PartNames& names, int b, const std::string& set,
                 const std::string& what, bool needsSides) {
  requireBody(scene, b, what);
  const auto body = static_cast<std::size_t>(b);
  const std::set<std::string>& known = needsSides ? names.withSides[body] : names.all[body];
  if (known.count(set) > 0)
    return;
  const std::vector<std::string> candidates(known.begin(), known.end());
  const std::string nearest = nearestName(set, candidates);
  std::string list;
  for (const std::string& name : candidates)
    list += (list.empty() ? "\"" : ", \"") + name + "\"";
  throw InputError(what + " names the boundary part \"" + set + "\" of body \"" + scene.bodies[body].name +
                       (names.all[body].count(set) > 0
                            ? "\", which has nodes but no sides of cells on the boundary"
                            : "\", which it does not have") +
                       (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?") +
                       (list.empty() ? " (it has none)" : " (it has " + list + ")"),
                   {{"set", set}, {"body", scene.bodies[body].name}});
}

} // namespace

void checkBoundaryParts(const Teuchos::Comm<int>& comm, const Scene& scene,
                        const std::vector<OwnedSubdomain>& owned) {
  const PartNames names = gatherPartNames(comm, scene.bodies.size(), owned);
  // From here on every rank has the same data and meets the same errors.
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    for (const Body::PrescribedDisplacement& prescribed : body.prescribed) {
      requirePart(scene, names, static_cast<int>(b), prescribed.set, "a prescribed displacement", false);
      if (prescribed.component < 0 || prescribed.component >= scene.components())
        throw InputError("a prescribed displacement of body \"" + body.name + "\" is of component " +
                         std::to_string(prescribed.component) + ", but a node has " +
                         std::to_string(scene.components()));
    }
    for (const Body::Traction& traction : body.tractions)
      requirePart(scene, names, static_cast<int>(b), traction.set, "a traction", true);
  }
  for (const Interface& interface : scene.interfaces) {
    const std::string what = interface.kind == Interface::Kind::Tie ? "a tie" : "a contact";
    requirePart(scene, names, interface.firstBody, interface.firstSet, what, true);
    requirePart(scene, names, interface.secondBody, interface.secondSet, what, true);
  }
  for (const ObstacleContact& obstacle : scene.obstacles)
    requirePart(scene, names, obstacle.body, obstacle.set, "obstacle \"" + obstacle.name + "\"", true);
}

std::vector<feti::Subdomain> assemble(const Scene& scene, const std::vector<OwnedSubdomain>& owned) {
  std::map<std::pair<const fem::Mesh*, int>, SharedParts> shared;
  BoxLoads boxLoads;
  ElasticLoads elasticLoads;
  const int components = scene.components();
  std::vector<feti::Subdomain> result;
  for (const OwnedSubdomain& item : owned) {
    const Body& body = scene.bodies[static_cast<std::size_t>(item.body)];
    const bool isMembrane = scene.physics == Physics::Membrane;
    feti::Subdomain subdomain;
    subdomain.number = item.number;
    try {
      SharedParts& parts = shared[{item.mesh.mesh.get(), item.body}];
      if (!parts.stiffness) {
        checkBody(scene, body, *item.mesh.mesh);
        parts = sharedParts(scene, body, item.mesh.mesh);
      }
      subdomain.stiffness = parts.stiffness;
      subdomain.motions = parts.motions;
      subdomain.interface = parts.interface;
      subdomain.load = isMembrane ? boxLoads.of(item.mesh, body.bodyForce)
                                  : elasticLoads.of(item.mesh, body, elasticityOf(scene, body));
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
    for (const Body::PrescribedDisplacement& prescribed : body.prescribed) {
      const auto set = item.mesh.sets.find(prescribed.set);
      if (set != item.mesh.sets.end())
        for (int node : set->second)
          subdomain.fixed.push_back(
              {node * components + prescribed.component,
               prescribed.field ? prescribed.field(item.mesh.position(node)) : prescribed.value});
    }
    result.push_back(std::move(subdomain));
  }
  return result;
}

} // namespace Harmos::scene
