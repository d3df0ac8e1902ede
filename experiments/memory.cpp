#include "experiments/memory.hpp"
#include <cstdio>
#include <cstdlib>
#include <cstring>
#if __has_include(<malloc.h>)
#include <malloc.h>
#endif

namespace trigrain {

#ifdef __GLIBC__
namespace {

/// The last `size="N"` behind the last `tag` of an XML text: those of all arenas come last.
std::optional<std::int64_t> last_size(const char* xml, const char* tag) {
  const char* found = nullptr;
  for (const char* at = xml; (at = std::strstr(at, tag)) != nullptr; ++at) found = at;
  const char* size = found ? std::strstr(found, "size=\"") : nullptr;
  if (!size) return std::nullopt;
  return std::strtoll(size + std::strlen("size=\""), nullptr, 10);
}

} // namespace

std::optional<std::int64_t> heap_in_use() {
  char* xml = nullptr;
  std::size_t length = 0;
  std::FILE* const file = open_memstream(&xml, &length);
  if (!file) return std::nullopt;
  const bool written = malloc_info(0, file) == 0;
  std::fclose(file);
  std::optional<std::int64_t> in_use;
  if (written) {
    const auto system = last_size(xml, "<system type=\"current\""), mapped = last_size(xml, "<total type=\"mmap\"");
    const auto fast = last_size(xml, "<total type=\"fast\""), rest = last_size(xml, "<total type=\"rest\"");
    if (system && mapped && fast && rest) in_use = *system + *mapped - *fast - *rest;
  }
  std::free(xml);
  return in_use;
}
#else
std::optional<std::int64_t> heap_in_use() { return std::nullopt; }
#endif

} // namespace trigrain
