// Builds what a function returns where it is to stay. A record that is written number by number and
// then copied as a whole costs the processor a pause: a wide load waits until all narrow stores
// that it covers have left the store buffer.
#pragma once

#include <type_traits>

namespace nocturne {

/// container.emplace_back(InPlace{[&] { return make(); }}), or optional.emplace.
template <class Make>
struct InPlace {
  Make make;

  operator std::invoke_result_t<Make>() const { return make(); }  // NOLINT: what it is for
};
template <class Make>
InPlace(Make) -> InPlace<Make>;

}  // namespace nocturne
