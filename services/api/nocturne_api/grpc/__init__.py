"""The gRPC door: servicers over the operations."""
