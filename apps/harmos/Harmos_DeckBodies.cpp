// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeckBodies.hpp"

#include "Harmos_AdaptiveRounds.hpp"
#include "Harmos_BlockGeometry.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BodyBlocks.hpp"
#include "Harmos_CutMeshFile.hpp"
#include "Harmos_GmshFile.hpp"
#include "Harmos_PartShape.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_SubdomainChoice.hpp"
#include "Harmos_TornBody.hpp"

#include <Teuchos_CommHelpers.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos::app {
namespace {

using Teuchos::ParameterList;

std::vector<std::string> texts(const ParameterList& list, const std::string& name) {
  const auto& array = list.get<Teuchos::Array<std::string>>(name);
  return {array.begin(), array.end()};
}

template<class T>
std::array<T, 3> triple(const ParameterList& list, const std::string& name) {
  const auto& array = list.get<Teuchos::Array<T>>(name);
  return {array[0], array[1], array[2]};
}

std::vector<std::string> namesIn(const ParameterList& list) {
  std::vector<std::string> names;
  for (auto item = list.begin(); item != list.end(); ++item)
    if (list.entry(item).isList())
      names.push_back(list.name(item));
  return names;
}

// C_11, C_12, C_22, C_13, ...: the upper triangle by columns, in the order 11, 22, 33, 12, 13, 23.
fem::Material anisotropicFrom(const ParameterList& list) {
  const auto& given = list.sublist("Expert").get<Teuchos::Array<double>>("Stiffness");
  if (given.size() != 21)
    throw InputError("\"" + list.name() + "/Stiffness\" has " + std::to_string(given.size()) +
                         " numbers; an anisotropic material has 21",
                     {{"path", list.name() + "/Stiffness"}});
  constexpr std::array<std::size_t, 6> place = {0, 1, 2, 3, 5, 4}; // 23 comes before 13 here
  fem::VoigtMatrix c{};
  Teuchos::Ordinal next = 0;
  for (std::size_t column = 0; column < 6; ++column)
    for (std::size_t row = 0; row <= column; ++row)
      c[place[row]][place[column]] = c[place[column]][place[row]] = given[next++];
  return fem::Material::anisotropic(c);
}

std::array<double, 3> directionIn(const ParameterList& list, const std::string& name) {
  const auto& given = list.sublist("Expert").get<Teuchos::Array<double>>(name);
  if (given.size() != 3)
    throw InputError("\"" + list.name() + "/" + name + "\" has " + std::to_string(given.size()) +
                         " numbers; give both axes, each with three",
                     {{"path", list.name() + "/" + name}});
  return {given[0], given[1], given[2]};
}

bool isIsotropic(const ParameterList& list) {
  const auto& type = list.get<std::string>("Type");
  return type == "isotropic" || type == "neo-Hookean";
}

constexpr double notGiven = -1.0;

// None without a yield stress or a curve.
std::optional<fem::Plasticity> plasticityFrom(const ParameterList& list) {
  const ParameterList& given = list.sublist("Plasticity");
  const auto strains = given.get<Teuchos::Array<double>>("Plastic strains").toVector(),
             stresses = given.get<Teuchos::Array<double>>("Stresses").toVector();
  fem::Plasticity plasticity;
  const double yieldStress = given.get<double>("Yield stress");
  plasticity.isotropic = given.get<double>("Isotropic hardening");
  plasticity.kinematic = given.get<double>("Kinematic hardening");
  const bool hasCurve = !strains.empty() || !stresses.empty();
  const std::string path = "\"" + list.name() + "/Plasticity";
  if (hasCurve && (yieldStress != notGiven || plasticity.isotropic != 0.0))
    throw InputError(path + "\" has a curve, which says yield stress and isotropic hardening; remove \"" +
                         (yieldStress != notGiven ? "Yield stress" : "Isotropic hardening") + "\"",
                     {{"path", path}});
  if (!hasCurve && yieldStress == notGiven && (plasticity.isotropic != 0.0 || plasticity.kinematic != 0.0))
    throw InputError(path + "\" has hardening and no yield stress; give \"Yield stress\"", {{"path", path}});
  if (!hasCurve && yieldStress == notGiven)
    return std::nullopt;
  plasticity.yieldStress = hasCurve && !stresses.empty() ? stresses.front() : yieldStress;
  if (hasCurve)
    plasticity.curve = std::array<std::vector<double>, 2>{strains, stresses};
  return plasticity;
}

fem::Material materialFrom(const ParameterList& list) {
  fem::Material material;
  if (list.get<std::string>("Type") == "anisotropic") {
    material = anisotropicFrom(list);
  } else if (isIsotropic(list)) {
    material =
        fem::Material::isotropic(list.get<double>("Young's modulus"), list.get<double>("Poisson's ratio"));
    if (list.get<std::string>("Type") == "neo-Hookean")
      material.law = fem::Material::Law::NeoHookean;
  } else {
    material.young = triple<double>(list, "Young's moduli");
    material.poisson = triple<double>(list, "Poisson's ratios");
    material.shear = triple<double>(list, "Shear moduli");
  }
  if (!isIsotropic(list)) {
    material.angle = list.get<double>("Angle") * std::acos(-1.0) / 180.0;
    const ParameterList& expert = list.sublist("Expert");
    if (!expert.get<Teuchos::Array<double>>("Axis 1").empty() ||
        !expert.get<Teuchos::Array<double>>("Axis 2").empty())
      material = material.turnedTo(directionIn(list, "Axis 1"), directionIn(list, "Axis 2"));
  }
  material.expansion = triple<double>(list, "Thermal expansion");
  material.density = list.get<double>("Density");
  material.plasticity = plasticityFrom(list);
  return material;
}

fem::Material materialNamed(const ParameterList& deck, const std::string& name, const std::string& body) {
  const ParameterList& materials = deck.sublist("Materials");
  if (!materials.isSublist(name))
    throw InputError("\"Bodies/" + body + "/Materials\" names the material \"" + name +
                         "\", which is not in \"Materials\"" + offer(name, namesIn(materials)),
                     {{"path", "Bodies/" + body + "/Materials"}});
  const fem::Material material = materialFrom(materials.sublist(name));
  material.check(name);
  return material;
}

fem::CellType cellTypeOf(const std::string& name, int dimension) {
  if (dimension == 2)
    return name == "Q1"   ? fem::CellType::Quadrilateral4
           : name == "Q2" ? fem::CellType::Quadrilateral9
           : name == "S2" ? fem::CellType::Quadrilateral8
           : name == "P1" ? fem::CellType::Triangle3
                          : fem::CellType::Triangle6;
  return name == "Q1"   ? fem::CellType::Hexahedron8
         : name == "Q2" ? fem::CellType::Hexahedron27
         : name == "S2" ? fem::CellType::Hexahedron20
         : name == "P1" ? fem::CellType::Tetrahedron4
                        : fem::CellType::Tetrahedron10;
}

std::vector<std::string> groupsOf(const std::string& name, const ParameterList& list) {
  const std::vector<std::string> groups = texts(list, "Groups");
  return groups.empty() ? std::vector<std::string>{name} : groups;
}

fem::Dilatation dilatationOf(const ParameterList& list, const std::vector<fem::Material>& materials) {
  const std::string choice = list.sublist("Expert").get<std::string>("Dilatation");
  const bool project =
      choice == "projected" ||
      (choice == "auto" && std::any_of(materials.begin(), materials.end(), [](const fem::Material& material) {
         return fem::nearlyIncompressible(material) || material.plasticity.has_value();
       }));
  return project ? fem::Dilatation::Projected : fem::Dilatation::Full;
}

// The projection does nothing for them, so that the user should know.
void noteLocking(const scene::Body& body, scene::Physics physics, fem::CellType type,
                 std::vector<std::string>& notes) {
  const fem::CellShape& shape = fem::shapeOf(type);
  if (body.dilatation == fem::Dilatation::Projected && (shape.isSimplex || shape.isWedge) &&
      shape.order == 1 && physics != scene::Physics::PlaneStress)
    notes.push_back("Body \"" + body.name + "\": a " + shape.name +
                    " locks near incompressibility even with projected dilatation; use second-order "
                    "elements, quadrilaterals or hexahedra");
}

fem::PartitionOptions partitionOptions(const ParameterList& list) {
  fem::PartitionOptions options;
  if (list.sublist("Expert").get<std::string>("Partition") == "METIS")
    options.method = fem::PartitionMethod::Metis;
  options.seed = list.sublist("Expert").get<int>("Partition seed");
  return options;
}

// "96 parts of 1800 to 2500 cells"
std::string sizesOf(const fem::Partition& partition) {
  std::vector<int> sizes(static_cast<std::size_t>(partition.parts), 0);
  for (int part : partition.part)
    ++sizes[static_cast<std::size_t>(part)];
  const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
  return std::to_string(partition.parts) + (partition.parts == 1 ? " part of " : " parts of ") +
         (*least == *most ? "" : std::to_string(*least) + " to ") + std::to_string(*most) + " cells";
}

// "part 3", "parts 3 and 5", "parts 3, 5, 8 and 21 others"
std::string listed(const std::vector<int>& parts) {
  constexpr std::size_t most = 6;
  const std::size_t named = parts.size() <= most ? parts.size() : most - 1;
  std::string text = parts.size() == 1 ? "part " : "parts ";
  for (std::size_t k = 0; k < named; ++k)
    text += (k == 0 ? "" : k + 1 == parts.size() ? " and " : ", ") + std::to_string(parts[k]);
  return text + (named < parts.size() ? " and " + std::to_string(parts.size() - named) + " others" : "");
}

// As files have them that were made of several solids, or whose nodes were not merged.
void notePieces(const std::string& name, const std::vector<fem::BodyMesh>& blocks,
                std::vector<std::string>& notes) {
  if (const int pieces = fem::numberOfPieces(blocks); pieces > 1)
    notes.push_back("Body \"" + name + "\" is in " + std::to_string(pieces) +
                    " pieces without common nodes, which nothing couples. Merge the nodes in the mesh "
                    "generator, or make each piece a body and tie them");
}

// Ragged parts cost iterations, each some, and nothing else tells of them.
void noteRagged(const std::string& name, const fem::Partition& partition, fem::PartitionMethod method,
                std::vector<std::string>& notes) {
  std::vector<int> ragged;
  double least = fem::raggedNeck;
  for (int part = 0; part < partition.parts; ++part) {
    const double neck = partition.necks[static_cast<std::size_t>(part)];
    if (neck < fem::raggedNeck)
      ragged.push_back(part);
    least = std::min(least, neck);
  }
  if (ragged.empty())
    return;
  const bool one = ragged.size() == 1, isCompact = method == fem::PartitionMethod::Compact;
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << "Body \"" << name << "\": " << ragged.size() << " of "
       << partition.parts << " parts " << (one ? "is" : "are") << " ragged (" << listed(ragged)
       << "), narrowest neck " << least << ", recommended at least " << fem::raggedNeck
       << "; this can cost iterations: "
       << (isCompact ? "try another \"Partition seed\" or number of \"Subdomains\""
                     : "use \"Partition\" = \"compact\" for rounder parts");
  notes.push_back(text.str());
}

// "": the deck names none.
std::string meshFileOf(const DeckContext& context) {
  const std::string file = context.deck.sublist("Model").get<std::string>("Mesh file");
  return file.empty() || file.front() == '/' ? file : context.directory + file;
}

// A mesh file that is cut already; null if it is another one.
std::shared_ptr<const fem::CutMeshFile> cutMeshOf(const DeckContext& context) {
  std::shared_ptr<const fem::CutMeshFile> cut;
  agree(context.comm, [&] {
    const std::string file = meshFileOf(context);
    if (!fem::CutMeshFile::isOne(file))
      return;
    cut = std::make_shared<const fem::CutMeshFile>(file);
    const ParameterList& model = context.deck.sublist("Model");
    if (model.isParameter("Mesh size") &&
        (model.get<double>("Mesh size") > 0.0 || model.get<int>("Mesh order") > 0))
      throw InputError("\"" + file +
                           "\" is a mesh that harmos-mesh has cut: \"Model/Mesh size\" and \"Mesh order\" "
                           "have no effect; give them to harmos-mesh (--size, --order)",
                       {{"path", "Model/Mesh size"}});
  });
  return cut;
}

// The places of its blocks in the file.
std::vector<std::size_t> placesIn(const fem::CutMeshFile& cut, const std::string& name,
                                  const ParameterList& list) {
  const std::string path = "Bodies/" + name;
  std::vector<std::string> names;
  std::vector<std::size_t> places;
  int known = 0;
  for (const fem::CutMeshFile::Body& block : cut.bodies()) {
    if (block.name == name) {
      places.push_back(names.size());
      known += block.subdomains;
    }
    names.push_back(block.name);
  }
  if (places.empty())
    throw InputError("\"" + path + "\": the mesh file has no body of this name" + offer(name, names),
                     {{"path", path}});
  const std::string subdomains = list.get<std::string>("Subdomains"); // 1: what was the default
  if (!texts(list, "Groups").empty() ||
      (subdomains != "auto" && subdomains != "1" && std::stoi(subdomains) != known))
    throw InputError(
        "\"" + path + "\" has \"Groups\" or \"Subdomains\", but the mesh file is already partitioned into " +
            std::to_string(known) + " subdomains; remove them or partition it again with harmos-mesh",
        {{"path", path}});
  return places;
}

// Bodies of a file that is cut: each rank reads its own subdomains.
void takeBodies(const DeckContext& context, const std::shared_ptr<const fem::CutMeshFile>& cut,
                const std::vector<std::size_t>& which, scene::Scene& scene, long long& firstNode) {
  for (std::size_t b : which) {
    scene::Body& body = scene.bodies[b];
    const std::vector<std::size_t> places =
        placesIn(*cut, body.name, context.deck.sublist("Bodies").sublist(body.name));
    std::vector<std::pair<std::size_t, int>> blocks; // place in the file, subdomains
    std::string types;
    for (std::size_t place : places) {
      const fem::CutMeshFile::Body& known = cut->bodies()[place];
      blocks.emplace_back(place, known.subdomains);
      body.subdomains += known.subdomains;
      types += (types.empty() ? "" : ", ") + fem::shapeOf(known.cellType).name;
      noteLocking(body, scene.physics, known.cellType, scene.notes);
    }
    body.isCut = true;
    body.subdomain = [cut, blocks, first = firstNode](int k) {
      auto block = blocks.begin();
      for (; k >= block->second; ++block)
        k -= block->second;
      return cut->subdomain(block->first, k, first);
    };
    const long long nodes = cut->bodies()[places.front()].nodes;
    firstNode += nodes;
    context.log.info("Body \"" + body.name + "\": " + std::to_string(nodes) + " nodes (" + types +
                     "), cut into " + std::to_string(body.subdomains) + " parts by the mesh file");
  }
}

// Nodes that an equation at a node couples, on average.
double stencilOf(fem::CellType type) {
  const fem::CellShape& shape = fem::shapeOf(type);
  const bool isFirst = shape.order == 1;
  if (shape.dimension == 2)
    return shape.isSimplex ? (isFirst ? 7.0 : 11.5) : (isFirst ? 9.0 : shape.isSerendipity ? 15.7 : 16.0);
  if (shape.isWedge)
    return isFirst ? 21.0 : shape.isSerendipity ? 44.2 : 46.0;
  return shape.isSimplex ? (isFirst ? 15.0 : 28.0) : (isFirst ? 27.0 : shape.isSerendipity ? 58.5 : 64.0);
}

// The blocks of a body.
using Blocks = std::vector<fem::BodyMesh>;

int numberOfCells(const Blocks& body) {
  int cells = 0;
  for (const fem::BodyMesh& block : body)
    cells += block.mesh.numberOfCells();
  return cells;
}

// Parts of each body: as the deck says, or its share of what the cost model says of all. On rank 0.
std::vector<int> partsOf(const DeckContext& context, const std::vector<Blocks>& bodies, int dofsPerNode,
                         double memoryMiB) {
  feti::WholeBodies whole;
  whole.dofsPerNode = dofsPerNode;
  double coupled = 0.0;
  for (const Blocks& body : bodies) {
    whole.nodes += fem::numberOfNodes(body);
    for (const fem::BodyMesh& block : body)
      coupled += stencilOf(block.mesh.cellType) * block.mesh.numberOfNodes();
    whole.dimension = body.front().mesh.dimension();
  }
  whole.stencil = coupled / whole.nodes;
  const auto chosen = [&](int ranks) {
    return feti::chooseSubdomains(whole, ranks, ranks == context.comm.getSize() ? memoryMiB : 0.0).parts;
  };
  const int all = chosen(context.comm.getSize());
  bool isAuto = false;
  std::vector<int> parts;
  for (const Blocks& body : bodies) {
    const std::string& name = body.front().name;
    const std::string given = context.deck.sublist("Bodies").sublist(name).get<std::string>("Subdomains");
    const auto before = context.chosenSubdomains.find(name);
    if (given != "auto") {
      parts.push_back(std::stoi(given));
    } else if (before != context.chosenSubdomains.end()) {
      parts.push_back(before->second);
    } else {
      isAuto = true;
      const auto share = static_cast<int>(std::lround(all * (fem::numberOfNodes(body) / whole.nodes)));
      parts.push_back(std::max(1, std::min(share, numberOfCells(body))));
    }
  }
  if (isAuto) {
    std::string others;
    for (int ranks : {1, 4, 16, 64})
      others += (others.empty() ? "" : ", ") + std::to_string(ranks) + ": " + std::to_string(chosen(ranks));
    context.log.info(
        "Subdomains, auto: " + std::to_string(all) + " in all for " + std::to_string(context.comm.getSize()) +
        (context.comm.getSize() == 1 ? " rank" : " ranks") + " by the cost model (by ranks: " + others + ")");
  }
  return parts;
}

void requireMeshFile(const std::string& file, const std::string& body) {
  if (file.empty())
    throw InputError("\"Model/Mesh file\" is empty, but body \"" + body +
                         "\" has the source \"file\"; give the file or choose another \"Source\"",
                     {{"path", "Model/Mesh file"}});
}

// Reads the blocks of each body, on rank 0.
std::vector<Blocks> readBlocks(const DeckContext& context, const std::string& file, int dimension,
                               const std::vector<std::size_t>& which, const scene::Scene& scene) {
  const ParameterList& bodies = context.deck.sublist("Bodies");
  std::vector<fem::GmshBody> wanted;
  for (std::size_t b : which)
    wanted.push_back(
        {scene.bodies[b].name, groupsOf(scene.bodies[b].name, bodies.sublist(scene.bodies[b].name))});
  fem::GmshMeshing meshing;
  meshing.sizes = context.sizes;
  const ParameterList& model = context.deck.sublist("Model");
  if (file == meshFileOf(context) && model.isParameter("Mesh size")) {
    if (meshing.sizes == nullptr)
      meshing.size = model.get<double>("Mesh size");
    meshing.order = model.get<int>("Mesh order");
  }
  return fem::groupedByBody(fem::readGmsh(file, wanted, dimension, meshing));
}

// A body that is cut, on rank 0; on the others nothing is in it.
struct CutBlocks {
  std::shared_ptr<std::vector<fem::PlacedMesh>> subdomains;
  long long nodes = 0;
};

// Cuts the blocks of a body by all ranks, and tells what came of it. @note Collective.
CutBlocks cutBody(const DeckContext& context, Blocks& blocks, int wanted, long long firstNode,
                  const scene::Body& body, scene::Scene& scene) {
  const fem::PartitionOptions options = partitionOptions(context.deck.sublist("Bodies").sublist(body.name));
  const bool isRoot = context.comm.getRank() == 0;
  std::vector<int> parts;
  int count = 0;
  agree(context.comm, [&] {
    if (!isRoot)
      return;
    parts = fem::partsOfBlocks(blocks, wanted);
    count = static_cast<int>(parts.size());
  });
  Teuchos::broadcast<int, int>(context.comm, 0, 1, &count);
  parts.resize(static_cast<std::size_t>(count));
  Teuchos::broadcast<int, int>(context.comm, 0, count, parts.data());
  CutBlocks cut;
  fem::Partition whole; // of all blocks, one after the other
  std::string cells;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const fem::Partition partition =
        fem::partitionCells(context.comm, isRoot ? &blocks[k] : nullptr, parts[k], options);
    agree(context.comm, [&] {
      if (!isRoot)
        return;
      if (k == 0) {
        cut.subdomains = std::make_shared<std::vector<fem::PlacedMesh>>();
        cut.nodes = fem::numberOfNodes(blocks);
        notePieces(body.name, blocks, scene.notes);
      }
      const fem::Mesh& mesh = blocks[k].mesh;
      for (fem::PlacedMesh& subdomain : fem::tear(blocks[k], partition.part, partition.parts, firstNode))
        cut.subdomains->push_back(std::move(subdomain));
      for (int part : partition.part)
        whole.part.push_back(whole.parts + part);
      whole.parts += partition.parts;
      whole.necks.insert(whole.necks.end(), partition.necks.begin(), partition.necks.end());
      cells += (k == 0 ? "" : ", ") + std::to_string(mesh.numberOfCells()) + " cells (" +
               fem::shapeOf(mesh.cellType).name + ")";
      scene.notes.insert(scene.notes.end(), partition.notes.begin(), partition.notes.end());
      noteLocking(body, scene.physics, mesh.cellType, scene.notes);
    });
  }
  agree(context.comm, [&] {
    if (!isRoot)
      return;
    context.log.info("Body \"" + body.name + "\": " + std::to_string(cut.nodes) + " nodes, " + cells +
                     ", cut into " + sizesOf(whole));
    noteRagged(body.name, whole, options.method, scene.notes);
  });
  return cut;
}

// Bodies from a file: read on rank 0 and cut by all; the others learn how many parts and nodes there are.
void readBodies(const DeckContext& context, const std::string& file, int dimension,
                const std::vector<std::size_t>& which, scene::Scene& scene, long long& firstNode) {
  std::vector<Blocks> bodies(which.size());
  std::vector<int> parts(which.size(), 1);
  constexpr double share = 0.5; // of the memory, for factors
  const double memoryMiB = share * feti::machineMemoryMiB(context.comm);
  agree(context.comm, [&] {
    if (context.comm.getRank() != 0)
      return;
    bodies = readBlocks(context, file, dimension, which, scene);
    parts = partsOf(context, bodies, scene.physics == scene::Physics::Membrane ? 1 : dimension, memoryMiB);
  });
  Teuchos::broadcast<int, int>(context.comm, 0, static_cast<int>(parts.size()), parts.data());
  for (std::size_t k = 0; k < which.size(); ++k) {
    scene::Body& body = scene.bodies[which[k]];
    if (context.deck.sublist("Bodies").sublist(body.name).get<std::string>("Subdomains") == "auto")
      scene.chosenSubdomains[body.name] = parts[k];
    const CutBlocks cut = cutBody(context, bodies[k], parts[k], firstNode, body, scene);
    bodies[k].clear(); // its parts are there
    std::array<long long, 2> counts = {cut.subdomains ? static_cast<long long>(cut.subdomains->size()) : 0LL,
                                       cut.nodes};
    Teuchos::broadcast<int, long long>(context.comm, 0, 2, counts.data());
    body.subdomains = static_cast<int>(counts[0]);
    body.onRoot = cut.subdomains;
    firstNode += counts[1];
  }
}

// Blocks as geometries, whose meshes follow the error.
void meshBlocks(const DeckContext& context, int dimension, const std::vector<std::size_t>& which,
                scene::Scene& scene, long long& firstNode) {
  std::unique_ptr<const BlockGeometry> geometry; // on rank 0
  agree(context.comm, [&] {
    std::vector<SimplexBlock> blocks;
    int order = 0;
    for (std::size_t b : which) {
      const std::string& name = scene.bodies[b].name;
      const ParameterList& list = context.deck.sublist("Bodies").sublist(name);
      const int own = fem::shapeOf(cellTypeOf(list.get<std::string>("Element"), dimension)).order;
      if (order != 0 && own != order)
        throw InputError("\"Bodies/" + name +
                             "/Element\" is of another order than those of other blocks; with \"Adaptivity\" "
                             "all blocks are meshed by simplices of one order",
                         {{"path", "Bodies/" + name + "/Element"}});
      order = own;
      const auto size = triple<double>(list, "Size");
      const auto parts = triple<int>(list, "Subdomains a side"),
                 elements = triple<int>(list, "Elements a side");
      double length = size[0];
      for (std::size_t d = 0; d < static_cast<std::size_t>(dimension); ++d)
        length = std::min(length, size[d] / (parts[d] * elements[d]));
      blocks.push_back({name, triple<double>(list, "Origin"), size, length});
    }
    if (context.comm.getRank() == 0)
      geometry = std::make_unique<const BlockGeometry>(blocks, dimension, order);
  });
  readBodies(context, geometry ? geometry->file() : "", dimension, which, scene, firstNode);
}

void makeBlock(const ParameterList& list, int dimension, scene::Body& body, long long& firstNode,
               scene::Scene& scene) {
  fem::StructuredBlock::Options options;
  options.cellType = cellTypeOf(list.get<std::string>("Element"), dimension);
  options.origin = triple<double>(list, "Origin");
  options.size = triple<double>(list, "Size");
  options.subdomains = triple<int>(list, "Subdomains a side");
  options.elements = triple<int>(list, "Elements a side");
  options.firstNode = firstNode;
  const auto block = std::make_shared<const fem::StructuredBlock>(options);
  firstNode += block->numberOfNodes();
  body.subdomains = block->numberOfSubdomains();
  body.subdomain = [block](int k) { return block->subdomain(k); };
  noteLocking(body, scene.physics, options.cellType, scene.notes);
}

void addMaterials(ParameterSpec& deck) {
  ParameterSpec material("<material>", "A linear elastic material, by a name of your choice.");
  material.choice("Type", "isotropic",
                  {{"isotropic", "by Young's modulus and Poisson's ratio"},
                   {"orthotropic", "by three of each and three shear moduli, about rotated axes"},
                   {"anisotropic", "by its stiffness, about rotated axes"},
                   {"neo-Hookean", "isotropic; compressible rubber, for finite strains"}},
                  "Symmetry and law of the material. At finite strains the first three are St. "
                  "Venant-Kirchhoff's: linear in Green's strain.");
  ParameterSpec plasticity("Plasticity",
                           "Von Mises' plasticity of an isotropic material, associative, with hardening. "
                           "Not given: the material is elastic.");
  plasticity.real("Yield stress", notGiven, Range(),
                  "Yield stress at first, a force per area above 0. -1: not given.");
  plasticity.real("Isotropic hardening", 0.0, Range::atLeast(0.0),
                  "Modulus: how the yield stress grows over the equivalent plastic strain.");
  plasticity.real(
      "Kinematic hardening", 0.0, Range::atLeast(0.0),
      "Modulus: how the centre of the yield surface moves, over the axial plastic strain of a bar.");
  plasticity.series(
      "Plastic strains", Range::atLeast(0.0),
      "Points of the hardening curve, in the place of yield stress and isotropic hardening: equivalent "
      "plastic strains, rising from 0. Beyond the last one the stress stays.");
  plasticity.series("Stresses", Range::above(0.0), "Yield stresses at \"Plastic strains\", not falling.");
  material.list(std::move(plasticity));
  material.real("Young's modulus", 1.0, Range::above(0.0), "Isotropic: Young's modulus, force per area.");
  material.real("Poisson's ratio", 0.3, Range::strictlyWithin(-1.0, 0.5),
                "Isotropic: Poisson's ratio. Above 0.4 see \"Dilatation\" of the bodies.");
  material.reals("Young's moduli", {1.0, 1.0, 1.0}, Range::above(0.0),
                 "Orthotropic: E_1, E_2, E_3, force per area.");
  material.reals("Poisson's ratios", {0.3, 0.3, 0.3}, Range(),
                 "Orthotropic: ν_12, ν_13, ν_23; ν_ij/E_i = ν_ji/E_j.");
  material.reals("Shear moduli", {0.4, 0.4, 0.4}, Range::above(0.0),
                 "Orthotropic: G_12, G_13, G_23, force per area.");
  material.real("Angle", 0.0, Range(), "Not isotropic: angle from x to axis 1, about z, in degrees.");
  material.reals("Thermal expansion", {0.0, 0.0, 0.0}, Range(),
                 "Strain per degree along the axes 1, 2, 3 (isotropic: x, y, z).");
  material.real("Density", 0.0, Range::atLeast(0.0),
                "Mass per volume. Required with \"Steps/Time integration\" = \"Newmark\".");
  material.expert().series(
      "Stiffness", Range(),
      "Anisotropic: 21 moduli, force per area: C_11, C_12, C_22, C_13, ..., the columns of the upper "
      "triangle in the order 11, 22, 33, 12, 13, 23. Required by this type.");
  material.expert().series("Axis 1", Range(),
                           "Not isotropic: direction of axis 1, in the place of \"Angle\".");
  material.expert().series(
      "Axis 2", Range(),
      "Not isotropic, with \"Axis 1\": a direction whose part at right angles to axis 1 is axis 2.");
  ParameterSpec materials("Materials", "Materials of the bodies.");
  materials.family(std::move(material));
  deck.list(std::move(materials));
}

// Of a body.
void addExpertParameters(ParameterSpec& body) {
  body.expert().choice("Partition", "compact",
                       {{"compact", "METIS' parts, rounded off: iterations do not grow with their number"},
                        {"METIS", "METIS' parts, unchanged"}},
                       "Source file: method of the decomposition.");
  body.expert().integer("Partition seed", 1, 0, 1000000,
                        "Source file: seed of METIS' random numbers. Each seed gives another decomposition, "
                        "of equal quality.");
  body.expert().choice("Dilatation", "auto",
                       {{"auto", "projected if a Poisson's ratio is above 0.4, and of materials that yield"},
                        {"full", "from the displacements"},
                        {"projected", "B-bar, for nearly incompressible materials"}},
                       "Volume change in the stiffness.");
  body.expert().choice(
      "Integration", "full",
      {{"full", "exact on affine cells"},
       {"reduced",
        "2 points in each direction on serendipity elements, 2 and 9 on wedges of 6 and 15 nodes, as "
        "C3D20R, CPS8R, C3D6 and C3D15 of other programs; use one subdomain, or several cells across "
        "each"}},
      "Quadrature of the stiffness.");
  body.expert().series(
      "Thickness", Range::above(0.0),
      "Plane strain and stress: thickness of each region, or one for all; none: 1. Forces and "
      "energies are those of the thickness; contacts need the thickness 1.");
}

} // namespace

void addBodyParameters(ParameterSpec& deck) {
  addMaterials(deck);
  ParameterSpec body("<body>", "A body, by a name of your choice.");
  body.choice("Source", "file",
              {{"file", "from \"Model/Mesh file\""},
               {"block",
                "a rectangle (plane scenes) or a brick with a regular grid; boundary parts left and right "
                "(least and largest x), bottom and top (y in the plane, z in space), in space also front and "
                "back (least and largest y)"}},
              "Source of the mesh.");
  body.texts("Groups", {},
             "Source file: physical groups of the body, each a region; none: the group of the body's name.");
  body.choiceOrInteger("Subdomains", "auto", {{"auto", "by the cost model, for the number of ranks"}}, 1,
                       1000000,
                       "Source file: number of subdomains. Of a mesh that harmos-mesh has cut: auto.");
  body.reals("Origin", {0.0, 0.0, 0.0}, Range(), "Source block: corner of least coordinates.");
  body.reals("Size", {1.0, 1.0, 1.0}, Range::above(0.0),
             "Source block: lengths along x, y, z; plane scenes do not use the third.");
  body.integers("Subdomains a side", {1, 1, 1}, 1, 100000,
                "Source block: numbers of equal subdomains along x, y, z.");
  body.integers("Elements a side", {8, 8, 8}, 1, 100000,
                "Source block: numbers of elements of one subdomain along x, y, z.");
  body.choice("Element", "Q1",
              {{"Q1", "quadrilaterals of 4, hexahedra of 8 nodes"},
               {"Q2", "of 9 and 27 nodes"},
               {"S2", "serendipity elements, of 8 and 20 nodes"},
               {"P1", "triangles of 3, tetrahedra of 4 nodes"},
               {"P2", "of 6 and 10 nodes"}},
              "Source block: type of the cells. P1 and P2 split each quadrilateral into two cells, each "
              "hexahedron into six.");
  body.texts("Materials", {},
             "Names from the list Materials, one for each region in the order of the groups, or one for all. "
             "Membranes have none.");
  addExpertParameters(body);
  ParameterSpec bodies("Bodies", "The bodies of the scene.");
  bodies.family(std::move(body));
  deck.list(std::move(bodies));
}

namespace {

// One for each region.
std::vector<double> thicknessOf(const ParameterList& list, const std::string& name, std::size_t regions,
                                scene::Physics physics) {
  const auto& given = list.sublist("Expert").get<Teuchos::Array<double>>("Thickness");
  if (given.empty())
    return {};
  const std::string path = "Bodies/" + name + "/Expert/Thickness";
  if (physics != scene::Physics::PlaneStrain && physics != scene::Physics::PlaneStress)
    throw InputError("\"" + path + "\" is given in a scene that is not plane; remove it", {{"path", path}});
  if (given.size() != 1 && static_cast<std::size_t>(given.size()) != regions)
    throw InputError("\"" + path + "\" has " + std::to_string(given.size()) + " numbers for " +
                         std::to_string(regions) + " regions; give one for all or one per region",
                     {{"path", path}});
  std::vector<double> thickness(given.begin(), given.end());
  thickness.resize(regions, thickness.back());
  return thickness;
}

} // namespace

void addBodies(const DeckContext& context, scene::Scene& scene) {
  const ParameterList& bodies = context.deck.sublist("Bodies");
  const int dimension = scene.physics == scene::Physics::Solid ? 3 : 2;
  const std::shared_ptr<const fem::CutMeshFile> cut = cutMeshOf(context);
  std::vector<std::size_t> fromFile, meshed;
  long long firstNode = 0;
  for (const std::string& name : namesIn(bodies)) {
    const ParameterList& list = bodies.sublist(name);
    scene::Body body;
    body.name = name;
    const bool isFile = list.get<std::string>("Source") == "file";
    if (scene.physics != scene::Physics::Membrane) {
      const std::size_t regions = !isFile ? 1
                                  : cut   ? cut->bodies()[placesIn(*cut, name, list).front()].regions.size()
                                          : groupsOf(name, list).size();
      const std::vector<std::string> materials = texts(list, "Materials");
      if (materials.size() != 1 && materials.size() != regions)
        throw InputError("\"Bodies/" + name + "/Materials\" names " + std::to_string(materials.size()) +
                             " materials for " + std::to_string(regions) +
                             " regions; name one for all or one per region",
                         {{"path", "Bodies/" + name + "/Materials"}});
      for (std::size_t r = 0; r < regions; ++r)
        body.materials.push_back(
            materialNamed(context.deck, materials[std::min(r, materials.size() - 1)], name));
      body.dilatation = dilatationOf(list, body.materials);
      body.thickness = thicknessOf(list, name, regions, scene.physics);
      if (list.sublist("Expert").get<std::string>("Integration") == "reduced")
        body.integration = fem::Integration::Reduced;
    }
    if (isFile)
      fromFile.push_back(scene.bodies.size());
    else if (isAdaptive(context.deck))
      meshed.push_back(scene.bodies.size());
    else
      makeBlock(list, dimension, body, firstNode, scene);
    scene.bodies.push_back(std::move(body));
  }
  if (scene.bodies.empty())
    throw InputError("\"Bodies\" is empty; add at least one body", {{"path", "Bodies"}});
  if (cut)
    takeBodies(context, cut, fromFile, scene, firstNode);
  else if (!fromFile.empty()) {
    const std::string file = meshFileOf(context);
    requireMeshFile(file, scene.bodies[fromFile.front()].name);
    context.log.info("Reading the mesh file \"" +
                     context.deck.sublist("Model").get<std::string>("Mesh file") + "\"");
    readBodies(context, file, dimension, fromFile, scene, firstNode);
  }
  if (!meshed.empty())
    meshBlocks(context, dimension, meshed, scene, firstNode);
}

} // namespace Harmos::app
