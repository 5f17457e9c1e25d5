// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AtomicFile.hpp"

#include "Harmos_Errors.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace Harmos::scene {

std::string partPath(const std::string& path) {
  return path + ".part";
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
    throw InputError("the output directory \"" + path + "\" cannot be made: " +
                         (error ? error.message() : std::string("something else has that name")),
                     {{"directory", path}});
}

} // namespace Harmos::scene
