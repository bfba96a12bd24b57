"""The public contract: what callers send and what they get, as pydantic models, one file per resource.

The OpenAPI document, the page's types, the Python client's models and the tables of docs/api.md are made from
these; tests/services/test_contract.py compares the gRPC messages with them.
"""
