"""The API process: one set of operations behind two endpoints, REST and gRPC."""
