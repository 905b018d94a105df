#pragma once
// The state at the start of an output step of several sub-steps, to go back to if one of them fails, to the bit.

#include "simulation/simulation_state.h"
#include "solve/packed_rows.h"

namespace monolith {

class SavedState {
 public:
  // Leaves the state as it is.
  void save(const Lattice& lattice, SimulationState& state);
  // Once after a save().
  void restore(SimulationState& state);
  // Gives the memory back.
  void clear();

 private:
  SimulationState rest_;  // all but the fields that are packed
  std::vector<PackedRows<double>> fields_;
  std::vector<PackedRows<std::uint8_t>> masks_;
};

}  // namespace monolith
