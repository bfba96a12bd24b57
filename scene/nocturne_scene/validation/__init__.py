"""Scenes whose readings are known: suites of closed forms and published numbers for `nocturne validate`."""
