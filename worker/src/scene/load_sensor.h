#pragma once

#include "scene/load_context.h"
#include "sensors/sensor.h"
#include "sensors/wavelengths.h"

namespace nocturne {

Sensor load_sensor(const v1::Sensor& message);
WavelengthSampler load_wavelengths(const v1::Sensor& message);

}  // namespace nocturne
