// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MeshProgram.hpp"

#include "Harmos_BodyBlocks.hpp"
#include "Harmos_CutMeshFile.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_GmshFile.hpp"
#include "Harmos_MeshReport.hpp"
#include "Harmos_MpiStart.hpp"
#include "Harmos_NearestName.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_TornBody.hpp"
#include "Harmos_Version.hpp"

#include <CLI/CLI.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Core.hpp>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <numeric>
#include <optional>
#include <sstream>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace Harmos::app {
namespace {

constexpr int done = 0, badInput = 2, internalError = 3;

struct Request {
  std::string file, output;
  std::vector<std::string> bodies; // "name" or "name=group,group"
  int subdomains = 1;
  std::vector<std::string> perBody; // "name=number"
  std::string partition = "compact";
  int seed = 1;
  int dimension = 0; // as the file has it
  fem::GmshMeshing meshing;
};

std::pair<std::string, std::string> halves(const std::string& text) {
  const std::size_t sign = text.find('=');
  return sign == std::string::npos ? std::make_pair(text, std::string())
                                   : std::make_pair(text.substr(0, sign), text.substr(sign + 1));
}

std::optional<int> parse(int argc, char** argv, Request& request) {
  CLI::App cli("Reads a mesh (.msh, .exo, .vtk, .vtu, .mesh, .bdf, .unv) or meshes a geometry (.geo, .step), "
               "tells what it holds and partitions it. A deck reads the output file by \"Model/Mesh file\"",
               "harmos-mesh");
  cli.add_option("file", request.file, "Mesh or geometry")->type_name("FILE");
  cli.add_option("--output", request.output, "Output file with the partitioned mesh; without it, report only")
      ->type_name("FILE.h5");
  cli.add_option("--body", request.bodies,
                 "A body: the name of its group, or a name and its groups, each a region: \"ring\", "
                 "\"ring=steel,rubber\". Default: each group of the highest dimension is a body")
      ->type_name("NAME[=GROUP,...]")
      ->expected(1)
      ->take_all();
  cli.add_option("--subdomains", request.subdomains,
                 "Total number of subdomains, distributed over the bodies by their numbers of cells")
      ->check(CLI::Range(1, 100000000));
  cli.add_option("--cut", request.perBody, "Number of subdomains of one body: \"ring=24\"")
      ->type_name("NAME=NUMBER")
      ->expected(1)
      ->take_all();
  cli.add_option("--partition", request.partition, "Partitioning method")
      ->check(CLI::IsMember({"compact", "METIS"}));
  cli.add_option("--partition-seed", request.seed,
                 "Seed of the partitioner; other seeds give other partitions of equal quality")
      ->check(CLI::Range(0, 1000000));
  cli.add_option("--dimension", request.dimension,
                 "Dimension of the bodies; default: 3 if the file has cells or shapes of dimension 3, else 2")
      ->check(CLI::IsMember({2, 3}));
  cli.add_option("--size", request.meshing.size, "Geometries: approximate longest cell edge")
      ->type_name("LENGTH")
      ->check(CLI::Range(1e-100, 1e100));
  cli.add_option("--per-circle", request.meshing.perCircle,
                 "Geometries: number of cell edges per full circle on curved parts")
      ->type_name("NUMBER")
      ->check(CLI::Range(3, 100000));
  cli.add_option("--order", request.meshing.order,
                 "Geometries: order of the cells, 1 or 2 (tetrahedra of 4 or 10 nodes)")
      ->check(CLI::IsMember({1, 2}));
  bool version = false;
  cli.add_flag("--version", version, "Print the version, then exit");
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      std::cout << cli.help();
      return done;
    }
    std::cerr << "error: command line: " << error.what()
              << "\nUsage: harmos-mesh [OPTIONS] FILE; see --help\n";
    return badInput;
  }
  if (version) {
    std::cout << "harmos-mesh (Harmos) " << Harmos::version() << " " << gitHash() << "\n";
    return done;
  }
  if (request.file.empty()) {
    std::cerr << "error: command line: no file given; usage: harmos-mesh [OPTIONS] FILE\n";
    return badInput;
  }
  if (fem::CutMeshFile::isOne(request.file)) {
    std::cerr << "error: \"" << request.file
              << "\" is already partitioned; a deck reads it by \"Model/Mesh file\". Give the original mesh "
                 "to partition it again\n";
    return badInput;
  }
  if (!request.output.empty() && !fem::CutMeshFile::isOne(request.output)) {
    std::cerr << "error: command line: --output \"" << request.output
              << "\" does not end with \".h5\", the suffix of partitioned meshes\n";
    return badInput;
  }
  return std::nullopt;
}

std::vector<fem::GmshBody> bodiesOf(const Request& request) {
  std::vector<fem::GmshBody> bodies;
  for (const std::string& text : request.bodies) {
    const auto [name, groups] = halves(text);
    if (name.empty())
      throw InputError("command line: --body \"" + text + "\" has no body name before its groups");
    for (const fem::GmshBody& other : bodies)
      if (other.name == name)
        throw InputError("command line: --body names \"" + name +
                         "\" twice; give each body a name of its own");
    fem::GmshBody body{name, {}};
    std::istringstream list(groups.empty() ? name : groups);
    for (std::string group; std::getline(list, group, ',');)
      body.groups.push_back(group);
    bodies.push_back(body);
  }
  return bodies;
}

int numberIn(const std::string& text, const std::string& option) {
  char* end = nullptr;
  const long number = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || number < 1 || number > 1000000)
    throw InputError("command line: " + option +
                     " needs a number of subdomains from 1 to 1000000 after \"=\"");
  return static_cast<int>(number);
}

using Bodies = std::vector<std::vector<fem::BodyMesh>>; // the blocks of each

// Of each body: what is said of it, else its share of all cells.
std::vector<int> subdomainsOf(const Request& request, const Bodies& bodies) {
  std::vector<std::string> names;
  std::vector<double> cells;
  for (const std::vector<fem::BodyMesh>& blocks : bodies) {
    names.push_back(blocks.front().name);
    cells.push_back(0.0);
    for (const fem::BodyMesh& block : blocks)
      cells.back() += block.mesh.numberOfCells();
  }
  const double all = std::accumulate(cells.begin(), cells.end(), 0.0);
  std::vector<int> wanted;
  for (double own : cells)
    // In double: the product of the two numbers is beyond an int.
    wanted.push_back(std::max(1, static_cast<int>(std::lround(request.subdomains * (own / all)))));
  for (const std::string& text : request.perBody) {
    const auto [name, number] = halves(text);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      throw InputError("command line: --cut names the unknown body \"" + name + "\"" + offer(name, names));
    wanted[static_cast<std::size_t>(found - names.begin())] = numberIn(number, "--cut \"" + name + "\"");
  }
  return wanted;
}

void cutAndWrite(const Request& request, Bodies bodies) {
  const std::vector<int> wanted = subdomainsOf(request, bodies);
  fem::PartitionOptions options;
  if (request.partition == "METIS")
    options.method = fem::PartitionMethod::Metis;
  options.seed = request.seed;
  std::vector<fem::CutBody> cut;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::vector<int> parts = fem::partsOfBlocks(bodies[b], wanted[b]);
    const long long nodes = fem::numberOfNodes(bodies[b]);
    int count = 0;
    std::string notes;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      fem::BodyMesh block = std::move(bodies[b][k]); // its memory is needed afterwards
      const fem::Partition partition = fem::partitionCells(block, parts[k], options);
      cut.push_back({block.name, block.mesh.cellType, nodes, block.regions,
                     fem::tear(block, partition.part, partition.parts, 0)});
      count += partition.parts;
      for (const std::string& note : partition.notes)
        notes += note + "\n";
    }
    std::cout << "Body \"" << cut.back().name << "\": cut into " << count
              << (count == 1 ? " part\n" : " parts\n") << notes;
  }
  fem::writeCutMesh(Teuchos::MpiComm<int>(MPI_COMM_SELF), request.output, cut);
  std::cout << "Written: \"" << request.output << "\"\n";
}

int work(int argc, char** argv, const Request& request) {
  prepareMpiStart();
  const Tpetra::ScopeGuard guard(&argc, &argv);
  try {
    if (Tpetra::getDefaultComm()->getSize() > 1)
      throw InputError("harmos-mesh is a serial program; start it without mpirun");
    Bodies bodies = fem::groupedByBody(
        fem::readGmsh(request.file, bodiesOf(request), request.dimension, request.meshing));
    std::cout << reportOf(bodies) << std::flush;
    if (!request.output.empty())
      cutAndWrite(request, std::move(bodies));
    return done;
  } catch (const Error& error) {
    std::cerr << "error: " << error.what() << "\n";
    return error.kind() == Error::Kind::Internal ? internalError : badInput;
  } catch (const std::bad_alloc&) {
    std::cerr << "error: out of memory while reading \"" << request.file
              << "\"; the file is too large for this machine or damaged\n";
    return badInput;
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return internalError;
  }
}

// What damaged files ask for is not to take the machine's memory away from all others.
void limitMemory() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  if (pages > 0 && size > 0) {
    const rlim_t bytes = static_cast<rlim_t>(pages) * static_cast<rlim_t>(size);
    const rlimit limit = {bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
}

} // namespace

int meshMain(int argc, char** argv) {
  Request request;
  if (const std::optional<int> status = parse(argc, argv, request))
    return *status;
  // Gmsh ends the process that it is in where some files are damaged.
  const pid_t child = fork();
  if (child == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL); // not to go on where its parent was killed
    limitMemory();
    std::exit(work(argc, argv, request));
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) < 0) {
    std::cerr << "error: cannot start a process to read \"" << request.file << "\"\n";
    return internalError;
  }
  if (WIFEXITED(status))
    return WEXITSTATUS(status);
  if (WTERMSIG(status) == SIGPIPE) // nobody reads what it prints
    return 128 + SIGPIPE;
  if (WTERMSIG(status) == SIGKILL) {
    std::cerr
        << "error: the process that read \"" << request.file
        << "\" was killed, probably for lack of memory; use larger cells or a machine with more memory\n";
    return badInput;
  }
  std::cerr
      << "error: Gmsh crashed on \"" << request.file << "\" (signal " << WTERMSIG(status)
      << "): the file is damaged or uses an unsupported feature. Open it in Gmsh to locate the failure\n";
  return badInput;
}

} // namespace Harmos::app
