#include "tracer/trace_pixel_batches.h"

namespace nocturne {

template class PixelBatches<1, false>;
template class PixelBatches<1, true>;
template class PixelBatches<4, false>;
template class PixelBatches<4, true>;

}  // namespace nocturne
