"""The gRPC endpoint: the services of the contract over the operations."""
