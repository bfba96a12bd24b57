"""The gRPC endpoint: both services of the contract over the operations."""
