// Apart, as other scenes' code does not depend on it. Scenes without media are few enough to do as
// those with them.
#include "tracer/trace_pixel_batches.h"

namespace nocturne {

template class PixelBatches<1, true, true>;
template class PixelBatches<4, true, true>;

}  // namespace nocturne
