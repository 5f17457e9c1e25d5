// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Partition.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_CellClusters.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GraphPartition.hpp"
#include "Harmos_Index.hpp"
#include "Harmos_PartShape.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace Harmos::fem {
namespace {

void requirePossible(const BodyMesh& body, int wanted) {
  const int cells = body.mesh.numberOfCells();
  if (wanted < 1 || wanted > cells)
    throw InputError("body \"" + body.name + "\" cannot be partitioned into " + std::to_string(wanted) +
                     " parts: it has " + std::to_string(cells) +
                     " cells. Choose between 1 and that many parts");
}

// Numbers parts in the order of their lowest cells.
void number(Partition& partition) {
  std::vector<int> numbers(static_cast<std::size_t>(partition.parts), -1);
  std::vector<double> necks;
  for (int& part : partition.part) {
    int& renumbered = numbers[static_cast<std::size_t>(part)];
    if (renumbered < 0) {
      renumbered = static_cast<int>(necks.size());
      necks.push_back(partition.necks[static_cast<std::size_t>(part)]);
    }
    part = renumbered;
  }
  partition.necks = necks;
}

// Of a body's parts, in any order.
void finish(const BodyMesh& body, Partition& partition) {
  number(partition);
  for (std::string& note : partition.notes)
    note.insert(0, "Body \"" + body.name + "\"");
}

// A body that is not cut in pieces first.
Partition partitionWhole(const BodyMesh& body, int wanted, const PartitionOptions& options) {
  const int cells = body.mesh.numberOfCells();
  const CellGraph graph = body.matched ? graphOf(body.mesh, *body.matched) : graphOf(body.mesh);
  Partition result;
  if (const int size = Details::clusterSize(cells, wanted, options.method); size > 1 && !body.isAlongCurve) {
    const std::vector<int> curve = curveThrough(graph.centres);
    result = Details::partition(reordered(graph, curve), wanted, size, options);
    const std::vector<int> alongCurve = result.part;
    for (std::size_t k = 0; k < curve.size(); ++k)
      result.part[at(curve[k])] = alongCurve[k];
  } else {
    result = Details::partition(graph, wanted, size, options);
  }
  finish(body, result);
  return result;
}

// A piece of a body on its way to the rank that cuts it.
struct Piece {
  std::vector<int> numbers; // parts wanted, dimension, cells; how many neighbours each has; neighbours
  std::vector<Point> centres;
};

// What becomes of it.
struct CutPiece {
  std::vector<int> part; // of each of its cells
  std::vector<double> necks;
  std::vector<char> notes; // sentences, each with its end
};

Piece pieceOf(const CellGraph& graph, const std::vector<int>& cells, int wanted, std::vector<int>& number) {
  Piece piece = {{wanted, graph.dimension, static_cast<int>(cells.size())}, {}};
  for (std::size_t k = 0; k < cells.size(); ++k)
    number[at(cells[k])] = static_cast<int>(k);
  std::vector<int> neighbours;
  for (int cell : cells) {
    const std::size_t before = neighbours.size();
    for (const int* other = graph.begin(cell); other != graph.end(cell); ++other)
      if (number[at(*other)] >= 0)
        neighbours.push_back(number[at(*other)]);
    piece.numbers.push_back(static_cast<int>(neighbours.size() - before));
    piece.centres.push_back(graph.centres[at(cell)]);
  }
  piece.numbers.insert(piece.numbers.end(), neighbours.begin(), neighbours.end());
  for (int cell : cells)
    number[at(cell)] = -1;
  return piece;
}

CutPiece cutPiece(const Piece& piece, const PartitionOptions& options) {
  if (piece.numbers.empty())
    return {};
  const int wanted = piece.numbers[0], cells = piece.numbers[2];
  CellGraph graph;
  graph.dimension = piece.numbers[1];
  graph.centres = piece.centres;
  graph.offsets = {0};
  const auto counts = piece.numbers.begin() + 3;
  for (int k = 0; k < cells; ++k)
    graph.offsets.push_back(graph.offsets.back() + at(counts[k]));
  graph.neighbours.assign(counts + cells, piece.numbers.end());
  const int size = std::max(1, Details::clusterSize(cells, wanted, options.method));
  Partition partition = Details::partition(graph, wanted, size, options);
  CutPiece result = {std::move(partition.part), std::move(partition.necks), {}};
  for (const std::string& note : partition.notes) {
    result.notes.insert(result.notes.end(), note.begin(), note.end());
    result.notes.push_back('\0');
  }
  return result;
}

// In how many pieces a body is cut first: each has so many cells that it is cut in clusters, and parts enough
// for the borders between pieces to be a small share of all. Not by the number of ranks: the same body gives
// the same parts on any. An exchange between ranks carries no more cells. Four pieces: half a ball in 64 and
// 96 parts takes 36 and 31 applications of F, in two pieces 30 and 26, as a whole 29 and 29.
int piecesOfBody(int cells, int wanted, PartitionMethod method) {
  constexpr int mostPieces = 2, leastCells = 30000, leastParts = 8, mostCells = 50000000;
  return method == PartitionMethod::Compact && cells <= mostCells
             ? std::max(1, std::min({mostPieces, cells / leastCells, wanted / leastParts}))
             : 1;
}

// A body between the ranks.
struct SharedBody {
  std::vector<int> curve;              // cells along it
  std::vector<std::vector<int>> cells; // of each piece, by their places on the curve
};

std::vector<int> asTheyAre(int cells) {
  std::vector<int> order(at(cells));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

// Pieces of a body; none if it is cut as a whole.
std::vector<Piece> piecesOf(const BodyMesh& body, int wanted, const PartitionOptions& options,
                            SharedBody& shared) {
  const int count = piecesOfBody(body.mesh.numberOfCells(), wanted, options.method);
  if (count == 1)
    return {};
  const CellGraph whole = body.matched ? graphOf(body.mesh, *body.matched) : graphOf(body.mesh);
  shared.curve = body.isAlongCurve ? asTheyAre(whole.cells()) : curveThrough(whole.centres);
  const CellGraph along = body.isAlongCurve ? CellGraph() : reordered(whole, shared.curve);
  const CellGraph& graph = body.isAlongCurve ? whole : along;
  const Partition few = Details::fewPieces(graph, count, options.seed);
  if (few.parts != count)
    return {};
  shared.cells = cellsOf(few.part, few.parts);
  const std::vector<int> parts = Details::sharedOut(wanted, shared.cells);
  std::vector<int> number(at(graph.cells()), -1);
  std::vector<Piece> pieces;
  for (std::size_t r = 0; r < parts.size(); ++r)
    pieces.push_back(pieceOf(graph, shared.cells[r], parts[r], number));
  return pieces;
}

// One of the pieces that came back.
void add(const SharedBody& shared, std::size_t piece, const CutPiece& cut, Partition& partition) {
  for (std::size_t k = 0; k < cut.part.size(); ++k)
    partition.part[at(shared.curve[at(shared.cells[piece][k])])] = partition.parts + cut.part[k];
  partition.parts += static_cast<int>(cut.necks.size());
  partition.necks.insert(partition.necks.end(), cut.necks.begin(), cut.necks.end());
  for (auto begin = cut.notes.begin(); begin != cut.notes.end();) {
    const auto end = std::find(begin, cut.notes.end(), '\0');
    if (*begin == ':') // of pieces of parts; what else there is to be told of the piece is not of the body
      partition.notes.emplace_back(begin, end);
    begin = end + 1;
  }
}

// Of all pieces, cut.
Partition joined(const BodyMesh& body, int wanted, const SharedBody& shared,
                 const std::vector<CutPiece>& pieces) {
  Partition result;
  result.part.assign(shared.curve.size(), 0);
  for (std::size_t p = 0; p < pieces.size(); ++p)
    add(shared, p, pieces[p], result);
  if (result.parts != wanted)
    result.notes.push_back(Details::otherThanWanted(result.parts, wanted));
  finish(body, result);
  return result;
}

// Pieces that are cut by as many ranks, one each. @param pieces of rank 0. @return there; nothing elsewhere.
std::vector<CutPiece> cutTogether(const Teuchos::Comm<int>& comm, std::vector<Piece> pieces,
                                  const PartitionOptions& options) {
  const auto ranks = at(comm.getSize());
  std::vector<std::vector<int>> numbers(ranks), part(ranks);
  std::vector<std::vector<Point>> centres(ranks);
  std::vector<std::vector<double>> necks(ranks);
  std::vector<std::vector<char>> notes(ranks);
  for (std::size_t r = 0; r < pieces.size(); ++r) {
    numbers[r] = std::move(pieces[r].numbers);
    centres[r] = std::move(pieces[r].centres);
  }
  const Piece mine = {exchangeItems(comm, numbers).front(), exchangeItems(comm, centres).front()};
  agree(comm, [&] {
    CutPiece cut = cutPiece(mine, options);
    part.front() = std::move(cut.part);
    necks.front() = std::move(cut.necks);
    notes.front() = std::move(cut.notes);
  });
  part = exchangeItems(comm, part);
  necks = exchangeItems(comm, necks);
  notes = exchangeItems(comm, notes);
  std::vector<CutPiece> result;
  for (std::size_t r = 0; r < pieces.size(); ++r)
    result.push_back({std::move(part[r]), std::move(necks[r]), std::move(notes[r])});
  return result;
}

} // namespace

Partition partitionCells(const BodyMesh& body, int wanted, const PartitionOptions& options) {
  requirePossible(body, wanted);
  SharedBody shared;
  const std::vector<Piece> pieces = piecesOf(body, wanted, options, shared);
  if (pieces.empty())
    return partitionWhole(body, wanted, options);
  std::vector<CutPiece> cut;
  for (const Piece& piece : pieces)
    cut.push_back(cutPiece(piece, options));
  return joined(body, wanted, shared, cut);
}

Partition partitionCells(const Teuchos::Comm<int>& comm, const BodyMesh* body, int wanted,
                         const PartitionOptions& options) {
  const bool isRoot = comm.getRank() == 0;
  Partition result;
  SharedBody shared;
  std::vector<Piece> pieces;
  agree(comm, [&] {
    if (!isRoot)
      return;
    HARMOS_REQUIRE(body != nullptr, "rank 0 has the body");
    requirePossible(*body, wanted);
    pieces = piecesOf(*body, wanted, options, shared);
    if (pieces.empty())
      result = partitionWhole(*body, wanted, options);
  });
  const auto count = at(globalMax(comm, static_cast<long long>(pieces.size())));
  std::vector<CutPiece> cut;
  for (std::size_t first = 0; first < count; first += at(comm.getSize())) {
    std::vector<Piece> round;
    for (std::size_t p = first; p < std::min(pieces.size(), first + at(comm.getSize())); ++p)
      round.push_back(std::move(pieces[p]));
    for (CutPiece& piece : cutTogether(comm, std::move(round), options))
      cut.push_back(std::move(piece));
  }
  agree(comm, [&] {
    if (isRoot && count > 0)
      result = joined(*body, wanted, shared, cut);
  });
  return result;
}

Partition mendParts(const BodyMesh& body, const std::vector<int>& part) {
  HARMOS_REQUIRE(static_cast<int>(part.size()) == body.mesh.numberOfCells(), "each cell needs a part");
  return Details::mended(graphOf(body.mesh), part);
}

} // namespace Harmos::fem
