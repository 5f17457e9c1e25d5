// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PlanSurvey.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Motion.hpp"
#include "Harmos_ReplicatedCoarse.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

namespace Harmos::plan {
namespace {

// What tells an object from others without sending it. Equal stiffness matrices of different ranks differ by
// rounding, see SubdomainSystem: sums are compared, not their bits.
struct Fingerprint {
  long long hash;
  int rows, columns;
  double entries, sum, size, bytes;
};

bool sameObject(const Fingerprint& a, const Fingerprint& b) {
  // Entries agree to 1e-12 √(k_ii k_jj); of elastic matrices these are some ten times the entries.
  constexpr double tolerance = 1e-10;
  return std::tie(a.hash, a.rows, a.columns, a.entries) == std::tie(b.hash, b.rows, b.columns, b.entries) &&
         std::abs(a.sum - b.sum) <= tolerance * a.size && std::abs(a.size - b.size) <= tolerance * a.size;
}

// Weights without structure, so that entries that have changed places do not go unseen.
template<class Values>
void addSums(const Values& values, Fingerprint& print) {
  double weight = 0.0;
  for (const auto& value : values) {
    weight = std::fmod(weight + 0.6180339887498949, 1.0);
    print.sum += (0.5 + weight) * static_cast<double>(value);
    print.size += std::abs(static_cast<double>(value));
  }
}

Fingerprint fingerprint(const fem::Mesh& mesh) {
  Fingerprint print{static_cast<int>(mesh.cellType),
                    mesh.numberOfNodes(),
                    mesh.numberOfCells(),
                    static_cast<double>(mesh.boundary.size()),
                    0.0,
                    0.0,
                    0.0};
  addSums(mesh.coordinates, print);
  addSums(mesh.cells, print);
  addSums(mesh.regions, print);
  print.bytes = 8.0 * static_cast<double>(mesh.coordinates.size()) +
                4.0 * static_cast<double>(mesh.cells.size() + mesh.regions.size() + mesh.boundary.size());
  return print;
}

Fingerprint fingerprint(const LocalMatrix& matrix, int kernelColumns) {
  Fingerprint print{static_cast<long long>(patternHash(matrix)),
                    matrix.rows(),
                    kernelColumns,
                    static_cast<double>(matrix.entries()),
                    0.0,
                    0.0,
                    0.0};
  addSums(matrix.values, print);
  print.bytes = 12.0 * static_cast<double>(matrix.entries()) + 8.0 * (1.0 + kernelColumns) * matrix.rows();
  return print;
}

// Numbers for what this rank has found to be distinct, the same for what is equal on all ranks; and the bytes
// of each. Collective.
std::vector<int> globalNumbers(const Teuchos::Comm<int>& comm, const std::vector<Fingerprint>& mine,
                               std::vector<double>& bytes) {
  const auto first = static_cast<std::size_t>(exclusiveScan(comm, static_cast<long long>(mine.size())));
  const std::vector<Fingerprint> all = gatherAll(comm, mine);
  std::map<long long, std::vector<int>> candidates; // by hash
  std::vector<Fingerprint> distinct;
  std::vector<int> numbers;
  for (const Fingerprint& print : all) {
    std::vector<int>& known = candidates[print.hash];
    const auto found = std::find_if(known.begin(), known.end(), [&](int k) {
      return sameObject(distinct[static_cast<std::size_t>(k)], print);
    });
    if (found != known.end()) {
      numbers.push_back(*found);
      continue;
    }
    numbers.push_back(static_cast<int>(distinct.size()));
    known.push_back(numbers.back());
    distinct.push_back(print);
    bytes.push_back(print.bytes);
  }
  const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(first);
  return {begin, begin + static_cast<std::ptrdiff_t>(mine.size())};
}

// The objects of this rank, each once.
template<class Key>
class Distinct {
 public:
  template<class Print>
  int place(const Key& key, Print&& print) {
    const auto [item, isNew] = places_.emplace(key, static_cast<int>(prints.size()));
    if (isNew)
      prints.push_back(print());
    return item->second;
  }
  std::vector<Fingerprint> prints;

 private:
  std::map<Key, int> places_;
};

class Stopwatch {
 public:
  explicit Stopwatch(const Teuchos::Comm<int>& comm) : comm_(comm) {}
  // Since the last call, on the slowest rank. Collective.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    const double slowest = globalMax(comm_, seconds);
    last_ = std::chrono::steady_clock::now();
    return slowest;
  }

 private:
  const Teuchos::Comm<int>& comm_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

double bytesOf(const fem::PlacedMesh& mesh) {
  double bytes = 16.0 * static_cast<double>(mesh.boundaryNumbers.size());
  for (const auto& set : mesh.sets)
    bytes += 4.0 * static_cast<double>(set.second.size());
  for (const auto& sides : mesh.sides)
    bytes += 8.0 * static_cast<double>(sides.second.size());
  return bytes;
}

// Lists of different lengths, by the numbers of their subdomains. Collective.
std::vector<std::vector<int>> gatherLists(const Teuchos::Comm<int>& comm,
                                          const std::vector<long long>& numbers,
                                          const std::vector<std::vector<int>>& lists, std::size_t total) {
  struct Head {
    long long number;
    std::size_t length;
  };
  std::vector<Head> heads;
  std::vector<int> items;
  for (std::size_t i = 0; i < lists.size(); ++i) {
    heads.push_back({numbers[i], lists[i].size()});
    items.insert(items.end(), lists[i].begin(), lists[i].end());
  }
  const std::vector<Head> allHeads = gatherAll(comm, heads);
  const std::vector<int> allItems = gatherAll(comm, items);
  std::vector<std::vector<int>> result(total);
  auto next = allItems.begin();
  for (const Head& head : allHeads) {
    const auto end = next + static_cast<std::ptrdiff_t>(head.length);
    result[static_cast<std::size_t>(head.number)].assign(next, end);
    next = end;
  }
  return result;
}

// A rank that owns a member of a matrix analyses it (feti::analyseFactorization()). If there are too many
// matrices, some are analysed and the others scaled.
std::vector<feti::FactorizationEstimate> analyses(const Teuchos::Comm<int>& comm, const PlanSurvey& survey,
                                                  const feti::SubdomainSystem& system) {
  constexpr std::size_t mostAnalyses = 64;
  const std::size_t count = survey.matrixBytes.size();
  std::vector<std::set<int>> boundaries(count);
  std::vector<long long> holder(count, -1);
  for (std::size_t s = survey.subdomains.size(); s-- > 0;) {
    const auto m = static_cast<std::size_t>(survey.subdomains[s].matrix);
    boundaries[m].insert(survey.boundaries[s].begin(), survey.boundaries[s].end());
    holder[m] = static_cast<long long>(s);
  }
  std::vector<std::size_t> bySize(count);
  for (std::size_t m = 0; m < count; ++m)
    bySize[m] = m;
  const auto rowsOf = [&](std::size_t m) {
    return survey.subdomains[static_cast<std::size_t>(holder[m])].rows;
  };
  std::stable_sort(bySize.begin(), bySize.end(),
                   [&](std::size_t a, std::size_t b) { return rowsOf(a) < rowsOf(b); });
  // Evenly spread over the sizes, the largest among them.
  std::vector<std::size_t> reference(count);
  const std::size_t parts = std::min(count, mostAnalyses);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t part = k * parts / count;
    reference[bySize[k]] = bySize[(part + 1) * count / parts - 1];
  }
  struct Item {
    std::size_t matrix;
    feti::FactorizationEstimate estimate;
  };
  std::vector<Item> mine;
  agree(comm, [&] {
    feti::FactorizationContext context;
    for (int i = 0; i < system.size(); ++i) {
      const long long number = system.subdomain(i).number;
      const auto m = static_cast<std::size_t>(survey.subdomains[static_cast<std::size_t>(number)].matrix);
      if (holder[m] == number && reference[m] == m)
        mine.push_back({m, feti::analyseFactorization(
                               system.matrix(i), {boundaries[m].begin(), boundaries[m].end()}, context)});
    }
  });
  std::vector<feti::FactorizationEstimate> found(count);
  for (const Item& item : gatherAll(comm, mine))
    found[item.matrix] = item.estimate;
  std::vector<feti::FactorizationEstimate> result;
  for (std::size_t m = 0; m < count; ++m) {
    result.push_back(found[reference[m]].scaledTo(rowsOf(m), static_cast<int>(boundaries[m].size())));
  }
  return result;
}

// Makes a survey, as far as a run makes its dual problem.
class Surveyor {
 public:
  Surveyor(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
           const run::RunOptions& options)
      : comm_(*comm), scene_(scene), options_(options), watch_(*comm) {
    survey_.ranks = comm->getSize();
    survey_.dimension = scene.physics == scene::Physics::Solid ? 3 : 2;
    survey_.rigidBodyModes = scene::rigidBodyModesOf(scene.physics);
    makeSystem(comm);
    makeConstraints();
    makeCoarse();
  }

  PlanSurvey go() {
    countDimensions();
    for (int i = 0; i < system_->size(); ++i)
      ++loads_[system_->subdomain(i).load.get()];
    isCounted_.assign(localSize(*constraints_->overlapMap()), false);
    agree(comm_, [&] {
      for (int i = 0; i < system_->size(); ++i)
        count(i);
    });
    gather();
    survey_.matrices = analyses(comm_, survey_, *system_);
    return std::move(survey_);
  }

 private:
  struct Item {
    long long number;
    SurveyedSubdomain subdomain;
  };

  void makeSystem(const Teuchos::RCP<const Teuchos::Comm<int>>& comm);
  void makeConstraints();
  void makeCoarse();
  void countDimensions();
  void count(int i);
  void numberObjects(int i, SurveyedSubdomain& s);
  double ownBytes(int i);
  std::vector<int> countRows(int i, SurveyedSubdomain& s);
  void countCoarse(int overlapRow, SurveyedSubdomain& s) const;
  void gather();

  const Teuchos::Comm<int>& comm_;
  const scene::Scene& scene_;
  const run::RunOptions& options_;
  Stopwatch watch_;
  PlanSurvey survey_;
  std::vector<scene::OwnedSubdomain> owned_;
  std::optional<feti::SubdomainSystem> system_;
  scene::ContactSetup contact_;
  std::unordered_map<long long, double> pointBytes_; // of contact, by node
  std::optional<feti::Constraints> constraints_;
  std::optional<feti::ReplicatedCoarse> coarse_;

  // Of this rank's subdomains, as they are counted.
  std::vector<Item> mine_;
  std::vector<long long> numbers_;
  std::vector<std::vector<int>> boundaries_;
  Distinct<const fem::Mesh*> meshes_;
  Distinct<const LocalMatrix*> stiffnesses_;
  Distinct<std::pair<const LocalMatrix*, int>> matrices_;
  std::map<const void*, int> loads_; // how many subdomains share each
  std::vector<bool> isCounted_;      // rows of the overlap
};

void Surveyor::makeSystem(const Teuchos::RCP<const Teuchos::Comm<int>>& comm) {
  owned_ = scene::decompose(comm_, scene_);
  scene::checkBoundaryParts(comm_, scene_, owned_);
  survey_.secondsOfMeshes = watch_.lap();
  std::vector<feti::Subdomain> assembled;
  agree(comm_, [&] {
    assembled = scene::assemble(scene_, owned_);
    if (scene_.isTransient())
      run::Motion(comm_, scene_).addMasses(owned_, assembled, scene_.timeline.ends().front());
  });
  system_.emplace(comm, std::move(assembled), run::dirichletForm(scene_, options_));
  survey_.secondsOfAssembly = watch_.lap();
}

void Surveyor::makeConstraints() {
  contact_ = scene::setUpContact(comm_, scene_, owned_);
  constraints_.emplace(*system_, contact_.rows);
  survey_.secondsOfConstraints = watch_.lap();
}

void Surveyor::makeCoarse() {
  coarse_.emplace(*system_, *constraints_);
  const double whole = watch_.lap();
  MultiVector all(constraints_->rowMap(), 1);
  all.putScalar(1.0);
  watch_.lap();
  coarse_->faceFactor(all); // values and factor once more
  survey_.secondsOfCoarseFactor = std::min(watch_.lap(), whole);
  survey_.secondsOfCoarseRows = whole - survey_.secondsOfCoarseFactor;
}

void Surveyor::countDimensions() {
  survey_.primalDimension = system_->primalDimension();
  survey_.dualDimension = constraints_->dualDimension();
  survey_.inequalities = constraints_->inequalities();
  survey_.limited = constraints_->limited();
  survey_.kernelDimension = system_->kernelDimension();
  survey_.coarseDimension = coarse_->dimension();
  survey_.coarseFactorEntries = coarse_->factor().entries();
  survey_.coarseIsDense = coarse_->factor().isDense();
  for (const contact::ContactPoint& point : contact_.points)
    pointBytes_[point.node] += static_cast<double>(sizeof(contact::ContactPoint) +
                                                   point.terms.size() * sizeof(contact::ContactPoint::Term));
}

void Surveyor::count(int i) {
  const fem::Mesh& mesh = *owned_[static_cast<std::size_t>(i)].mesh.mesh;
  SurveyedSubdomain s;
  numberObjects(i, s);
  s.rows = system_->matrix(i).rows();
  s.kernelColumns = system_->kernel(i).columns;
  s.nodes = mesh.numberOfNodes();
  s.nodesPerCell = mesh.nodesPerCell();
  s.cells = mesh.numberOfCells();
  s.ownBytes = ownBytes(i);
  s.hasCentre = system_->subdomain(i).centre.has_value();
  s.centre = system_->subdomain(i).centre.value_or(s.centre);
  const std::vector<int> touched = countRows(i, s);
  boundaries_.push_back(feti::boundaryWithSupport(system_->matrix(i), system_->kernel(i), touched,
                                                  options_.dual.inverses.fixingPlaces));
  numbers_.push_back(system_->subdomain(i).number);
  mine_.push_back({numbers_.back(), s});
}

// What it may share with others, by numbers of this rank.
void Surveyor::numberObjects(int i, SurveyedSubdomain& s) {
  const feti::Subdomain& subdomain = system_->subdomain(i);
  const fem::Mesh* mesh = owned_[static_cast<std::size_t>(i)].mesh.mesh.get();
  const feti::Kernel& kernel = system_->kernel(i);
  s.mesh = meshes_.place(mesh, [&] { return fingerprint(*mesh); });
  s.stiffness = stiffnesses_.place(subdomain.stiffness.get(), [&] {
    return fingerprint(*subdomain.stiffness, subdomain.motions->columns);
  });
  s.matrix = matrices_.place({&system_->matrix(i), kernel.columns}, [&] {
    Fingerprint print = fingerprint(system_->matrix(i), kernel.columns);
    if (subdomain.stiffness.get() == &system_->matrix(i)) // only the kernel is another one
      print.bytes = 8.0 * kernel.columns * kernel.rows;
    return print;
  });
}

// Contact points are those of the first subdomain that has their node.
double Surveyor::ownBytes(int i) {
  const feti::Subdomain& subdomain = system_->subdomain(i);
  const double vector = 8.0 * system_->matrix(i).rows();
  double bytes =
      bytesOf(owned_[static_cast<std::size_t>(i)].mesh) + 8.0 * static_cast<double>(subdomain.numbers.size());
  if (loads_.at(subdomain.load.get()) == 1)
    bytes += vector;
  if (&system_->rhs(i) != subdomain.load.get())
    bytes += vector;
  for (const long long number : owned_[static_cast<std::size_t>(i)].mesh.boundaryNumbers)
    if (const auto point = pointBytes_.find(number); point != pointBytes_.end()) {
      bytes += point->second;
      pointBytes_.erase(point);
    }
  return bytes;
}

// The rows of B_i. Returns the dofs that they touch.
std::vector<int> Surveyor::countRows(int i, SurveyedSubdomain& s) {
  std::vector<int> touched;
  int last = -1;
  for (const feti::Constraints::Entry& entry : constraints_->entries(i)) {
    touched.push_back(entry.dof);
    s.constraintEntries += 1.0;
    if (entry.row == last)
      continue;
    last = entry.row;
    s.touchedRows += 1.0;
    // A row belongs to the rank of its lowest subdomain; subdomains come here by rising numbers.
    const auto row = static_cast<std::size_t>(entry.row);
    if (constraints_->overlapOwner(entry.row) != comm_.getRank() || isCounted_[row])
      continue;
    isCounted_[row] = true;
    countCoarse(entry.row, s);
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

// A row of G̃ᵀ.
void Surveyor::countCoarse(int overlapRow, SurveyedSubdomain& s) const {
  s.ownedRows += 1.0;
  const auto row = static_cast<std::size_t>(
      constraints_->rowMap()->getLocalElement(constraints_->overlapMap()->getGlobalElement(overlapRow)));
  const std::vector<std::size_t>& offsets = coarse_->rows().offsets();
  const auto entries = static_cast<double>(offsets[row + 1] - offsets[row]);
  s.coarseEntries += entries;
  s.coarsePairs += 0.5 * entries * (entries + 1.0);
}

void Surveyor::gather() {
  const std::vector<int> meshes = globalNumbers(comm_, meshes_.prints, survey_.meshBytes);
  const std::vector<int> stiffnesses = globalNumbers(comm_, stiffnesses_.prints, survey_.stiffnessBytes);
  const std::vector<int> matrices = globalNumbers(comm_, matrices_.prints, survey_.matrixBytes);
  for (Item& item : mine_) {
    item.subdomain.mesh = meshes[static_cast<std::size_t>(item.subdomain.mesh)];
    item.subdomain.stiffness = stiffnesses[static_cast<std::size_t>(item.subdomain.stiffness)];
    item.subdomain.matrix = matrices[static_cast<std::size_t>(item.subdomain.matrix)];
  }
  survey_.subdomains.resize(static_cast<std::size_t>(system_->globalSubdomains()));
  for (const Item& item : gatherAll(comm_, mine_))
    survey_.subdomains[static_cast<std::size_t>(item.number)] = item.subdomain;
  survey_.boundaries = gatherLists(comm_, numbers_, boundaries_, survey_.subdomains.size());
}

} // namespace

PlanSurvey survey(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                  const run::RunOptions& options) {
  return Surveyor(comm, scene, options).go();
}

} // namespace Harmos::plan
