"""The public contract: requests and answers as pydantic models, one file per resource.

The OpenAPI document is made from these, and from that the page's types and the Python client's models.
tests/services/test_contract.py compares the gRPC messages and docs/reference/api.md with them.
"""
