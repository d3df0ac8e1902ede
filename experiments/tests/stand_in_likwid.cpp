// Stands in for LIKWID's library: notes down, per CPU and region, how often it was entered and what went wrong. On
// close it writes one line "region cpu calls" each to the file that LIKWID_FILEPATH names, or "wrong: ..." lines.
#include <cstdlib>
#include <fstream>
#include <map>
#include <mutex>
#include <sched.h>
#include <string>
#include <utility>

namespace {
std::mutex guard;
std::map<std::pair<std::string, int>, long> calls;
std::string wrong;
thread_local std::string open_region;
thread_local int open_cpu = -1;
thread_local bool known = false;
} // namespace

extern "C" {
void likwid_markerInit() {}
void likwid_markerThreadInit() { known = true; }
int likwid_markerStartRegion(const char* tag) {
  const std::lock_guard lock(guard);
  if (!known) wrong += "wrong: a thread was not announced\n";
  if (!open_region.empty()) wrong += "wrong: " + std::string(tag) + " inside " + open_region + "\n";
  open_region = tag;
  open_cpu = sched_getcpu();
  return 0;
}
int likwid_markerStopRegion(const char* tag) {
  const std::lock_guard lock(guard);
  if (open_region != tag) wrong += "wrong: " + std::string(tag) + " ends inside '" + open_region + "'\n";
  if (open_cpu != sched_getcpu()) wrong += "wrong: a thread moved within a region\n";
  ++calls[{open_region, open_cpu}];
  open_region.clear();
  return 0;
}
void likwid_markerClose() {
  std::ofstream out(std::getenv("LIKWID_FILEPATH"));
  out << wrong;
  for (const auto& [where, count] : calls) out << where.first << ' ' << where.second << ' ' << count << '\n';
}
}
