#include "experiments/trace.hpp"
#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

namespace trigrain {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t ring_size = 1 << 16; // pieces per thread: 4 MB

/// A piece of work, or of length 0 that a task was handed over.
struct Event {
  Clock::time_point begin, end;
  const void* task;
  int step;
  Phase phase;
  Piece piece;
  bool spawn;
};

struct Ring {
  std::vector<Event> events = std::vector<Event>(ring_size);
  std::size_t count = 0; // ever written
  Event& next() { return events[count++ % ring_size]; }
};

// The observer is a pair of plain functions, so these belong to the process.
bool recording = false;
int current_step = 0;
std::mutex rings_mutex;
std::vector<std::unique_ptr<Ring>> rings; // one per thread that ever worked; read when all are at rest

Ring& own_ring() {
  thread_local Ring* const ring = [] {
    const std::lock_guard lock(rings_mutex);
    rings.push_back(std::make_unique<Ring>());
    return rings.back().get();
  }();
  return *ring;
}

thread_local Event open_piece;

void begin_piece(Phase phase, Piece piece, const void* task) {
  if (recording) open_piece = {Clock::now(), {}, task, current_step, phase, piece, false};
}

void end_piece(Phase) {
  if (!recording) return;
  open_piece.end = Clock::now();
  own_ring().next() = open_piece;
}

void note_spawn(const void* task) {
  if (!recording) return;
  const auto now = Clock::now();
  own_ring().next() = {now, now, task, current_step, open_piece.phase, open_piece.piece, true};
}

constexpr PhaseObserver trace_observer{begin_piece, end_piece, note_spawn};

/// First step of which no piece was lost.
int first_whole_step() {
  int first = 0;
  for (const auto& ring : rings)
    if (ring->count > ring_size) first = std::max(first, ring->events[ring->count % ring_size].step + 1);
  return first;
}

/// Oldest first.
template <class Visit> void for_events(const Ring& ring, const Visit& visit) {
  const int first = first_whole_step();
  for (std::size_t i = ring.count > ring_size ? ring.count - ring_size : 0; i < ring.count; ++i) {
    const Event& event = ring.events[i % ring_size];
    if (event.step >= first) visit(event);
  }
}

} // namespace

Trace::Trace() = default;
Trace::~Trace() { recording = false; }

const PhaseObserver* Trace::observer() const { return &trace_observer; }

void Trace::start() { recording = true; }
void Trace::stop() { recording = false; }
void Trace::mark_step() { ++current_step; }
int Trace::steps() const { return current_step - first_whole_step(); }

nlohmann::ordered_json Trace::chrome_json(const nlohmann::ordered_json& about) const {
  using Json = nlohmann::ordered_json;
  auto origin = Clock::time_point::max();
  for (const auto& ring : rings) for_events(*ring, [&](const Event& event) { origin = std::min(origin, event.begin); });
  const auto microseconds = [](Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); };
  // Tasks are told apart by address and step: every step uses the same memory again.
  std::map<std::pair<int, const void*>, int> numbers;
  const auto number_of = [&](const Event& event) {
    return numbers.try_emplace({event.step, event.task}, static_cast<int>(numbers.size())).first->second;
  };
  Json events = Json::array();
  for (std::size_t thread = 0; thread < rings.size(); ++thread)
    for_events(*rings[thread], [&](const Event& event) {
      Json args = {{"step", event.step}, {"phase", phase_names[static_cast<std::size_t>(event.phase)]}};
      if (event.task) args["task"] = number_of(event);
      const std::string_view name = event.spawn ? "spawn" : piece_names[static_cast<std::size_t>(event.piece)];
      events.push_back({{"name", name},
                        {"cat", phase_names[static_cast<std::size_t>(event.phase)]},
                        {"ph", "X"},
                        {"ts", microseconds(event.begin - origin)},
                        {"dur", microseconds(event.end - event.begin)},
                        {"pid", 1},
                        {"tid", thread},
                        {"args", std::move(args)}});
    });
  return {{"traceEvents", std::move(events)}, {"displayTimeUnit", "ns"}, {"otherData", about}};
}

} // namespace trigrain
