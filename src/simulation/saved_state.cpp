#include "simulation/saved_state.h"

#include <utility>

namespace monolith {
namespace {

// Those that fill the memory, in this order.
std::vector<std::vector<double>*> fieldsOf(SimulationState& s) {
  std::vector<std::vector<double>*> out;
  for (auto& field : s.coupled.velocity) out.push_back(&field);
  for (auto& field : s.acceleration) out.push_back(&field);
  out.push_back(&s.coupled.pressure);
  return out;
}

}  // namespace

void SavedState::save(const Lattice& l, SimulationState& state) {
  clear();
  for (const auto* field : fieldsOf(state)) fields_.emplace_back(l, *field);
  for (const auto& mask : state.known) masks_.emplace_back(l, mask);
  // A copy of the state while it has none of them.
  std::vector<std::vector<double>> fields(fields_.size());
  FaceMask known;
  const auto exchange = [&] {
    std::size_t next = 0;
    for (auto* field : fieldsOf(state)) field->swap(fields[next++]);
    state.known.swap(known);
  };
  exchange();
  try {
    rest_ = state;
  } catch (...) {
    exchange();
    throw;
  }
  exchange();
}

void SavedState::restore(SimulationState& state) {
  std::swap(state, rest_);
  std::size_t next = 0;
  for (auto* field : fieldsOf(state)) fields_[next++].unpack(*field);
  for (std::size_t a = 0; a < masks_.size(); ++a) masks_[a].unpack(state.known[a]);
  clear();
}

void SavedState::clear() {
  rest_ = SimulationState();
  fields_.clear();
  masks_.clear();
}

}  // namespace monolith
