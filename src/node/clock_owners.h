#pragma once
// Who else gives the time: with two on one master it jumps to and fro for everybody.

#include <string>
#include <vector>

namespace monolith {

// Names of the other nodes that publish /clock, as the master knows them; without those that do not answer within a
// second: a node that was killed stays with the master.
std::vector<std::string> otherClockOwners();

}  // namespace monolith
