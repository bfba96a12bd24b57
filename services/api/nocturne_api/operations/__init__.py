"""What the service can do, without HTTP or gRPC: one class per resource, which both transports call."""
