#include "experiments/atomic_file.hpp"
#include "kernels/name_table.hpp"
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace trigrain {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, int reason) {
  throw InputError("cannot write '" + file.string() + "' (" + std::strerror(reason) +
                   "). Name a file in a folder that exists and may be written.");
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// A device such as /dev/null or a pipe: it takes text, and must not be replaced by a file.
bool is_stream(const fs::path& file) {
  const fs::file_status status = fs::status(file);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Writes all of `text` to an open descriptor; `file` is its name for messages.
void write_all(int descriptor, std::string_view text, const fs::path& file) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno != EINTR) refuse(file, errno);
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void write_through(const fs::path& stream, std::string_view text) {
  const int descriptor = ::open(stream.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) refuse(stream, errno);
  write_all(descriptor, text, stream);
  ::close(descriptor);
}

/// A file that is gone again unless it was renamed.
class Temporary {
 public:
  explicit Temporary(const fs::path& target)
      : target_(target),
        name_(folder_of(target) / ("." + target.filename().string() + "." + std::to_string(::getpid()) + ".part")) {
    if (fs::is_directory(target)) refuse(target, EISDIR);
    descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) refuse(target, errno);
  }
  ~Temporary() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(name_.c_str());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  void write(std::string_view text) { write_all(descriptor_, text, target_); }
  void rename() {
    if (::fsync(descriptor_) != 0) refuse(target_, errno);
    if (::rename(name_.c_str(), target_.c_str()) != 0) refuse(target_, errno);
    renamed_ = true;
    const int folder = ::open(folder_of(target_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return; // the file is there; only its name may not outlive a power cut
    ::fsync(folder);
    ::close(folder);
  }

 private:
  fs::path target_, name_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

} // namespace

void write_atomically(const fs::path& file, std::string_view text) {
  if (is_stream(file)) return write_through(file, text);
  Temporary temporary(file);
  temporary.write(text);
  temporary.rename();
}

void require_writable(const fs::path& file) {
  if (!is_stream(file)) Temporary probe(file);
}

} // namespace trigrain
