#pragma once

#include <array>
#include <cstddef>
#include <new>
#include <type_traits>

namespace nocturne {

/// A stack without allocation or initialisation. The caller keeps below the capacity.
template <class T, std::size_t Capacity>
class FixedStack {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T& operator[](std::size_t i) const {
    return *std::launder(reinterpret_cast<const T*>(&storage_[i * sizeof(T)]));
  }
  void clear() { size_ = 0; }
  void push(const T& value) { new (&storage_[size_++ * sizeof(T)]) T(value); }
  T pop() { return *std::launder(reinterpret_cast<T*>(&storage_[--size_ * sizeof(T)])); }

 private:
  alignas(T) std::array<std::byte, sizeof(T) * Capacity> storage_;
  std::size_t size_ = 0;
};

}  // namespace nocturne
