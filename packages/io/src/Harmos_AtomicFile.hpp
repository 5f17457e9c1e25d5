// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace Harmos::io {

/// Writes a text file that appears whole or not at all: beside, then renamed. Local.
/// @throws InputError naming the file and the system's reason.
void writeAtomically(const std::string& path, const std::string& text);

/// Makes a directory and its parents. Local. @throws InputError
void makeDirectory(const std::string& path);

/// Removes a file if it is there. Local. @throws InputError if it stays.
void removeFile(const std::string& path);

/// Where a file is written before it gets its name.
std::string partPath(const std::string& path);

/// Makes an empty partPath(), and sees to it that so many bytes fit there, as far as the file system tells.
/// Local. @throws InputError with what would be needed.
void makePart(const std::string& path, long long bytes);

/// Sees to it that this rank can open the partPath() that another one has made. Local. @throws InputError
void requirePart(const std::string& path);

/// Waits until the disk has what was written to partPath(). Local. @throws InputError
void syncPart(const std::string& path);

/// Gives a finished file its name. Local. @throws InputError
void renamePart(const std::string& path);

} // namespace Harmos::io
