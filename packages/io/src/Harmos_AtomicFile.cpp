// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AtomicFile.hpp"

#include "Harmos_Errors.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace Harmos::io {

std::string partPath(const std::string& path) {
  return path + ".part";
}

void makePart(const std::string& path, long long bytes) {
  const std::string part = partPath(path);
  const int file = ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  int fault = file < 0 ? errno : 0;
  if (file >= 0) {
    // Not posix_fallocate(), which writes where a file system knows no reservation.
    if (bytes > 0 && ::fallocate(file, 0, 0, bytes) != 0 && errno != EOPNOTSUPP && errno != ENOSYS)
      fault = errno;
    if (::ftruncate(file, 0) != 0 && fault == 0)
      fault = errno;
    ::close(file);
    if (fault != 0)
      ::unlink(part.c_str());
  }
  if (fault != 0)
    throw InputError("the file \"" + path + "\" cannot be written: it needs " +
                         std::to_string((bytes + 1048575) / 1048576) + " MiB: " + std::strerror(fault) +
                         "; check that the directory is writable and the disk is not full",
                     {{"file", path}});
}

void requirePart(const std::string& path) {
  const int file = ::open(partPath(path).c_str(), O_WRONLY);
  if (file < 0)
    throw InputError("the file \"" + path + "\" cannot be written by all ranks: " + std::strerror(errno) +
                         "; use an output directory that all nodes share",
                     {{"file", path}});
  ::close(file);
}

void syncPart(const std::string& path) {
  const int file = ::open(partPath(path).c_str(), O_RDONLY);
  const bool failed = file < 0 || ::fsync(file) != 0;
  const std::string reason = failed ? std::strerror(errno) : "";
  if (file >= 0)
    ::close(file);
  if (failed)
    throw InputError("the file \"" + path + "\" cannot be written: " + reason +
                         "; check that the disk is not full",
                     {{"file", path}});
}

void renamePart(const std::string& path) {
  std::error_code error;
  std::filesystem::rename(partPath(path), path, error);
  if (!error)
    return;
  const std::string reason = error.message();
  std::filesystem::remove(partPath(path), error);
  throw InputError("the file \"" + path + "\" cannot be written: " + reason, {{"file", path}});
}

void writeAtomically(const std::string& path, const std::string& text) {
  {
    std::ofstream stream(partPath(path), std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) {
      const std::string reason = std::strerror(errno);
      std::error_code ignored;
      std::filesystem::remove(partPath(path), ignored);
      throw InputError("the file \"" + path + "\" cannot be written: " + reason +
                           "; check that the directory is writable and the disk is not full",
                       {{"file", path}});
    }
  }
  renamePart(path);
}

void removeFile(const std::string& path) {
  std::error_code error;
  const bool isDirectory = std::filesystem::is_directory(path, error);
  if (!isDirectory)
    std::filesystem::remove(path, error);
  if (isDirectory || error)
    throw InputError("the file \"" + path + "\" cannot be written: " +
                         (isDirectory ? std::string("a directory has that name") : error.message()),
                     {{"file", path}});
}

void makeDirectory(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error || !std::filesystem::is_directory(path))
    throw InputError("the output directory \"" + path + "\" cannot be created: " +
                         (error ? error.message() : std::string("a file of that name exists")),
                     {{"directory", path}});
}

} // namespace Harmos::io
