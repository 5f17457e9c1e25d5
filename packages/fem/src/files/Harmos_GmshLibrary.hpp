// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// What Harmos uses of Gmsh's programming interface, by the names of that (gmsh.info, "Gmsh API").
///
/// The library is loaded by the first call, not with the program: with OpenCASCADE and the 90 libraries that
/// it brings, loading takes longer than all else before main() and 40 MB, and most runs read no such file.
/// All of it is called through the C interface, whose names a loaded library can be asked for.
///
/// @throws GmshFailure with Gmsh's own words; InputError where the library cannot be loaded.
namespace Harmos::fem::Details::gmsh {

/// A call that failed; the reason is empty where Gmsh gives none.
class GmshFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// (dimension, tag) of entities and groups.
using Pairs = std::vector<std::pair<int, int>>;
using Tags = std::vector<std::size_t>;

void initialize();
void finalize() noexcept;
void open(const std::string& path);

void setNumber(const std::string& option, double value);
std::string getString(const std::string& option);

namespace model {

void add(const std::string& name);
/// Of all dimensions if it is -1.
Pairs getEntities(int dimension = -1);
/// @return the tag, a new one if none is given.
int addDiscreteEntity(int dimension, int tag = -1);
Pairs getPhysicalGroups();
std::vector<int> getEntitiesForPhysicalGroup(int dimension, int tag);
std::string getPhysicalName(int dimension, int tag);
void addPhysicalGroup(int dimension, std::vector<int> entities, const std::string& name);
void removePhysicalGroups();

} // namespace model

namespace mesh {

void generate(int dimension);
/// The size of cells at a place.
void setSizeCallback(std::function<double(double, double, double)> size);

struct Nodes {
  Tags tags;
  std::vector<double> coordinates;
};
Nodes getNodes();
void addNodes(int dimension, int entity, Tags tags, std::vector<double> coordinates);

std::vector<int> getElementTypes(int dimension);

struct ElementProperties {
  std::string name;
  int dimension = 0, order = 0, nodes = 0, corners = 0;
  std::vector<double> coordinates;
};
ElementProperties getElementProperties(int type);

/// Type by type; of all entities of the dimension if none is given.
struct Elements {
  std::vector<int> types;
  std::vector<Tags> tags, nodes;
};
Elements getElements(int dimension, int entity = -1);
/// With tags that Gmsh gives.
void addElementsByType(int entity, int type, Tags nodes);

} // namespace mesh

namespace view {

std::vector<int> getTags();
std::string getName(int view);

struct ModelData {
  std::string kind;
  Tags tags;
  std::vector<std::vector<double>> rows;
  int components = 0;
};
/// Of the first step.
ModelData getModelData(int view);
void addNodeData(const std::string& name, const std::string& model, Tags nodes,
                 const std::vector<std::vector<double>>& rows);

} // namespace view
} // namespace Harmos::fem::Details::gmsh
