#pragma once
// Gaps of about a cell and less between solids, in liquid that sticks to them (sticking_liquid.h). In most of their
// places in the grid no face along the gap has its centre in the liquid: all that is there would stick, and cells that
// still have a face across the gap would be cut off. With no way out for their liquid solids could neither approach nor
// part.

#include <vector>

#include "solve/staggered_operator.h"

namespace monolith {

// Part of a face's control volume whose liquid sticks to a body; body -1: to a wall.
struct StickingPart {
  int axis = 0;
  std::ptrdiff_t face = 0;
  int body = -1;
  double part = 0.0;
};

// `fluid` of the faces is what does not stick; liquid_distance in cell widths. Faces that are closed by sticking, next
// to cells that have open faces but are cut off from the rest of the liquid by it, get their part back: it slips past
// the solids (FaceKind::kSliver), whose drag on it is about that of a gap. These are taken out of `parts`.
// So do those next to cells without any open face, where that gap goes on in them. Elsewhere such cells, which have no
// pressure, take that of the nearest that has one (enclosed_rows.h): a pocket in a contact is as wet as its rim. Where
// no cell has any, as around a body that all but fills a tank, their faces get their part back, too.
void reopenNarrowGaps(const Lattice& lattice, const std::vector<double>& liquid_distance, FaceField<double>& fluid,
                      std::vector<StickingPart>& parts);

}  // namespace monolith
