// Why a file can't be had.
#pragma once

#include <stdexcept>

namespace nocturne {

/// The file can't be had: the service does not have it, it is too large, or what arrives is not it.
class AssetError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// This worker can't have the file now (service away, disk full); another worker might, or this one
/// later.
class AssetUnavailable : public AssetError {
 public:
  using AssetError::AssetError;
};

/// What arrived is not the file: truncated, too long or of another digest. Fetching again may help.
class AssetDamaged : public AssetError {
 public:
  using AssetError::AssetError;
};

}  // namespace nocturne
