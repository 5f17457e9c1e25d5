// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CheckpointFile.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <sstream>

namespace Harmos::run {
namespace {

const char* const format = "Harmos checkpoint 12";
const char* const what = "the checkpoint";

using Importer = Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>;

// The finaliser of SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): every bit of the result depends on every bit
// of the argument.
std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// Of this rank's elements, which begin at the place `first`, and of all ranks.
template<class T>
long long checksum(const Teuchos::Comm<int>& comm, const std::vector<T>& mine, long long first) {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < mine.size(); ++k) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &mine[k], sizeof(T));
    sum += mixed(mixed(static_cast<std::uint64_t>(first) + k) ^ bits);
  }
  // In halves: the sum over the ranks is not to overflow.
  const auto low = static_cast<std::uint64_t>(globalSum(comm, static_cast<long long>(sum & 0xffffffffULL)));
  const auto high = static_cast<std::uint64_t>(globalSum(comm, static_cast<long long>(sum >> 32)));
  const std::uint64_t total = low + (high << 32);
  long long result = 0;
  std::memcpy(&result, &total, sizeof(result));
  return result;
}

std::vector<unsigned char> bytesOf(const std::string& text) {
  return {text.begin(), text.end()};
}

std::string textOf(const std::vector<unsigned char>& bytes) {
  return {bytes.begin(), bytes.end()};
}

// The rows of a vector in equal shares, in the order of their numbers.
Teuchos::RCP<const Map> linearMap(const Map& map) {
  return Teuchos::rcp(new Map(map.getGlobalNumElements(), 0, map.getComm()));
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

} // namespace

std::string checkpointPath(const std::string& directory) {
  return directory + "/checkpoint.h5";
}

void StateSize::numbers(const std::string& name, std::vector<double>& values) {
  bytes_ += static_cast<long long>(name.size() + 1 + sizeof(long long) + values.size() * sizeof(double));
}

void StateSize::vector(const std::string&, MultiVector& x) {
  unknowns_ = static_cast<long long>(x.getGlobalLength());
  bytes_ += unknowns_ * static_cast<long long>(x.getNumVectors() * sizeof(double));
}

// As it stands, and in the space of the unknowns.
void StateSize::rowVector(const std::string&, MultiVector& x) {
  const auto whole = x.getMap()->isDistributed() ? 0LL : static_cast<long long>(x.getLocalLength());
  bytes_ += static_cast<long long>(sizeof(double)) * (unknowns_ + whole);
}

CheckpointWriter::CheckpointWriter(const Teuchos::Comm<int>& comm, const std::string& path,
                                   const RowBasis& basis, long long bytes)
    : comm_(comm), basis_(basis), file_(comm, path, what, bytes) {
  file_.group("/vectors");
  file_.group("/texts");
  text("format", format);
}

template<class T>
void CheckpointWriter::write(const std::string& dataset, const std::vector<T>& mine, std::size_t width,
                             long long first, long long total) {
  file_.rows(dataset, mine, width, first, total);
  names_ += dataset + "\n";
  sums_.push_back(checksum(comm_, mine, first * static_cast<long long>(width)));
}

void CheckpointWriter::numbers(const std::string& name, std::vector<double>& values) {
  HARMOS_REQUIRE(numbers_.emplace(name, values).second, "\"" + name + "\" is written twice");
}

void CheckpointWriter::vector(const std::string& name, MultiVector& x) {
  const Teuchos::RCP<const Map> map = linearMap(*x.getMap());
  const std::size_t width = x.getNumVectors();
  MultiVector linear(map, width);
  linear.doImport(x, Importer(x.getMap(), map), Tpetra::INSERT);
  const auto view = linear.getLocalViewHost(Tpetra::Access::ReadOnly);
  std::vector<double> mine;
  mine.reserve(view.extent(0) * width);
  for (std::size_t i = 0; i < view.extent(0); ++i)
    for (std::size_t j = 0; j < width; ++j)
      mine.push_back(view(i, j));
  write("/vectors/" + name, mine, width, exclusiveScan(comm_, static_cast<long long>(view.extent(0))),
        static_cast<long long>(map->getGlobalNumElements()));
  if (width == 1)
    dualLike_ = Teuchos::rcp(new MultiVector(x.getMap(), 1));
}

void CheckpointWriter::rowVector(const std::string& name, MultiVector& x) {
  HARMOS_REQUIRE(!dualLike_.is_null(), "a vector of the rows comes after one of the unknowns");
  if (!x.getMap()->isSameAs(*dualLike_->getMap())) { // the same on every rank
    const auto view = x.getLocalViewHost(Tpetra::Access::ReadOnly);
    std::vector<double> values;
    for (std::size_t k = 0; k < view.extent(0); ++k)
      values.push_back(view(k, 0));
    numbers(name, values);
  }
  MultiVector dual(dualLike_->getMap(), 1);
  basis_.toDual(x, dual);
  vector(name + " in the space of the unknowns", dual);
}

void CheckpointWriter::text(const std::string& name, const std::string& value) {
  const bool isFirst = comm_.getRank() == 0;
  write("/texts/" + name, isFirst ? bytesOf(value) : std::vector<unsigned char>(), 1,
        isFirst ? 0 : static_cast<long long>(value.size()), static_cast<long long>(value.size()));
}

void CheckpointWriter::commit() {
  std::string names;
  std::vector<double> values;
  std::vector<long long> lengths;
  for (const auto& [name, list] : numbers_) {
    names += name + "\n";
    lengths.push_back(static_cast<long long>(list.size()));
    values.insert(values.end(), list.begin(), list.end());
  }
  text("names of numbers", names);
  const bool isFirst = comm_.getRank() == 0;
  const auto once = [&](const std::string& dataset, const auto& all) {
    using List = std::decay_t<decltype(all)>;
    const auto total = static_cast<long long>(all.size());
    write(dataset, isFirst ? all : List(), 1, isFirst ? 0 : total, total);
  };
  once("/numbers", values);
  once("/lengths", lengths);
  const std::vector<long long> sums = sums_;
  const std::vector<unsigned char> datasets = bytesOf(names_);
  once("/checked datasets", datasets);
  once("/checksums", sums);
  file_.commit();
}

CheckpointReader::CheckpointReader(const Teuchos::Comm<int>& comm, const std::string& path)
    : comm_(comm), path_(path) {
  agree(comm, [&] {
    if (!std::filesystem::exists(path))
      throw InputError("checkpoint not found: \"" + path +
                           "\"; give the output directory of an interrupted run or start without --restart",
                       {{"file", path}});
  });
  try {
    agree(comm, [&] { file_ = std::make_unique<io::Hdf5Reader>(path, what); });
    verify();
    agree(comm, [&] {
      if (text("format") != format)
        throw InputError("its format is \"" + text("format") + "\", not \"" + format + "\"");
      const std::vector<std::string> names =
          linesOf(textOf(file_->all<unsigned char>("/texts/names of numbers")));
      const std::vector<double> values = file_->all<double>("/numbers");
      const std::vector<long long> lengths = file_->all<long long>("/lengths");
      std::size_t place = 0;
      for (std::size_t k = 0; k < names.size(); ++k) {
        const auto length = static_cast<std::size_t>(lengths.at(k));
        numbers_[names[k]].assign(values.begin() + static_cast<std::ptrdiff_t>(place),
                                  values.begin() + static_cast<std::ptrdiff_t>(place + length));
        place += length;
      }
    });
  } catch (const InputError& error) {
    throw InputError("the checkpoint \"" + path + "\" is damaged (" + error.what() +
                         "); nothing was computed. Restart from another one, or start without --restart",
                     {{"file", path}});
  }
}

// All datasets, in equal shares.
void CheckpointReader::verify() const {
  std::vector<std::string> names;
  std::vector<long long> sums;
  agree(comm_, [&] {
    names = linesOf(textOf(file_->all<unsigned char>("/checked datasets")));
    sums = file_->all<long long>("/checksums");
    if (names.empty() || sums.size() != names.size())
      throw InputError("its checksums are incomplete");
  });
  const int ranks = comm_.getSize(), rank = comm_.getRank();
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::string& name = names[k];
    long long sum = 0;
    const auto sumOf = [&](auto element) {
      using T = decltype(element);
      std::vector<T> mine;
      long long first = 0;
      agree(comm_, [&] {
        const io::Hdf5Reader::Shape shape = file_->shape(name);
        first = shape.rows * rank / ranks;
        mine = file_->rows<T>(name, first, shape.rows * (rank + 1) / ranks - first);
        first *= static_cast<long long>(shape.width);
      });
      sum = checksum(comm_, mine, first);
    };
    if (name.rfind("/texts/", 0) == 0)
      sumOf(static_cast<unsigned char>(0));
    else if (name == "/lengths")
      sumOf(0LL);
    else
      sumOf(0.0);
    if (sum != sums[k])
      throw InputError("the checksum of its \"" + name.substr(name.rfind('/') + 1) + "\" does not match");
  }
}

std::string CheckpointReader::text(const std::string& name) const {
  return file_->has("/texts/" + name) ? textOf(file_->all<unsigned char>("/texts/" + name)) : "";
}

class CheckpointReader::Archive : public qp::StateArchive<MultiVector> {
 public:
  Archive(const CheckpointReader& reader, const RowBasis& basis) : reader_(reader), basis_(basis) {}

  bool isReading() const override { return true; }

  void numbers(const std::string& name, std::vector<double>& values) override {
    const auto found = reader_.numbers_.find(name);
    if (found == reader_.numbers_.end())
      throw unfit("it has no \"" + name + "\"");
    values = found->second;
  }

  void vector(const std::string& name, MultiVector& x) override {
    const Teuchos::RCP<const Map> map = linearMap(*x.getMap());
    const std::size_t width = x.getNumVectors();
    MultiVector linear(map, width);
    const auto count = static_cast<long long>(localSize(*map));
    const long long first = exclusiveScan(reader_.comm_, count);
    const std::string dataset = "/vectors/" + name;
    agree(reader_.comm_, [&] {
      if (!reader_.file_->has(dataset))
        throw unfit("it has no \"" + name + "\"");
      const io::Hdf5Reader::Shape shape = reader_.file_->shape(dataset);
      if (shape.rows != static_cast<long long>(map->getGlobalNumElements()) || shape.width != width)
        throw unfit("its \"" + name + "\" has " + std::to_string(shape.rows) + " rows of " +
                    std::to_string(shape.width) + ", not " + std::to_string(map->getGlobalNumElements()) +
                    " of " + std::to_string(width));
      const std::vector<double> mine = reader_.file_->rows<double>(dataset, first, count);
      const auto view = linear.getLocalViewHost(Tpetra::Access::OverwriteAll);
      for (std::size_t i = 0; i < view.extent(0); ++i)
        for (std::size_t j = 0; j < width; ++j)
          view(i, j) = mine[i * width + j];
    });
    x.doImport(linear, Importer(map, x.getMap()), Tpetra::INSERT);
    if (width == 1)
      dualMap_ = x.getMap();
  }

  void rowVector(const std::string& name, MultiVector& x) override {
    MultiVector stored(dualMap_, 1), present(dualMap_, 1);
    vector(name + " in the space of the unknowns", stored);
    // One of the two need not be as the rows are now, whole on every rank or in shares.
    if (x.getMap()->isSameAs(*dualMap_) || !reader_.holds(name)) {
      basis_.fromDual(stored, x);
      return;
    }
    std::vector<double> values;
    numbers(name, values);
    if (values.size() != x.getLocalLength())
      throw unfit("its \"" + name + "\" has " + std::to_string(values.size()) + " numbers, not " +
                  std::to_string(x.getLocalLength()));
    std::copy(values.begin(), values.end(), x.getLocalViewHost(Tpetra::Access::OverwriteAll).data());
    basis_.toDual(x, present);
    present.update(-1.0, stored, 1.0);
    std::vector<double> distance(1), norm(1);
    present.norm2(Teuchos::arrayViewFromVector(distance));
    stored.norm2(Teuchos::arrayViewFromVector(norm));
    // Rounding errors of sums of some ten thousand terms, against another basis, which differs in the first
    // digit.
    if (distance[0] > 1e-10 * norm[0])
      basis_.fromDual(stored, x);
  }

 private:
  InputError unfit(const std::string& fault) const {
    return InputError("the checkpoint \"" + reader_.path_ + "\" does not match the problem: " + fault +
                          "; restart with the deck and the meshes of the run that wrote it",
                      {{"file", reader_.path_}});
  }

  const CheckpointReader& reader_;
  RowBasis basis_;
  Teuchos::RCP<const Map> dualMap_;
};

void CheckpointReader::restore(const RowBasis& basis,
                               const std::function<void(qp::StateArchive<MultiVector>&)>& exchange) const {
  Archive archive(*this, basis);
  exchange(archive);
}

} // namespace Harmos::run
