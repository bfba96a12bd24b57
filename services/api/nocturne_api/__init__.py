"""The API process: one set of operations behind two doors, REST and gRPC."""
