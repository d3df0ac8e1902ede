#include "experiments/likwid_marker.hpp"
#include <atomic>
#include <cstdlib>
#include <dlfcn.h>
#include <sched.h>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace trigrain {
namespace {

constexpr const char* library_names[] = {"liblikwid.so.5", "liblikwid.so"};

/// The functions of LIKWID's marker interface that are used (likwid.h of version 5).
struct Library {
  void (*init)() = nullptr;
  void (*thread_init)() = nullptr;
  int (*start)(const char* tag) = nullptr;
  int (*stop)(const char* tag) = nullptr;
  void (*close)() = nullptr;
};

// LIKWID's session belongs to the process; so does this.
Library library;
bool loaded = false, counting = false;
std::vector<int> cpus; // that LIKWID watches
std::atomic<int> threads_seen = 0;
std::atomic<bool> refused = false;

template <class Function> void resolve(void* handle, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(handle, name));
  if (!function) throw std::runtime_error(std::string("liblikwid has no ") + name + ". Install LIKWID 5.");
}

void load() {
  void* handle = nullptr;
  for (const char* name : library_names)
    if (!handle) handle = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);
  if (!handle)
    throw std::runtime_error(std::string("cannot load LIKWID (") + ::dlerror() + "). Run without likwid-perfctr -m.");
  resolve(handle, "likwid_markerInit", library.init);
  resolve(handle, "likwid_markerThreadInit", library.thread_init);
  resolve(handle, "likwid_markerStartRegion", library.start);
  resolve(handle, "likwid_markerStopRegion", library.stop);
  resolve(handle, "likwid_markerClose", library.close);
}

/// "0,2,4" from likwid-perfctr.
std::vector<int> watched_cpus() {
  std::vector<int> found;
  const char* list = std::getenv("LIKWID_THREADS");
  std::istringstream text(list ? list : "");
  for (std::string word; std::getline(text, word, ',');) found.push_back(std::atoi(word.c_str()));
  return found;
}

/// Ties the calling thread to a watched CPU of its own, once.
void enter_thread() {
  thread_local const bool entered = [] {
    const int number = threads_seen++;
    if (number < static_cast<int>(cpus.size())) {
      cpu_set_t set;
      CPU_ZERO(&set);
      CPU_SET(cpus[number], &set);
      if (sched_setaffinity(0, sizeof set, &set) != 0) refused = true;
    }
    library.thread_init();
    return true;
  }();
  static_cast<void>(entered);
}

void begin_piece(Phase phase, Piece, const void*) {
  if (!counting) return;
  enter_thread();
  if (library.start(phase_names[static_cast<std::size_t>(phase)].data()) != 0) refused = true;
}

void end_piece(Phase phase) {
  if (counting && library.stop(phase_names[static_cast<std::size_t>(phase)].data()) != 0) refused = true;
}

constexpr PhaseObserver phase_observer{begin_piece, end_piece};

} // namespace

LikwidMarker::LikwidMarker() {
  if (!std::getenv("LIKWID_FILEPATH")) return;
  load();
  cpus = watched_cpus();
  library.init();
  loaded = true;
}

LikwidMarker::~LikwidMarker() {
  if (loaded) library.close();
  loaded = false;
}

bool LikwidMarker::active() const { return loaded; }
const PhaseObserver* LikwidMarker::observer() const { return loaded ? &phase_observer : nullptr; }
void LikwidMarker::start() { counting = loaded; }
void LikwidMarker::stop() { counting = false; }

std::string LikwidMarker::trouble() const {
  const auto watched = static_cast<int>(cpus.size());
  if (loaded && threads_seen > watched)
    return std::to_string(threads_seen) + " threads worked on " + std::to_string(watched) + " watched CPUs";
  return refused ? "LIKWID refused a region or a thread" : "";
}

} // namespace trigrain
