#pragma once
#include <filesystem>
#include <string_view>

namespace trigrain {

/// Writes `text` to `file` whole or not at all: to a temporary name in the same folder, fsync, rename.
/// InputError names the file and the system's reason; nothing is left behind then. A device or pipe is written to as it
/// is.
void write_atomically(const std::filesystem::path& file, std::string_view text);

/// Says before a long run whether write_atomically(file) can work: InputError if the folder is missing or closed or if
/// `file` is a folder itself.
void require_writable(const std::filesystem::path& file);

} // namespace trigrain
